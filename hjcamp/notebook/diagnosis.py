"""What a model misses, in Python."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.analyses.diagnosing import Asked, PlantDiagnosed
from hjcamp.errors import UsageError
from hjcamp.notebook._any_plant import said_of
from hjcamp.notebook.data import Data, Tests, data_of, progress_to
from hjcamp.notebook.result import CALIBRATED, Picture, Result, figure_of, frame_of, interval_row

if TYPE_CHECKING:
    import polars as pl

    from hjcamp.notebook.models import Added
    from hjcamp.notebook.proposal import Proposal

CANDIDATES = ("effect", "posterior", "heldout_error_ratio", "parameter", "value", "unit", "low", "high")


@dataclass(frozen=True, repr=False)
class Diagnosis(Result):
    """What a model misses on some tests. ``frame``: the candidates, a row for each parameter, SI with 95 % intervals."""

    data: Data
    model: str
    #: The words of the command: title, sentences, tables, and the analysis behind them.
    words: Any
    answer: dict[str, Any]

    @property
    def verdict(self) -> str:
        """effect, one_of, outside_library, nothing_missing or cannot_tell."""
        return str(self.answer["verdict"])

    @property
    def effects(self) -> list[str]:
        """The effects that are named."""
        return list(self.answer["effects"])

    @property
    def title(self) -> str:
        """The verdict and what it names."""
        return str(self.words.title)

    def sentences(self) -> list[str]:
        """Return what the verdict means and what it rests on."""
        return list(said_of(self.data).diagnosis_sentences(self.words))

    @property
    def frame(self) -> pl.DataFrame:
        """The candidates, best first: a row for each parameter of each, SI."""
        rows = [
            interval_row(
                row,
                effect=one["effect"],
                posterior=one["posterior"],
                heldout_error_ratio=one["heldout_error_ratio"],
                parameter=name,
            )
            for one in self.answer["candidates"]
            for name, row in one["parameters"].items()
        ]
        return frame_of(rows, CANDIDATES)

    @property
    def calibration(self) -> pl.DataFrame:
        """The base parameters as published or declared, and as these tests have them, SI."""
        rows = [interval_row(row, parameter=name) for name, row in self.answer["calibration"].items()]
        return frame_of(rows, CALIBRATED)

    def plot(self) -> Picture:
        """Return what is missing over what drives it where that was found, else the errors before and after."""
        return figure_of(*said_of(self.data).diagnosis_drawn(self.words))

    def page(self, folder: str | Path = "diagnose") -> Path:
        """Write the pictures and the page of the command into a folder; return the path of the page."""
        return Path(said_of(self.data).diagnosis_page(self.words, Path(folder)))

    def next(
        self,
        tests: int = 3,
        rivals: Sequence[str] = (),
        seed: int = 1,
        progress: Callable[[str, float], None] | None = None,
    ) -> Proposal:
        """Return the tests that would distinguish what remains, at most ``tests`` (`hjcamp next`), without another search.

        ``rivals`` are effects to be distinguished instead. Raises ``UsageError`` for tests of a plant that has a menu, which is
        that of ``hjcamp.command("next", ...)``, and for an unknown effect.
        """
        from hjcamp.notebook.proposal import Proposal

        if self.data.plant.room_of("next"):
            raise UsageError(f"tests of {self.data.plant_name} are proposed by hjcamp.command('next', PATH)")
        from hjcamp.analyses.proposing import propose_after
        from hjcamp.commands.any_plant.next_answer import answer

        diagnosed = PlantDiagnosed(self.words.analysis, self.words.verdict, self.answer)
        done = propose_after(diagnosed, rivals, tests, seed, progress_to(progress))
        return Proposal(done, answer(done, None, None, 0.0))

    def add(self, as_: str, effects: str | Sequence[str] | None = None) -> Added:
        """Add what was found to the model and save it as ``as_``; where several were named, say which ``effects``."""
        from hjcamp.notebook.models import added

        if effects is None and self.verdict != "effect":
            raise UsageError(
                f"the verdict is {self.verdict}, so no effect is added by itself; say which: found.add('{as_}', effects=[...])"
            )
        names = (
            self.effects
            if effects is None
            else effects.replace(",", " ").split()
            if isinstance(effects, str)
            else list(effects)
        )
        return added(names, self.data, as_, self.model)


def diagnose(
    tests: Tests,
    model: object = "published",
    *,
    effort: str = "standard",
    seed: int = 1,
    only: str | Sequence[str] | None = None,
    without: str | Sequence[str] | None = None,
    ask: str | Sequence[str] | None = None,
    workers: int | None = None,
    cluster: str | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> Diagnosis:
    """Return which effect the model misses, or that nothing is missing, or that these tests cannot tell; `hjcamp diagnose`.

    The options are those of the command; ``only``, ``without`` and ``ask`` are lists of effects, or texts with commas. Raises
    ``UsageError`` for unknown models, effects and efforts.

    >>> found = hjcamp.diagnose("logs", only=["spring", "constant_force"])
    >>> found.verdict, found.effects
    ('effect', ['spring'])
    >>> figure = found.plot()
    """
    data = data_of(tests)
    asked = Asked(str(model), effort, seed, _text(only), _text(without), workers, cluster, _text(ask))
    words, content = said_of(data).diagnosed(data, asked, progress_to(progress))
    return Diagnosis(data, asked.model, words, content)


def _text(names: str | Sequence[str] | None) -> str | None:
    return names if names is None or isinstance(names, str) else ",".join(names)
