"""Models that were made in Python: effects added, base parameters fitted."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.errors import UsageError
from hjcamp.notebook._any_plant import said_of
from hjcamp.notebook.data import Data, Tests, data_of, progress_to
from hjcamp.notebook.result import CALIBRATED, Picture, Result, figure_of, frame_of, interval_row

if TYPE_CHECKING:
    import polars as pl

PARAMETERS = ("effect", "parameter", "value", "unit", "low", "high")
ERRORS = ("start", "before", "after", "floor")


@dataclass(frozen=True, repr=False)
class Model(Result):
    """A saved model; where a name of a model is asked for, it stands for its own. ``frame``: its parameters, SI."""

    name: str
    #: conf/model/NAME.yaml
    path: Path
    answer: dict[str, Any] = field(default_factory=dict)

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True, repr=False)
class Added(Model):
    """A model with effects added: what the fit found, and the error on tests that were not used for it."""

    found: Any = None
    #: What the errors are over.
    over: str = ""

    @property
    def helps(self) -> bool:
        """Whether the error falls on tests that were not used for the fit."""
        return bool(self.answer["helps"])

    @property
    def errors(self) -> dict[str, float]:
        """The error over the noise floor on tests not used: of the model begun with, calibrated, with the effects; the noise floor."""
        return {name: value for name in ERRORS if (value := self.answer["error"].get(name)) is not None}

    @property
    def title(self) -> str:
        """The effects and how the error falls."""
        told = " -> ".join(f"{value:.2f}" for name, value in self.errors.items() if name != "floor")
        return f"{self.name} = model with {', '.join(self.answer['effects'])}: error over noise floor {told}"

    def sentences(self) -> list[str]:
        """Return whether the effects help, and where the model is."""
        doubt = (
            []
            if self.helps
            else ["The error does not fall by more than chance: leave the effect out unless other tests show it."]
        )
        return [*doubt, f"saved as {self.path}"]

    @property
    def frame(self) -> pl.DataFrame:
        """One row for each parameter of the effects, SI with 95 % intervals."""
        rows = [
            interval_row(row, effect=effect, parameter=name)
            for effect, own in self.answer["parameters"].items()
            for name, row in own.items()
        ]
        return frame_of(rows, PARAMETERS)

    def plot(self) -> Picture:
        """Return the errors before and after as bars, and the noise floor."""
        from hjcamp.report.pictures.drawing import draw_errors

        rows = [(name.replace("floor", "noise floor"), one) for name, one in self.errors.items()]
        return figure_of(draw_errors, rows, self.over, "floor" in self.errors)


@dataclass(frozen=True, repr=False)
class Calibrated(Model):
    """Base parameters of a rig from its own tests. ``found`` is the analysis."""

    found: Any = None

    @property
    def title(self) -> str:
        """How many parameters."""
        return f"{self.name}: {self.frame.height} parameters, saved as {self.path}"

    @property
    def frame(self) -> pl.DataFrame:
        """One row for each parameter: published or declared, here, 95 % interval, SI."""
        return frame_of([interval_row(row, parameter=name) for name, row in self.answer.items()], CALIBRATED)

    def plot(self) -> Picture:
        """Return each parameter over its published value, with its interval."""
        from hjcamp.report.pictures.conditions import BLUE, INK
        from hjcamp.report.pictures.drawing import dress

        rows = [row for row in self.frame.to_dicts() if row["published"]][::-1]
        figure = Picture(figsize=(7.4, 1.0 + 0.28 * len(rows)), layout="constrained")
        axis = figure.subplots()
        for place, row in enumerate(rows):
            ends = [row["value"] if row[name] is None else row[name] for name in ("low", "value", "high")]
            low, value, high = (end / row["published"] for end in ends)
            axis.plot([low, high], [place, place], color=BLUE, linewidth=1.2)
            axis.plot([value], [place], "o", color=BLUE, markersize=4)
        axis.axvline(1.0, color=INK, linewidth=0.8, linestyle="--")
        axis.set_yticks(range(len(rows)), [row["parameter"] for row in rows], fontsize=8)
        dress(axis, "")
        axis.set_xlabel("value here over published value, 95 %", fontsize=8.5)
        return figure


def added(
    names: Sequence[str], data: Data, as_: str, model: str, progress: Callable[[str, float], None] | None = None
) -> Added:
    """Fit the named effects in addition to the base of ``model`` on ``data``, save the new model as ``as_``, and return it."""
    if not names:
        raise UsageError("no effect was named: hjcamp.add(EFFECTS, TESTS, as_=NAME)")
    said = said_of(data)
    done = said.added(data, names, as_, model, progress_to(progress))
    return Added(as_, done.path, done.content, done.found, said.OVER_NOISE_FLOOR)


def calibrate(
    tests: Tests,
    *,
    as_: str,
    only: str | Sequence[str] = (),
    replace: bool = False,
    progress: Callable[[str, float], None] | None = None,
) -> Calibrated:
    """Fit the base parameters of a rig to its own tests, save them as a model, and return it; `hjcamp calibrate`.

    ``only`` are KEY=VALUE of the metadata, where the plant asks for it. Raises ``UsageError`` for a name that is taken and
    tests that serve no identification.

    >>> rig = hjcamp.calibrate("logs", as_="my_rig")
    >>> "mass" in rig.frame["parameter"].to_list()
    True
    """
    data = data_of(tests)
    chosen = [only] if isinstance(only, str) else list(only)
    return Calibrated(as_, *said_of(data).calibrated(data, as_, chosen, replace, progress_to(progress)))
