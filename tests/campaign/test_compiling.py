"""While kernels are compiled it is said what and how many, and no estimate stands still."""

from __future__ import annotations

import io
import pickle
from pathlib import Path
from typing import Any

import numba
import pytest
from numba.core.registry import cpu_target
from rich.console import Console
from rich.progress import Progress

import hjcamp.campaign.execution.progress as progress
from hjcamp import cli
from hjcamp.campaign.execution.compiling import Doing, Kernels, kernels_of, status
from hjcamp.commands.shared.session import progress_of
from hjcamp.configuration.composer import Composer
from hjcamp.model.compile.kernel_cache import cache_folder, is_compiled, kernel_name


@pytest.fixture
def cold(empty_folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache of kernels."""
    monkeypatch.setenv("HJCAMP_CACHE", str(empty_folder / "cache"))
    return empty_folder


def configured(composer: Composer, *overrides: str) -> dict[str, Any]:
    config = composer.compose(overrides).config
    return {**config, "controller_model": composer.model("published")}


def compiled(text: str, last: str) -> None:
    """Leave what numba leaves once ``last`` of a kernel has been compiled."""
    folder, name = cache_folder() / "__pycache__", f"{kernel_name(text)}.{last}-12.py311"
    folder.mkdir(exist_ok=True)
    key = ("signature", cpu_target.target_context.codegen().magic_tuple(), ("code", "closure"))
    index = pickle.dumps(numba.__version__) + pickle.dumps(("stamp", {key: f"{name}.1.nbc"}))
    (folder / f"{name}.1.nbc").write_bytes(b"")
    (folder / f"{name}.nbi").write_bytes(index)


def in_terminal(width: int = 200) -> tuple[Console, io.StringIO]:
    out = io.StringIO()
    return Console(file=out, width=width, force_terminal=True, color_system=None), out


def test_the_kernels_left_are_counted_down_whoever_compiles(
    cold: Path, composer: Composer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("hjcamp.campaign.execution.compiling.LOOK_EVERY_S", -1.0)
    choices = (("controller=pid",), ("controller=ffwd_pid",), ("controller=pid", "payload=brass_8p5g"))
    kernels = kernels_of(configured(composer, *overrides) for overrides in choices)
    assert list(kernels.needed) == [
        "the test loop with no effect",
        "the model of the feedforward",
        "the test loop with payload_inertia",
    ]
    assert "3 of 3 kernels left: the test loop with no effect; the model of the feedforward and 1 more" in kernels.words()
    for text, last in list(kernels.needed.values())[:2]:
        assert not is_compiled(text, last)
        compiled(text, last)
    assert kernels.words().endswith("1 of 3 kernels left: the test loop with payload_inertia")
    compiled(*list(kernels.needed.values())[2])
    assert (kernels.missing(), kernels.words()) == ([], "")


def test_a_rig_needs_its_control_law_and_a_virtual_one_its_joint(composer: Composer) -> None:
    config = {**configured(composer), "backend": {"name": "nidaqmx"}}
    law, *_, joint = kernels_of([config]).needed
    assert law == "the control law for the rig" and joint.startswith("the virtual rig with ")
    real = {**config, "rig": {**config["rig"], "connection": {"kind": "driver"}}}
    assert not any("virtual" in words for words in kernels_of([real]).needed)


def test_a_faulty_configuration_needs_no_kernel_of_ours(composer: Composer) -> None:
    config = configured(composer)
    assert kernels_of([{**config, "effects": {"nothing_such": {}}}, {**config, "pump": 3}, {}]).needed == {}


def test_a_status_line_says_what_is_compiled_then_what_is_done(cold: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("hjcamp.campaign.execution.compiling.LOOK_EVERY_S", -1.0)
    console, out = in_terminal()
    doing = Doing("searching")
    with status(console, Kernels({"one": ("text", "follow")}), doing):
        console.print("first")
        compiled("text", "follow")
        doing.now("searching, 12")
        console.print("second")
    assert out.getvalue().index("1 of 1 kernel left: one") < out.getvalue().index("searching, 12")


def test_a_bar_says_what_is_compiled(cold: Path) -> None:
    console, out = in_terminal(80)
    many = "the test loop with gravity_load, payload_inertia, stribeck_friction, leakage"
    with progress.progress_bar(console, 8, 0, Kernels({many: ("text", "follow")})) as advance:
        console.print("now")
        advance("a__b/rep_01")
    assert many in " ".join(out.getvalue().split()) and "1/8" in out.getvalue() and "…" not in out.getvalue()


def test_where_no_bar_can_be_seen_a_line_says_now_and_then_what_is_being_done(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = [100.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    to_a_file = Console(file=io.StringIO())
    with progress_of(to_a_file) as report, progress.progress_bar(to_a_file, 56, 8) as advance:
        for share in (0.1, 0.2, 0.3):
            now[0] += 25.0
            report(f"weighing {now[0]:.0f}", share)
            advance("a__b/rep_01")
    # at once nothing, then no more than one line of each in half a minute
    assert capsys.readouterr().err == "  0:50  weighing 150 (20%)\n  0:50  10 of 56 tests\n"


def test_the_clock_goes_on_where_a_step_is_whole_and_the_next_begins_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    console = in_terminal(100)[0]
    bars: list[Progress] = []
    monkeypatch.setattr("rich.progress.Progress.__enter__", lambda bar: bars.append(bar) or bar)
    with progress_of(console) as report:
        report("screening 22 effects", 1.0)
        report("fitting spring", 0.2)
    assert bars[0].tasks[0].finished_time is None and bars[0].tasks[0].completed == 0.2


def test_no_estimate_while_nothing_advances(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    column = progress.TimeLeft()
    with Progress(column, console=Console(file=io.StringIO()), get_time=lambda: now[0], auto_refresh=False) as bar:
        bar.add_task("", total=100)
        (task,) = bar.tasks
        assert str(column.render(task)) == ""
        for _ in range(10):
            now[0] += 1.0
            bar.update(task.id, advance=1)
            column.render(task)
        assert str(column.render(task)).endswith("left") and "0:01:" in str(column.render(task))
        now[0] += 2.0
        assert str(column.render(task)).endswith("left")
        now[0] += 2.0
        assert str(column.render(task)) == ""
        bar.update(task.id, advance=1)
        assert str(column.render(task)).endswith("left")


def test_a_run_says_before_its_first_test_what_is_compiled(
    cold: Path, quick_backend: None, capfd: pytest.CaptureFixture[str]
) -> None:
    call = ["run", "campaign=robustness_vertical", "trajectory=mixed", "repetitions=1", "workers=1", "run_dir=one"]
    assert cli.run(call) == 0
    out = capfd.readouterr().out
    assert "2 of 2 kernels left: the test loop with gravity_load, payload_inertia; the model of the feedforward" in out
    assert out.index("kernels left") < out.index("2 tests, 0 failed")
    assert cli.run(call) == 0 and "kernels left" not in capfd.readouterr().out


def test_the_picture_of_an_effect_says_what_is_compiled(
    cold: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("hjcamp.plants.pump_joint.simulation.run_test", lambda config, seed: ({}, {}))
    monkeypatch.setattr("hjcamp.plants.pump_joint.figures.effect.draw_effect", lambda *given: None)
    assert cli.run(["effects", "leakage", "--figure", "leakage.svg"]) == 0
    out = capfd.readouterr().out
    assert "2 of 2 kernels left: the test loop with no effect; the test loop with leakage" in out
    assert out.index("Seen as") < out.index("kernels left") < out.index("picture")


def test_the_test_of_an_effect_says_what_is_compiled(
    cold: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(
        "hjcamp.plants.pump_joint.effect_checks.CHECKS", {"a check": lambda bench: "fine", "another": lambda bench: ""}
    )
    assert cli.run(["effects", "test", "leakage"]) == 0
    out = capfd.readouterr().out
    assert out.count("1 of 1 kernel left: the model with leakage") == 1
    assert out.index("kernel left") < out.index("a check")
    assert "hjcamp run campaign=controllers '+effects.leakage={}'" in out
    assert cli.run(["plan", "campaign=controllers", "+effects.leakage={}"]) == 0


@pytest.mark.parametrize(
    "call",
    [
        ["tune", "--as", "mine"],
        ["tune", "campaign=friction_compliance", "conditions=*reduced_friction", "--as", "mine"],
    ],
)
def test_a_gain_set_that_is_there_is_refused_before_anything_is_computed(
    empty_folder: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], call: list[str]
) -> None:
    def never(*given: object) -> None:
        raise AssertionError("computed before it was refused")

    monkeypatch.setattr("hjcamp.plants.pump_joint.studies.critical_gain.critical_point", never)
    monkeypatch.setattr("hjcamp.plants.pump_joint.studies.retune.retune", never)
    place = empty_folder / "conf" / "controller" / "gains"
    place.mkdir(parents=True)
    (place / "mine.yaml").write_text("# mine\n")
    assert cli.run(call) == 2
    assert "mine.yaml exists" in capfd.readouterr().err
    assert (place / "mine.yaml").read_text() == "# mine\n"


def test_tuning_says_what_is_compiled(cold: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    from hjcamp.plants.pump_joint.studies.ziegler_nichols import CriticalPoint

    monkeypatch.setattr("hjcamp.plants.pump_joint.studies.critical_gain.critical_point", lambda *given: CriticalPoint(2.0, 0.1))
    assert cli.run(["tune"]) == 0
    out = capfd.readouterr().out
    assert "1 of 1 kernel left: the test loop with no effect" in out
