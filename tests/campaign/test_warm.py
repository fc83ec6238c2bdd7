"""What ``hjcamp doctor --warm`` compiles is what the demo, a diagnosis and ``hjcamp next`` need."""

from __future__ import annotations

from pathlib import Path

from hjcamp.campaign.planning import make_plan
from hjcamp.campaign.warm import CONDITIONS, follow_nothing, menu_tests, tasks, timed, try_test
from hjcamp.configuration.composer import Composer
from hjcamp.discrepancy.hardware import simulator
from hjcamp.discrepancy.next_menu import menu
from hjcamp.discrepancy.passes import compile_passes
from hjcamp.model.kernel_cache import is_compiled
from hjcamp.plants.pump_joint import PumpJoint


def kernel_of(config: dict) -> tuple[str, tuple[str, ...]]:
    """Return what decides the kernel of a test: control law and effects."""
    return config["controller"]["name"], tuple(sorted(config["effects"]))


def test_every_kernel_of_the_demo_is_warmed(composer: Composer, empty_folder: Path) -> None:
    lines = ["campaign=robustness_vertical"]
    demo = make_plan(composer.compose(lines).config, "robustness_vertical", lines, composer)
    warmed = {kernel_of(composer.compose(overrides).config) for overrides in CONDITIONS}
    assert {kernel_of(condition.config) for condition in demo.conditions} <= warmed


def test_every_kernel_of_a_diagnosis_and_of_next_is_warmed() -> None:
    work = tasks()
    followed = {given for _, call, given in work if call is follow_nothing}
    assert followed == {(cut.name, effects) for cut in PumpJoint.cuts if cut.driven for effects in (True, False)}
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
    follow_nothing("lines", False)
    source = simulator((), "lines").source
    assert is_compiled(source) and not is_compiled(source + "\n# another text\n")
