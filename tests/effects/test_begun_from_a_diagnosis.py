"""An effect file that begins with the curve of a diagnosis: it loads, says the curve, and passes the checks."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hjcamp import cli
from hjcamp.commands.shared.plant_template import write_template
from hjcamp.effects import load_effects
from hjcamp.effects._begun import Begun, Table
from hjcamp.effects._curve_template import curve_template
from hjcamp.known_plants import find_plant
from hjcamp.model.declare.effect import Effect
from hjcamp.model.language.effect_units import check_units

STIFFNESS, REST = 140.0, 0.02
BASIN = '''"""A basin that drains."""
from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, path, sensor, store


class Basin(Plant):
    r"""What runs in and out.

    .. math:: \\dot h = q - k h
    """

    level = State("m", typical=5.0)
    tap = Input("m/s", typical=1.0)
    k = Parameter("1/s", 0.1, base=True)
    gauge_m = Measured("gauge", of="level")

    @staticmethod
    def equations(state, parameter, drive, rate):
        inflow = actuator(drive.tap)
        drain = path(parameter.k * state.level, upstream=state.level)
        rate.level = store(inflow - drain)
        gauge = sensor(state.level)
'''
SPRING: dict[str, Any] = {
    "schema": "hjcamp.diagnosis/2", "plant": "axis", "verdict": "outside_library", "effects": [],
    "unknowns": [{
        "driver": "velocity_position", "quantity": "force", "port": "velocity", "signal": "position", "slots": ["load"],
        "curve": {"x_unit": "m", "y_unit": "N"},
        "knots": {"x": [-0.1, -0.05, 0.0, 0.05, 0.1], "y": [-STIFFNESS * (x - REST) for x in (-0.1, -0.05, 0.0, 0.05, 0.1)]},
    }],
}  # fmt: skip


def joint(driver: str = "arm_angle", **changed: Any) -> dict[str, Any]:
    """Return an answer for the pump joint: a spring of 2 N/rad and 0.5 N more friction, not seen at both ends."""
    x = [-1.0, -0.5, 0.0, 0.5, 1.0]
    curve = {
        "x": x,
        "x_unit": "rad",
        "y_unit": "N",
        "forward": [None, *(-2.0 * at - 0.5 for at in x[1:])],
        "backward": [*(-2.0 * at + 0.5 for at in x[:-1]), None],
    }
    row = {"driver": driver, "quantity": "force on the arm", "port": "sliding", "curve": curve | changed}
    return {"schema": "hjcamp.diagnosis/1", "verdict": "outside_library", "effects": [], "unknowns": [row]}


BELL = {
    "formulas": {
        "law": "unknown_force_over_position",
        "driver": "body_position",
        "level": 0.01,
        "none": False,
        "p_value": 0.4,
        "compared": 26,
        "forms": [
            {
                "form": "bell",
                "parameters": {
                    "a": {"value": 12.0, "unit": "N", "ci95": [11.0, 13.0]},
                    "b": {"value": 0.02, "unit": "m", "ci95": [0.018, 0.022]},
                    "c": {"value": 0.03, "unit": "m", "ci95": [0.027, 0.033]},
                },
                "left_above_repeatability": 0.08,
            },
            {
                "form": "even_power",
                "parameters": {
                    "a": {"value": 3.0, "unit": "N", "ci95": [2.0, 4.0]},
                    "b": {"value": 1.5, "unit": "1", "ci95": [1.0, 2.0]},
                },
                "reference": 0.1,
            },
        ],
    }
}


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_template("axis", Path("plants"), [])
    return tmp_path


def begun(content: dict[str, Any], plant: str, name: str = "mine") -> type[Effect]:
    """Return the effect that the command writes from an answer."""
    Path("answer.json").write_text(json.dumps(content), encoding="utf-8")
    assert cli.run(["effects", "new", name, "--from", "answer.json"]) == 0
    return load_effects(plant=plant)[name]


def at_defaults(effect: type[Effect], slot: str, **given: float) -> float:
    """Return a method's value with the effect's parameters at their defaults."""
    term = effect.terms[slot]
    return float(term.function(*(given.get(name, effect.defaults().get(name)) for name in term.arguments)))


def test_the_curve_of_any_plant_is_the_law_of_the_file(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    effect = begun(SPRING, "axis")
    check_units(effect, find_plant("axis"))
    for x in (-0.09, -0.03, 0.02, 0.071):
        assert at_defaults(effect, "load", position=x) == pytest.approx(-STIFFNESS * (x - REST), abs=2e-3)
    held = at_defaults(effect, "load", position=0.5)
    assert held == pytest.approx(-STIFFNESS * (0.1 - REST), abs=2e-3)  # beyond the tests the last value holds
    assert cli.run(["effects", "test", "mine", "--plant", "axis"]) == 0
    assert "mine passes" in capsys.readouterr().out


def test_a_gain_becomes_a_share_of_what_is_asked(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    knots = {"x": [0.0, 0.2, 0.4], "y": [0.1, 0.0, -0.2]}
    row = {
        "driver": "velocity", "quantity": "gain", "port": "force", "signal": "velocity", "slots": ["force"],
        "curve": {"x_unit": "m/s", "y_unit": "1"}, "knots": knots,
    }  # fmt: skip
    effect = begun(SPRING | {"unknowns": [row]}, "axis")
    check_units(effect, find_plant("axis"))
    for speed, share in ((0.0, 0.1), (0.1, 0.05), (0.3, -0.1), (0.9, -0.2)):
        assert at_defaults(effect, "force", velocity=speed, force_demand=50.0) == pytest.approx(50.0 * share, abs=1e-2)
    assert cli.run(["effects", "test", "mine", "--plant", "axis"]) == 0
    assert "mine passes" in capsys.readouterr().out


def test_what_bends_a_command_bends_it_as_it_arrives(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    row = {
        "driver": "force_demand", "quantity": "command", "port": "force", "signal": "force_demand", "slots": ["force"],
        "curve": {"x_unit": "N", "y_unit": "N"}, "knots": {"x": [-40.0, 0.0, 40.0], "y": [8.0, 0.0, -4.0]},
    }  # fmt: skip
    effect = begun(SPRING | {"unknowns": [row]}, "axis")
    check_units(effect, find_plant("axis"))
    assert set(effect.terms["force"].arguments) == {"force", *effect.parameters}
    for arrived, less in ((-40.0, 8.0), (-10.0, 2.0), (20.0, -2.0), (90.0, -4.0)):
        assert at_defaults(effect, "force", force=arrived) == pytest.approx(arrived + less, abs=1e-2)
    assert cli.run(["effects", "test", "mine", "--plant", "axis"]) == 0
    assert "mine passes" in capsys.readouterr().out


def test_a_gain_of_a_path_is_handed_on(here: Path) -> None:
    Path("plants/basin.py").write_text(BASIN, encoding="utf-8")
    flow = "drain"
    row = {
        "driver": "time", "quantity": "gain", "port": flow, "signal": "time", "slots": [flow],
        "curve": {"x_unit": "s", "y_unit": "1"}, "knots": {"x": [0.0, 50.0, 100.0], "y": [0.0, -0.1, -0.3]},
    }  # fmt: skip
    effect = begun(SPRING | {"plant": "basin", "unknowns": [row]}, "basin")
    check_units(effect, find_plant("basin"))
    for time, share in ((0.0, 0.0), (25.0, -0.05), (75.0, -0.2)):
        assert at_defaults(effect, flow, **{flow: 3.0, "time": time}) == pytest.approx(3.0 * (1.0 + share), abs=1e-3)


def test_both_directions_become_a_force_and_friction(here: Path) -> None:
    effect = begun(joint(), "pump_joint")
    check_units(effect, find_plant("pump_joint"))
    assert set(effect.terms) == {"load_force", "friction_static", "friction_coulomb"}
    place = {"slider_position": 0.3 * 3.41e-3, "pulley_radius": 3.41e-3}
    assert at_defaults(effect, "load_force", **place) == pytest.approx(-0.6, abs=1e-3)
    # forwards the missing force is -0.5 N, backwards +0.5 N: more friction, whichever way it moves
    assert at_defaults(effect, "friction_coulomb", **place) == pytest.approx(0.5, abs=1e-3)
    assert not any(at_defaults(effect, slot, **place, even=0.0, odd=0.0) for slot in effect.terms)


@pytest.mark.parametrize("driver", ["arm_velocity", "direction", "pressure_sum", "pump_velocity", "time", "time_at_rest"])
def test_every_driver_of_the_joint_has_a_name_in_its_model(here: Path, driver: str) -> None:
    check_units(begun(joint(driver), "pump_joint"), find_plant("pump_joint"))


def test_a_flow_goes_to_both_lines(here: Path) -> None:
    content = joint("pressure_sum")
    content["unknowns"][0] |= {"port": "line_sum", "quantity": "flow out of both lines"}
    content["unknowns"][0]["curve"] |= {
        "y_unit": "m^3/s",
        "forward": [1e-9, 2e-9, 3e-9, 4e-9, 5e-9],
        "backward": [None] * 5,
    }
    effect = begun(content, "pump_joint")
    check_units(effect, find_plant("pump_joint"))
    each = [at_defaults(effect, slot, pressure1=0.25, pressure2=0.25) for slot in ("leak1", "leak2")]
    assert np.allclose(each, 2e-9, rtol=1e-3)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ({"schema": "hjcamp.diagnosis/1", "verdict": "effect", "effects": ["leakage"]}, "hjcamp add leakage"),
        ({"schema": "hjcamp.diagnosis/2", "verdict": "nothing_missing", "unknowns": []}, "NOTHING_MISSING"),
        ({"schema": "hjcamp.diagnosis/1", "verdict": "cannot_tell"}, "CANNOT_TELL"),
        ({"schema": "hjcamp.comparison/1"}, "no answer of hjcamp diagnose"),
        ([1, 2], "no answer of hjcamp diagnose"),
        (joint("repetition"), "no law of the joint knows"),
        (joint(forward=[None] * 5, backward=[None] * 5), "not whole"),
        ({**SPRING, "plant": "axes"}, "did you mean 'axis'"),
    ],
)
def test_what_cannot_begin_a_file_says_why(here: Path, capsys: pytest.CaptureFixture[str], content: Any, said: str) -> None:
    Path("answer.json").write_text(json.dumps(content), encoding="utf-8")
    assert cli.run(["effects", "new", "mine", "--from", "answer.json"]) == 2
    assert said in capsys.readouterr().err
    assert not Path("effects").exists()


def test_a_file_that_exists_and_a_place_without_a_diagnosis(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    begun(SPRING, "axis")
    before = Path("effects/mine.py").read_text(encoding="utf-8")
    assert cli.run(["effects", "new", "mine", "--from", "answer.json"]) == 2
    assert "exists; it is left as it is" in capsys.readouterr().err
    assert Path("effects/mine.py").read_text(encoding="utf-8") == before
    assert cli.run(["effects", "new", "other", "--from", "plants"]) == 2
    assert "no diagnosis is in this folder" in capsys.readouterr().err
    assert cli.run(["effects", "new", "other", "--from", "nowhere"]) == 2
    assert "does not exist" in capsys.readouterr().err


def test_what_is_added_to_one_slot_may_be_taken_from_another() -> None:
    table = Table("amplitude", ("one_loss", "other_loss"), (-2.0, 0.0, 2.0), "m^3/s", "a leak", "", ("other_loss",))
    begun = Begun("tanks", "x", "a - b", "a - b", ("a", "b"), "m", -1.0, 1.0, (table,), "a diagnosis")
    text = curve_template("leak", begun)
    first, other = text.partition("def other_loss")[::2]
    assert "def one_loss(a, b, amplitude, first, last)" in first and "(a - b - first) / (last - first)" in other
    assert "return amplitude * (" in first and "return -amplitude * (" in other and "return amplitude" not in other


def test_a_formula_stands_in_the_file_instead_of_the_curve(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("answer.json").write_text(json.dumps(SPRING | BELL), encoding="utf-8")
    assert cli.run(["effects", "new", "table", "--from", "answer.json"]) == 0
    assert "a bell: a exp(-((x - b) / c)^2)   --form bell" in capsys.readouterr().out
    for form, wanted in (
        ("bell", lambda x: 12.0 * np.exp(-(((x - 0.02) / 0.03) ** 2))),
        ("even_power", lambda x: 3.0 * abs(x / 0.1) ** 1.5),
    ):
        assert cli.run(["effects", "new", f"as_{form}", "--from", "answer.json", "--form", form]) == 0
        effect = load_effects(plant="axis")[f"as_{form}"]
        check_units(effect, find_plant("axis"))
        for x in (-0.09, 0.02, 0.071, 0.3):
            assert at_defaults(effect, "load", position=x) == pytest.approx(wanted(x), rel=1e-5)
        assert cli.run(["effects", "test", f"as_{form}", "--plant", "axis"]) == 0
    text = Path("effects/as_bell.py").read_text(encoding="utf-8")
    assert "it took 92 % of the error above repeatability" in text and "the diagnosis answer.json" in text


@pytest.mark.parametrize(
    ("content", "form", "said"),
    [
        (SPRING | BELL, "bel", "did you mean 'bell'"),
        (SPRING, "bell", "diagnose again"),
        (SPRING | {"formulas": {}}, "bell", "no formula is proposed"),
        (SPRING | {"formulas": {"forms": [{"form": "magic", "parameters": {}}]}}, "bell", "not whole"),
        (SPRING | {"formulas": {"forms": [BELL["formulas"]["forms"][0] | {"parameters": {}}]}}, "bell", "not whole"),
    ],
)
def test_what_is_no_formula_of_the_answer_is_refused(
    here: Path, content: dict[str, Any], form: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("answer.json").write_text(json.dumps(content), encoding="utf-8")
    assert cli.run(["effects", "new", "mine", "--from", "answer.json", "--form", form]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1 and not Path("effects/mine.py").exists()


def test_a_formula_without_a_diagnosis_is_refused(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["effects", "new", "mine", "--form", "bell"]) == 2
    assert "give --from with it" in capsys.readouterr().err
