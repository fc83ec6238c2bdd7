"""Every campaign that we ship runs as it is."""

from __future__ import annotations

import io
from pathlib import Path

import pytest
from rich.console import Console

import hjcamp
from hjcamp.campaign.files.run_folder import folder_for
from hjcamp.campaign.plan.planning import make_plan
from hjcamp.campaign.runner import run_plan
from hjcamp.configuration.composer import Composer

CAMPAIGNS = sorted(path.stem for path in (Path(hjcamp.__file__).parents[1] / "campaigns").glob("*.yaml"))

LONG = {
    "two_pumps", "previous_joint", "preload", "valve_timing", "valve_tuning", "robustness_horizontal", "dither_map", "bandwidth",
    "leakage", "stiffness",
}  # fmt: skip


@pytest.mark.parametrize(
    "campaign", [pytest.param(name, marks=pytest.mark.study) if name in LONG else name for name in CAMPAIGNS]
)
def test_every_test_of_a_shipped_campaign_succeeds(campaign: str, composer: Composer, empty_folder: Path) -> None:
    lines = [f"campaign={campaign}", "repetitions=1"]
    plan = make_plan(composer.compose(lines).config, campaign, lines[1:], composer)
    folder = folder_for(plan, {}, lines, Path("run"))[0]
    result = run_plan(folder, Console(file=io.StringIO()), workers=1)
    assert result.failures == []
    assert folder.complete and result.done == len(plan.tests) > 0


def test_all_that_is_shipped_is_run() -> None:
    assert {"controllers", "known_effect", "previous_work"} <= set(CAMPAIGNS)
