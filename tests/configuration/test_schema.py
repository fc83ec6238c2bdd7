"""One schema for the whole configuration: every number has a type and a range, every choice of ours fits, no key is unknown."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from hjcamp.campaign.files.dotted_paths import leaves
from hjcamp.campaign.plan.planning import check_call, make_plan
from hjcamp.configuration.check import check_configuration
from hjcamp.configuration.composer import Composer
from hjcamp.configuration.run_keys import read_run_keys
from hjcamp.controllers import find_controller
from hjcamp.controllers.controller import Controller
from hjcamp.errors import UsageError

WRONG = (math.nan, math.inf, -math.inf, -1e300, 1e300, 10**400, "abc", [1.0], {"a": 1.0}, True)
SETUPS = {
    "virtual": ("controller=ffwd_pid",),
    "rig": ("backend=nidaqmx",),
    "pcie": ("backend=nidaqmx", "rig=example_pcie", "controller=open_loop", "trajectory=segments"),
    "pxie": ("backend=nidaqmx", "rig=example_pxie", "trajectory=sine"),
}


def changed(config: dict[str, Any], path: str, value: Any) -> dict[str, Any]:
    """Return a copy with another value at ``path`` (``a.b[0].c``)."""
    copied = copy.deepcopy(config)
    *parents, last = path.replace("[", ".").replace("]", "").split(".")
    place: Any = copied
    for part in parents:
        place = place[int(part) if isinstance(place, list) else part]
    place[int(last) if isinstance(place, list) else last] = value
    return copied


def numbers_of(config: dict[str, Any]) -> Iterator[str]:
    """Yield the path of every number of a configuration; one that may be null has no number here."""
    for path, value in leaves(config):
        if isinstance(value, int | float) and not isinstance(value, bool):
            yield path


@pytest.mark.parametrize("setup", SETUPS)
def test_every_number_has_a_type_and_a_range(composer: Composer, empty_folder: Path, setup: str) -> None:
    config = composer.compose(SETUPS[setup]).config
    check_configuration(config)
    paths = list(numbers_of(config))
    assert len(paths) > 60
    for path in paths:
        for value in WRONG:
            with pytest.raises(UsageError) as caught:
                check_configuration(changed(config, path, value), "here")
            text = str(caught.value)
            assert text.startswith("here: ") and path in text and "\n" not in text and len(text) < 400, (path, value)


@pytest.mark.parametrize("setup", SETUPS)
def test_every_switch_is_true_or_false(composer: Composer, empty_folder: Path, setup: str) -> None:
    config = composer.compose(SETUPS[setup]).config
    paths = [path for path, value in leaves(config) if isinstance(value, bool)]
    assert {"fail_fast", "keep_going", "procedure.adjustment.enabled"} < set(paths)
    for path in paths:
        for value in ("no", "off", "maybe", "true", 0, 1, None, [True]):
            with pytest.raises(UsageError, match=rf"{path} is .*true or false is needed"):
                check_configuration(changed(config, path, value))


@pytest.mark.parametrize("setup", SETUPS)
def test_every_group_refuses_an_unknown_key(composer: Composer, empty_folder: Path, setup: str) -> None:
    config = composer.compose(SETUPS[setup]).config
    groups = {path.rpartition(".")[0] for path, _ in leaves(config) if "[" not in path} - {"", "backend"}
    assert {"pump.transfer_function.high_gain", "rig.limits", "procedure.adjustment", "controller.dither"} < groups
    for group in groups:
        with pytest.raises(UsageError, match=r"unknown (trajectory )?parameter 'nmae'"):
            check_configuration(changed(config, f"{group}.nmae", 1.0))


@pytest.mark.study
def test_every_choice_of_ours_fits(composer: Composer, empty_folder: Path) -> None:
    groups = [group for group in composer.groups() if group not in ("campaign", "table")]
    for group in groups:
        for choice in composer.options(group):
            if (group, choice) == ("backend", "replay"):
                continue
            # The first pump was never run with the other amplifier.
            extra = ["amplifier=low_gain"] if choice == "pump1" else []
            if group == "controller" and find_controller(choice).results != Controller.results:
                extra = [f"plant={'valve_joint' if 'duty1' in find_controller(choice).results else 'two_pumps'}"]
                if choice == "given":
                    extra = [*extra, "controller.input=command1", "trajectory=hold"]
            if group == "procedure" and choice != "standard":
                extra = ["plant=valve_joint"]
            check_configuration(composer.compose([f"{group}={choice}", *extra]).config, f"{group}={choice}")
    for group in ("controller/gains", "controller/feedforward"):
        for choice in composer.options(group):
            if not choice.startswith("valve_joint"):  # those of another plant are chosen by its controllers
                check_configuration(composer.compose(["controller=ffwd_pid", f"{group}={choice}"]).config)


@pytest.mark.study  # what every condition composes to is checked where the campaigns are planned
@pytest.mark.parametrize("backend", ["simulation", "nidaqmx"])
def test_every_campaign_of_ours_fits(composer: Composer, empty_folder: Path, backend: str) -> None:
    for campaign in composer.options("campaign"):
        if backend == "nidaqmx" and composer.compose([f"campaign={campaign}"]).config["campaign"].get("fixed", {}).get("plant"):
            continue  # another plant has no wiring
        # The conditions of our campaigns are composed one by one in the tests of planning.
        check_call([f"campaign={campaign}", f"backend={backend}"], composer)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("keep_going=no", "keep_going is 'no'; true or false is needed"),
        ("keep_going=off", "keep_going is 'off'"),
        ("fail_fast=maybe", "fail_fast is 'maybe'"),
        ("workers=0", "workers is 0; a whole number from 1 to 1024 or null"),
        ("workers=two", "workers is 'two'"),
        ("repetitions=true", "repetitions is true; a whole number from 1"),
        ("repetitions=0", "repetitions is 0"),
        ("seed=-1", "seed is -1"),
        ("most_tests=0", "most_tests is 0"),
        ("tables={a: 1}", "a text or a list or null"),
        ("run_dir=[a]", "run_dir is ['a']"),
    ],
)
def test_the_keys_of_the_run(composer: Composer, empty_folder: Path, line: str, words: str) -> None:
    with pytest.raises(UsageError) as caught:
        read_run_keys(composer.compose([line]).config)
    assert words in str(caught.value)


def plan_of(composer: Composer, *lines: str) -> Any:
    """Return the plan of a call, as `hjcamp plan` makes it."""
    asked = composer.compose(lines)
    return make_plan(asked.config, asked.choices.get("campaign"), lines, composer)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("controller.positive=3", "controller.positive is 3; a mapping of kp, ki, kd is needed"),
        ("controller.positive.kp=-5", "controller.positive.kp is -5; a number from 0 to 1000"),
        ("controller.positive.kp=1e308", "controller.positive.kp is 1e+308"),
        (f"controller.positive.kp={'1' * 4000}", "kp is a number of about 4000 digits; a number from 0 to 1000"),
        (f"controller.positive.kp={'1' * 5000}", "Exceeds the limit (4300 digits)"),
        ("trajectory={kind: ramp}", "choose with trajectory=NAME and set a parameter with trajectory.PARAMETER=VALUE"),
        ("controller/gains={kp: 1}", "set a parameter with controller.gains.PARAMETER=VALUE"),
        ("campaign=[controllers,leakage]", "hjcamp run -m campaign=controllers,leakage"),
        ("payload=[none,brass_8p5g]", "a group takes one choice"),
        ("+campaign.repetitions=3", "none is chosen; choose with campaign=NAME"),
        ("model=../model/published", "unknown model '../model/published'; did you mean 'published'"),
        ("rig.name=../../elsewhere", "rig.name is '../../elsewhere'; a name without / and"),
        ("rig=_bench", "unknown rig '_bench'"),
        ("trajectory.kind={a: 1}", "unknown trajectory kind '{'a': 1}'"),
        ("trajectory.kind=[1]", "unknown trajectory kind '[1]'"),
        ("+x._target_=os.system", "'_target_' names code to run"),
        ("+pump.boer_mm=3", "unknown parameter 'boer_mm' in pump; did you mean 'bore_mm'"),
        ("pump.bore_mm=1e-300", "pump.bore_mm is 1e-300; a number from 0.1 to 100"),
        ("pump.transfer_function.high_gain.delay_ms=1e7", "delay_ms is 10000000.0; a number from 0 to 1000"),
        ("procedure.rest_ms=1e12", "procedure.rest_ms is 1000000000000.0; a number from 0 to 600000"),
        ("procedure.preload_mpa=-3", "procedure.preload_mpa is -3; a number from 0 to 2"),
        ("procedure.release_mpa=-5", "procedure.release_mpa is -5"),
        ("procedure.warn_below_mpa=abc", "procedure.warn_below_mpa is 'abc'"),
        ("rig.sensors.encoder_counts_per_turn=0.5", "a whole number from 4 to 10000000"),
        ("rig.sensors.encoder_counts_per_turn=1000000000", "a whole number from 4 to 10000000"),
        ("rig.scatter.friction_within=1e5", "rig.scatter.friction_within is 100000.0; a number from 0 to 1"),
        ("rig.return_speed_mm_per_s=1e6", "a number from 0.1 to 60 or null"),
        ("rig.return_speed_mm_per_s=-10", "rig.return_speed_mm_per_s is -10"),
        ("rig.return_speed_mm_per_s=abc", "rig.return_speed_mm_per_s is 'abc'"),
        ("tubing.outer_diameter_mm=2", "inner_diameter_mm must be below outer_diameter_mm"),
        ("++model.parameters.pump_area=true", "model.parameters.pump_area is true"),
        ("++effects.leakage.conductance=true", "effects.leakage.conductance is true"),
        ("++effects.leakage.conductance='1e-13'", "effects.leakage.conductance is '1e-13'; a number"),
    ],
)
def test_what_was_accepted_in_silence(composer: Composer, empty_folder: Path, line: str, words: str) -> None:
    with pytest.raises(UsageError) as caught:
        plan_of(composer, line)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_configuration_that_a_user_extends_by_a_rig_of_few_keys(composer: Composer, empty_folder: Path) -> None:
    config = composer.compose([]).config
    config["rig"] = {key: config["rig"][key] for key in ("name", "sensors", "scatter")}
    check_configuration(config)
    with pytest.raises(UsageError, match=r"rig\.connection is missing; a mapping of kind, address, virtual is needed"):
        check_configuration({**config, "backend": {"name": "nidaqmx"}})


MODELS = {
    "parameters: {line_stiffness: abc}\neffects: {}": "model.parameters.line_stiffness is 'abc'",
    "parameters: {line_stiffness: [1]}\neffects: {}": "model.parameters.line_stiffness is [1]",
    "parameters: {pump_area: true}\neffects: {}": "model.parameters.pump_area is true",
    "parameters: {pump_area: 0}\neffects: {}": "model.parameters.pump_area is 0; a number from 1e-09 to 0.01 m^2",
    "parameters: {joint_area: -1.0e-5}\neffects: {}": "model.parameters.joint_area is -1e-05",
    "parameters: [1]\neffects: {}": "model.parameters is [1]; a mapping of names to values",
    "parameters:\neffects: {}": "model.parameters is null",
    "effects: {}": "model.parameters is missing",
    "parameters: {}": "model.effects is missing",
    "parameters: {}\neffects: [leakage]": "model.effects is ['leakage']",
    "parameters: {}\neffects: {leakage: 3}": "model.effects.leakage is 3",
    "parameters: {}\neffects: {leakage: {conductance: .nan}}": "model.effects.leakage.conductance is nan",
    "parameters: {mass: 1}\neffects: {}": "unknown parameter 'mass' in model.parameters",
    "parameters: {}\neffects: {}\nparametres: {}": "unknown parameter 'parametres' in model; did you mean 'parameters'",
}


@pytest.mark.parametrize("text", MODELS)
def test_a_saved_model_is_checked_once_for_all_commands(empty_folder: Path, text: str) -> None:
    folder = empty_folder / "conf" / "model"
    folder.mkdir(parents=True)
    (folder / "bad.yaml").write_text(f"name: bad\n{text}\n")
    composer = Composer()
    for call in (lambda: composer.model("bad"), lambda: check_call(["model=bad"], composer)):
        with pytest.raises(UsageError) as caught:
            call()
        assert MODELS[text] in str(caught.value)


def test_every_way_to_a_saved_model_checks_it(empty_folder: Path) -> None:
    from hjcamp.plants.pump_joint.diagnosis.models.saved import saved_model

    folder = empty_folder / "conf" / "model"
    folder.mkdir(parents=True)
    (folder / "bad.yaml").write_text("name: bad\nparameters: {pump_area: true}\neffects: {}\n")
    composer = Composer()
    for call in (
        lambda: plan_of(composer, "model=bad"),
        lambda: plan_of(composer, "controller.model=bad"),
        lambda: saved_model("bad"),  # compare, diagnose and add
    ):
        with pytest.raises(UsageError, match=r"model\.parameters\.pump_area is true"):
            call()
    with pytest.raises(UsageError, match="unknown model 'baad'; did you mean 'bad'"):
        saved_model("baad")
