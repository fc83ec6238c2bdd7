"""Plans: every campaign's conditions, narrowing, precedence, seeds, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hjcamp.campaign.plan.campaign_file import label_of
from hjcamp.campaign.plan.planning import make_plan
from hjcamp.configuration.composer import Composer
from hjcamp.errors import UsageError
from hjcamp.records.plan import Plan, folder_name, planned_tests, read_plan, seed_of

COUNTS = {
    "controllers": (14, 252.0),
    "robustness_horizontal": (6, 112.0),
    "robustness_vertical": (8, 196.0),
    "friction_compliance": (6, 105.0),
    "previous_work": (8, 182.0),
    "pid_design": (5, 35.0),
    "open_loop_validation": (1, 14.0),
    "feedforward_simulation": (2, 21.0),
}


VARIED = {"name": "c", "vary": {"trajectory": ["ramp_pos"], "controller.positive.kp": [0.7, 1.05]}}


def plan(composer: Composer, campaign: str | None, *lines: str) -> Plan:
    asked = composer.compose([*([f"campaign={campaign}"] if campaign else []), *lines])
    return make_plan(asked.config, campaign, lines, composer)


@pytest.fixture(scope="module")
def vertical(composer: Composer) -> Plan:
    return plan(composer, "robustness_vertical")


@pytest.mark.parametrize("campaign", COUNTS)
def test_every_campaign_has_its_conditions(composer: Composer, campaign: str) -> None:
    made = plan(composer, campaign)
    assert (len(made.conditions), made.duration) == COUNTS[campaign]
    assert len(made.tests) == 7 * len(made.conditions)
    assert len({test.seed for test in made.tests}) == len(made.tests)


def test_a_campaign_fixes_and_varies(vertical: Plan) -> None:
    assert [one.name for one in vertical.conditions][:3] == [
        "sine_0p5hz__pid",
        "sine_0p5hz__ffwd_pid",
        "cycloid_pos__pid",
    ]
    for one in vertical.conditions:
        assert one.choices["payload"] == "brass_8p5g"
        assert one.choices["orientation"] == "vertical"
        assert set(one.config["effects"]) == {"payload_inertia", "gravity_load"}
    assert vertical.tables == ("table_5_5_1", "table_5_5_2", "table_5_5_3")
    test = vertical.tests[0]
    assert (test.id, test.log) == ("sine_0p5hz__pid/rep_01", "logs/sine_0p5hz__pid/rep_01.mcap")


@pytest.mark.parametrize(
    ("value", "name", "folder", "before"),
    [
        (0.7, "kp=0.7", "kp0p7", "kp-0.7"),
        (-0.7, "kp=-0.7", "kpm0p7", "kp--0.7"),
        (1e-15, "kp=1e-15", "kp1em15", "kp-1e-15"),
        (1e20, "kp=1e20", "kp1e20", "kp-1e20"),
        (2, "kp=2", "kp2", "kp-2"),
        (True, "kp=True", "kp-True", "kp-True"),
        ("pid", "pid", "pid", "pid"),
    ],
)
def test_a_value_is_named_with_its_sign(value: object, name: str, folder: str, before: str) -> None:
    label = label_of("controller.positive.kp", value)
    assert label == name and folder_name(f"ramp__{label}__none") == f"ramp__{folder}__none"
    # the draws of a test stay those of earlier runs, which named it otherwise and are read as they are
    (test,), (earlier,) = planned_tests([label], 1, 3), planned_tests([before], 1, 3)
    assert test.seed == earlier.seed
    assert (test.log, earlier.log) == (f"logs/{folder}/rep_01.mcap", f"logs/{before}/rep_01.mcap")


@pytest.mark.parametrize("pattern", ["'*kp=0.7'", "'*kp0p7'", "'*kp-0.7'", "ramp_pos__kp0p7"])
def test_a_condition_is_chosen_by_any_of_its_names(composer: Composer, pattern: str) -> None:
    asked = composer.compose([f"conditions={pattern}"]).config
    made = make_plan({**asked, "campaign": VARIED}, "c", [f"conditions={pattern}"], composer)
    assert [one.name for one in made.conditions] == ["ramp_pos__kp=0.7"]


def test_the_steps_of_the_pid_design(composer: Composer) -> None:
    steps = {one.name: one.config for one in plan(composer, "pid_design", "repetitions=1").conditions}
    assert {config["trajectory"]["amplitude_deg"] for config in steps.values()} == {-80.0}
    amplitudes = {name: config["controller"]["dither"]["amplitude_v"] for name, config in steps.items()}
    assert amplitudes.pop("stability_method") == 0.0
    assert amplitudes == {"plain": 0.0, "dither": 1.0, "smooth_derivative": 1.0, "pressure_adjustment": 1.0}
    adjusted = [name for name, config in steps.items() if config["procedure"]["adjustment"]["enabled"]]
    assert adjusted == ["pressure_adjustment"]


def test_the_command_line_narrows_an_axis(composer: Composer, vertical: Plan) -> None:
    narrow = plan(composer, "robustness_vertical", "controller=pid", "trajectory=mixed")
    assert [one.name for one in narrow.conditions] == ["mixed__pid"]
    assert narrow.conditions[0] == vertical.condition("mixed__pid")
    assert narrow.tests[0] in vertical.tests
    other = plan(composer, "robustness_vertical", "controller=pid", "trajectory=ramp_neg")
    assert [one.name for one in other.conditions] == ["ramp_neg__pid"]


def test_the_command_line_narrows_cases(composer: Composer) -> None:
    made = plan(composer, "friction_compliance", "friction=unidirectional", "trajectory=ramp_pos")
    assert [one.name for one in made.conditions] == ["ramp_pos__unidirectional_friction"]
    with pytest.raises(UsageError, match="Allowed: reduced, unidirectional"):
        plan(composer, "friction_compliance", "friction=bidirectional")


def test_the_command_line_wins_over_the_campaign(composer: Composer) -> None:
    lines = ("payload=none", "repetitions=2", "controller=pid", "trajectory=mixed", "controller.positive.kp=2.5")
    made = plan(composer, "robustness_vertical", *lines)
    assert made.repetitions == 2
    assert made.conditions[0].choices["payload"] == "none"
    assert made.conditions[0].config["controller"]["positive"]["kp"] == 2.5


def test_conditions_can_be_picked(composer: Composer) -> None:
    made = plan(composer, "controllers", "conditions=[mixed__*,ramp_pos__pid]", "repetitions=1")
    assert [one.name for one in made.conditions] == ["ramp_pos__pid", "mixed__pid", "mixed__ffwd_pid"]
    with pytest.raises(UsageError, match="did you mean 'mixed__pid'"):
        plan(composer, "controllers", "conditions=mixed_pid")


def test_without_a_campaign_one_condition_runs(composer: Composer) -> None:
    made = plan(composer, None, "trajectory=mixed", "controller=ffwd_pid", "+effects.leakage={}")
    assert (made.campaign, [one.name for one in made.conditions]) == ("single", ["mixed__ffwd_pid"])
    assert list(made.conditions[0].config["effects"]) == ["leakage"]


def test_a_controller_knows_only_its_own_model(composer: Composer) -> None:
    line = "++model.effects.leakage.conductance=1e-13"
    config = plan(composer, None, line, "repetitions=1").conditions[0].config
    assert config["model"]["effects"] == {"leakage": {"conductance": 1e-13}}
    assert config["controller_model"]["effects"] == {}


def test_seeds_follow_from_run_condition_and_repetition() -> None:
    assert seed_of(1, "mixed__pid", 1) == seed_of(1, "mixed__pid", 1) == 8809835131946342795
    others = {seed_of(2, "mixed__pid", 1), seed_of(1, "mixed__ffwd_pid", 1), seed_of(1, "mixed__pid", 2)}
    assert len(others | {seed_of(1, "mixed__pid", 1)}) == 4


def test_a_plan_survives_its_file(vertical: Plan, tmp_path: Path) -> None:
    (tmp_path / "plan.json").write_text(json.dumps(vertical.as_json()))
    assert read_plan(tmp_path / "plan.json") == vertical
    (tmp_path / "plan.json").write_text("{}")
    with pytest.raises(UsageError, match="schema is missing; this version reads"):
        read_plan(tmp_path / "plan.json")


def test_the_hash_covers_results_and_nothing_else(composer: Composer) -> None:
    base = plan(composer, None)
    assert plan(composer, None, "workers=2", "run_dir=elsewhere", "fail_fast=true").sha256 == base.sha256
    for line in ("seed=2", "repetitions=3", "controller.positive.kp=1.06", "tubing=hdpe_300mm"):
        assert plan(composer, None, line).sha256 != base.sha256


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (
            ["pump=pump1", "amplifier=high_gain"],
            "unknown amplifier 'high_gain' in pump 'pump1'; did you mean 'low_gain'? Allowed: low_gain",
        ),
        (["controller.positive.kp=nan"], "controller.positive.kp is nan; a number from 0 to 1000 is needed"),
        (["controller.negative.ki=inf"], "controller.negative.ki is inf"),
        (["controller.positive.kp=abc"], "controller.positive.kp is 'abc'; a number from 0 to 1000"),
        (["repetitions=0"], "repetitions is 0"),
        (["repetitions=-2"], "repetitions is -2"),
        (["repetitions=1.5"], "repetitions is 1.5"),
        (["seed=-1"], "seed is -1"),
        (["joint.moving_mass_g=0"], "joint.moving_mass_g is 0; a number from 0.01"),
        (["payload.mass_g=-1"], "payload.mass_g is -1; a number from 0 to"),
        (["tubing.stiffness_mpa_per_mm3=-0.1"], "tubing.stiffness_mpa_per_mm3 is -0.1"),
        (["friction.positive.coulomb_n=-1"], "friction.positive.coulomb_n"),
        (["pump.transfer_function.high_gain.a0=0"], "pump.transfer_function.high_gain.a0"),
        (["trajectory=ramp", "trajectory.duration=0"], "trajectory.duration"),
        (["trajectory=ramp", "trajectory.duration=-1"], "trajectory.duration"),
        (["controller.derivative_samples=0"], "controller.derivative_samples"),
        (["procedure.sampling_hz=500"], "procedure.sampling_hz is 500; 1000 is needed"),
        (["controller.model=nope"], "unknown model 'nope'"),
        (["tables=[table_9]"], "unknown table 'table_9'"),
        (["~pump"], "the group 'pump' is missing"),
    ],
)
def test_bad_values_are_refused(composer: Composer, lines: list[str], words: str) -> None:
    with pytest.raises(UsageError) as caught:
        plan(composer, None, *lines)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_conditions_that_come_out_equal_are_refused(composer: Composer, empty_folder: Path) -> None:
    (empty_folder / "campaigns").mkdir()
    text = "name: mine\nvary:\n  case:\n    a: {friction: bidirectional}\n    b: {friction.positive.static_n: 7.2}\n"
    (empty_folder / "campaigns" / "mine.yaml").write_text(text)
    with pytest.raises(UsageError, match="varies the same thing twice: the conditions 'a' and 'b'"):
        plan(Composer(), "mine")


def test_an_axis_that_is_removed_is_refused(composer: Composer) -> None:
    with pytest.raises(UsageError, match="removes what the axis"):
        plan(composer, "controllers", "~controller")
