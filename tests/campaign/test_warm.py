"""What ``hjcamp doctor --warm`` compiles is what the demo needs."""

from __future__ import annotations

from pathlib import Path

from hjcamp.campaign.planning import make_plan
from hjcamp.campaign.warm import CONDITIONS
from hjcamp.configuration.composer import Composer


def kernel_of(config: dict) -> tuple[str, tuple[str, ...]]:
    """Return what decides the kernel of a test: control law and effects."""
    return config["controller"]["name"], tuple(sorted(config["effects"]))


def test_every_kernel_of_the_demo_is_warmed(composer: Composer, empty_folder: Path) -> None:
    lines = ["campaign=robustness_vertical"]
    demo = make_plan(composer.compose(lines).config, "robustness_vertical", lines, composer)
    warmed = {kernel_of(composer.compose(overrides).config) for overrides in CONDITIONS}
    assert {kernel_of(condition.config) for condition in demo.conditions} <= warmed
