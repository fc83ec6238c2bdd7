"""What tests lack for a verdict: windows, blocks, motion."""

from __future__ import annotations

import numpy as np

from hjcamp.diagnosis.data.repeatability import MOTION_ORDERS, moves
from hjcamp.diagnosis.data.segments import SHORTEST_OF_ALL, Layout
from hjcamp.diagnosis.data.tests import Measured
from hjcamp.diagnosis.validation.blocks import FEWEST, blocks_of


def what_lacks(measured: Measured, layout: Layout) -> list[str]:
    """Return in words what these tests lack for a verdict; empty where nothing does."""
    found = []
    blocks = len(np.unique(blocks_of(layout)))
    if blocks < FEWEST or len(layout.of_test) < 3 * FEWEST:
        asked = (
            "repetitions share theirs, so longer tests or tests of other courses"
            if len(layout.of_test) >= 3 * FEWEST and measured.repeated
            else f"longer or more tests (at least {3 * FEWEST * SHORTEST_OF_ALL} samples, these have "
            f"{sum(test.samples for test in measured.tests)}{_before(measured)})"
        )
        found.append(
            f"{len(layout.of_test)} windows of {layout.width * measured.period:.4g} s in {blocks} blocks; "
            f"{3 * FEWEST} windows in {FEWEST} blocks are needed: {asked}"
        )
    if not moves(layout)[: MOTION_ORDERS * len(measured.sensors)].any():
        found.append("nothing that is measured changes in these tests by more than its noise")
    return found


def _before(measured: Measured) -> str:
    """Return in words how many samples of the logs are not looked at, as they tell what inputs were before the tests."""
    lead = sum(len(test.earlier) for test in measured.tests)
    return f" behind {lead} that tell what inputs were before" if lead else ""
