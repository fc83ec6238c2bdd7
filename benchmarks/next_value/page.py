"""The page of the study of `hjcamp next`: a row for each duel, and what they amount to."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks import ROOT
from benchmarks.next_value.duel import MOST

LEDGER = ROOT / "benchmarks" / "results" / "next_value.jsonl"


@dataclass(frozen=True)
class Question:
    """A duel to be fought: a number that seeds it, the strength of the true effect, true effect and rival, random orders."""

    number: int
    strength: str
    names: tuple[str, str]
    orders: int

    @property
    def name(self) -> str:
        """What the ledger calls it; an answer holds for as many tests as were run at most."""
        return f"{self.names[0]}-{self.strength}-{self.names[1]}-{self.number}-{self.orders}-{MOST}"


def page(duels: Sequence[tuple[Question, dict[str, Any]]], tag: str) -> str:
    """Return the page: a row for each duel, the means of those that say anything, and what they amount to."""
    lines = [
        "# Tests needed to set two rivals apart",
        "",
        f"Made by `python -m benchmarks.next_value`, code at commit {tag}; its head says how. A test is one repetition of one",
        f"condition; at most {MOST} are run, {MOST + 1} means not apart by then. The duels stand in `{LEDGER.relative_to(ROOT)}`.",
        "",
        "| truth | strength | rival | proposed order | random order (each) |",
        "|---|---|---|---|---|",
    ]
    for one, line in duels:
        ended = "apart from the start | |"
        if line["ours"] is not None:
            ended = f"{line['ours']} | {', '.join(map(str, line['theirs']))} |"
        lines.append(f"| {one.names[0]} | {one.strength} | {one.names[1]} | {ended}")
    telling = [line for _, line in duels if line["ours"] is not None and min(line["ours"], *line["theirs"]) <= MOST]
    if not telling:
        return "\n".join([*lines, "", "No duel says anything of the order.", ""])
    ours = [line["ours"] for line in telling]
    theirs = [number for line in telling for number in line["theirs"]]
    ratios = [float(np.mean(line["theirs"])) / line["ours"] for line in telling]
    times = float(np.mean(theirs) / np.mean(ours))
    mine, logarithms = np.array(ours, dtype=np.float64), np.log(ratios)
    others = mine * np.array(ratios)
    of_means = resampled(len(ours), lambda drawn: others[drawn].sum(axis=1) / mine[drawn].sum(axis=1))
    each = resampled(len(ours), lambda drawn: np.exp(logarithms[drawn].mean(axis=1)))
    return "\n".join(
        [
            *lines,
            "",
            f"Median: {np.median(ours):g} proposed, {np.median(theirs):g} random; mean {np.mean(ours):.2f} and {np.mean(theirs):.2f},",
            f"{times:.1f} times fewer, over {len(ours)} duels of {len(duels)} ({of_means}).",
            f"Fewer than the mean of the random orders in {sum(ratio > 1.0 for ratio in ratios)}.",
            f"The means are a lower bound: {MOST + 1} counts where {MOST} tests were not enough, for "
            f"{_capped(ours)} of {len(ours)} proposed",
            f"and {_capped(theirs)} of {len(theirs)} random orders. Duel by duel (geometric mean of the ratios): "
            f"{np.exp(logarithms.mean()):.1f} times ({each}).",
            "",
        ]
    )


def _capped(numbers: Sequence[int]) -> int:
    return sum(number > MOST for number in numbers)


def resampled(count: int, statistic: Callable[[NDArray[np.int64]], NDArray[np.float64]]) -> str:
    """Return the 90 % interval of a statistic of ``count`` duels, drawn anew; it takes the duels drawn (draws, count)."""
    drawn = np.random.default_rng(8).integers(count, size=(2000, count))
    low, high = np.quantile(statistic(drawn), [0.05, 0.95])
    return f"90 % interval {low:.1f} to {high:.1f}"
