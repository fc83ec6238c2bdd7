"""What ``hjcamp doctor --warm`` compiles is what the demo, a diagnosis and ``hjcamp next`` need."""

from __future__ import annotations

from pathlib import Path

import pytest

from hjcamp.campaign.plan.planning import composed_plan, make_plan
from hjcamp.configuration import shared_parts
from hjcamp.configuration.composer import Composer
from hjcamp.controllers import find_controller
from hjcamp.effects import load_effects
from hjcamp.model.compile.kernel_cache import is_compiled
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.diagnosis.design.menu import menu
from hjcamp.plants.pump_joint.diagnosis.measured.hardware import simulator
from hjcamp.plants.pump_joint.diagnosis.residuals.passes import compile_passes
from hjcamp.plants.pump_joint.simulation import prepare
from hjcamp.plants.pump_joint.studies.warm import (
    CONDITIONS,
    configured,
    follow_nothing,
    menu_tests,
    plan_campaigns,
    tasks,
    timed,
    try_test,
)

options = Composer.options


def kernel_of(config: dict) -> str:
    """Return the text of the kernel of a test."""
    return prepare(config, 1).simulator.source


def test_every_kernel_of_the_demo_is_warmed_once(composer: Composer, empty_folder: Path) -> None:
    lines = ["campaign=robustness_vertical"]
    demo = make_plan(composer.compose(lines).config, "robustness_vertical", lines, composer)
    warmed = [kernel_of(configured(composer, overrides)) for overrides in CONDITIONS]
    assert {kernel_of(condition.config) for condition in demo.conditions} <= set(warmed)
    assert len(set(warmed)) == len(warmed)
    laws = {composer.compose(overrides).config["controller"]["name"] for overrides in CONDITIONS}
    assert any(find_controller(law).uses_feedforward for law in laws)


def test_every_kernel_of_a_diagnosis_and_of_next_is_warmed_once() -> None:
    work = tasks()
    followed = [given for _, call, given in work if call is follow_nothing]
    cuts = [cut.name for cut in PumpJoint.cuts if cut.driven]
    assert sorted(followed) == sorted((cut, names) for cut in cuts for names in ((), tuple(load_effects())))
    tried = {given[0].settings["controller"] for _, call, given in work if call is try_test}
    assert tried == {choice.settings["controller"] for choice in menu()} == set(menu_tests())


def test_what_was_made_ready_is_named_with_its_seconds() -> None:
    called: list[object] = []
    subject, seconds = timed("a kernel", lambda *given: called.extend(given), ("one", "two"))
    assert (subject, called) == ("a kernel", ["one", "two"])
    assert seconds >= 0.0


def test_the_passes_of_a_diagnosis_are_warmed() -> None:
    assert compile_passes in {call for _, call, _ in tasks()}


def test_a_kernel_that_was_run_is_known_as_compiled() -> None:
    follow_nothing("lines", ())
    source = simulator((), "lines").source
    assert is_compiled(source) and not is_compiled(source + "\n# another text\n")


def test_a_plan_composes_nothing_once_every_campaign_was_planned(
    tmp_path: Path, empty_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert plan_campaigns in {call for _, call, _ in tasks()}
    monkeypatch.setenv("HJCAMP_CACHE", str(tmp_path / "cache"))
    chosen = {"campaign": ["robustness_vertical"]}
    monkeypatch.setattr(Composer, "options", lambda self, group: chosen.get(group) or options(self, group))
    shared_parts._parts.cache_clear()
    plan_campaigns()
    shared_parts._parts.cache_clear()
    later = Composer()
    monkeypatch.setattr(later._variations, "_load", lambda overrides: pytest.fail(f"composed once more: {overrides}"))
    lines = ["campaign=robustness_vertical"]
    assert composed_plan(lines, later)[0].conditions
    shared_parts._parts.cache_clear()
