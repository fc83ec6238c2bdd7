"""Models compared with measured tests, in Python."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.errors import UsageError
from hjcamp.notebook import _any_plant
from hjcamp.notebook._any_plant import said_of
from hjcamp.notebook.data import Data, Tests, data_of, progress_to
from hjcamp.notebook.result import Picture, Result, figure_of, frame_of

if TYPE_CHECKING:
    import polars as pl

COLUMNS = ("model", "channel", "rms", "floor", "r2", "score")


@dataclass(frozen=True, repr=False)
class Comparison(Result):
    """Models on the same tests. ``frame``: a row for each model and channel, with the model's score: 1 is perfect.

    ``found`` is the analysis itself (`hjcamp.diagnosis.results.comparison`, or that of the plant).
    """

    data: Data
    found: Any
    answer: dict[str, Any]

    @property
    def title(self) -> str:
        """The scores in one line."""
        shown = {name: "diverges" if value is None else f"{value:.2f}" for name, value in self.scores.items()}
        return "error over noise floor: " + ", ".join(f"{name} {value}" for name, value in shown.items())

    @property
    def scores(self) -> dict[str, float | None]:
        """The error of each model over the noise floor, geometric mean of the channels; nothing of one that diverges."""
        return {one["name"]: one["score"] for one in self.answer["models"]}

    @property
    def frame(self) -> pl.DataFrame:
        """One row for each model and channel, in the units of the channels."""
        rows = [
            {"model": one["name"], "channel": channel, "score": one["score"], **(error or {})}
            for one in self.answer["models"]
            for channel, error in one["error"].items()
        ]
        return frame_of(rows, COLUMNS)

    def sentences(self) -> list[str]:
        """Return where the error of the last model is, in words."""
        return list(said_of(self.data).comparison_sentences(self.found))

    @property
    def sliders(self) -> dict[str, tuple[float, float, float]]:
        """For each base parameter the ends and the step of a slider about its calibrated value, SI; ``UsageError`` for the joint.

        >>> ipywidgets.interact(found.plot, **found.sliders)  # doctest: +SKIP
        """
        return _any_plant.comparison_sliders(self._of_any_plant)

    @property
    def _of_any_plant(self) -> Any:
        if said_of(self.data) is not _any_plant:
            raise UsageError(f"plant {self.data.plant_name}: it is calibrated test by test and has no sliders")
        return self.found

    def plot(self, **values: float) -> Picture:
        """Return measurement and models over time where the error is largest; base parameters' ``values`` (SI) are a further model."""
        if values:
            return figure_of(*_any_plant.comparison_moved(self._of_any_plant, values))
        return figure_of(*said_of(self.data).comparison_drawn(self.found))

    def page(self, folder: str | Path = "compare") -> Path:
        """Write the pictures and the page of the command into a folder; return the path of the page."""
        return Path(said_of(self.data).comparison_page(self.found, Path(folder)))


def compare(tests: Tests, model: object = "published", progress: Callable[[str, float], None] | None = None) -> Comparison:
    """Return how far one or several models are off on measured tests, and where; `hjcamp compare`.

    ``tests`` are loaded ones or paths, ``model`` a name or a list of names (or what `add` gave); ``progress`` hears (what is
    done, share). Raises ``UsageError`` for a model that is not there, ``HjcampError`` for one that diverges.

    >>> found = hjcamp.compare("logs")
    >>> found.frame.columns
    ['model', 'channel', 'rms', 'floor', 'r2', 'score']
    >>> list(found.scores)
    ['published']
    """
    data = data_of(tests)
    names = [str(one) for one in model] if isinstance(model, Sequence) and not isinstance(model, str) else [str(model)]
    return Comparison(data, *said_of(data).compared(data, names, progress_to(progress)))
