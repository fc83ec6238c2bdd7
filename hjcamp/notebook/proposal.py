"""Which tests to make next, in Python."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from hjcamp.errors import UsageError
from hjcamp.notebook.result import Picture, Result, frame_of

if TYPE_CHECKING:
    import polars as pl

    from hjcamp.analyses.proposing import PlantProposed

COLUMNS = ("condition", "text", "duration_s", "rivals", "separation", "worth_it")


@dataclass(frozen=True, repr=False)
class Proposal(Result):
    """The tests that distinguish rivals best. ``frame``: the five best, a row for each pair of rivals."""

    done: PlantProposed
    answer: dict[str, Any]

    @property
    def title(self) -> str:
        """How many tests are proposed, or that none tells."""
        from hjcamp.commands.any_plant.next_answer import title

        return title(self.done)

    def sentences(self) -> list[str]:
        """Return what is proposed, and what stays similar."""
        from hjcamp.commands.any_plant.next_answer import sentences

        return sentences(self.done)

    @property
    def frame(self) -> pl.DataFrame:
        """The five best tests with the separation of each pair, in standard deviations."""
        rows = [
            {
                **{key: one[key] for key in COLUMNS[:3]},
                "rivals": " / ".join(pair["rivals"]),
                "separation": pair["separation"],
                "worth_it": one in self.answer["tests"],
            }
            for one in (*self.answer["tests"], *self.answer["others"])
            for pair in one["pairs"]
        ]
        return frame_of(rows, COLUMNS)

    def plot(self) -> Picture:
        """Return what the rivals predict for the best tests; ``UsageError`` where there is no test."""
        from hjcamp.commands.any_plant.next_answer import drawn
        from hjcamp.report.pictures.next import predictions_figure

        if not self.done.proposal.tests:
            raise UsageError(f"{self.title}: no test was simulated, so there is nothing to draw")
        figure: Picture = predictions_figure(*drawn(self.done), Picture)
        return figure
