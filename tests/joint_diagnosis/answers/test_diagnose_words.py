"""The words of a diagnosis: chance as a count of twins, tables in readable units, errors by name."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hjcamp.effects import load_effects
from hjcamp.plants.pump_joint.answers.diagnose_words import Told
from hjcamp.plants.pump_joint.answers.error_words import error_table, worse_than_mean
from hjcamp.plants.pump_joint.diagnosis.residuals.replay import ChannelError
from hjcamp.plants.pump_joint.diagnosis.scale import Judged, Scale

ROW = {"value": 2.79e-16, "unit": "m^3/(s*Pa)", "ci95": [2.6e-16, 3e-16]}
CONTENT: dict[str, Any] = {
    "verdict": "effect",
    "effects": ["leakage"],
    "drivers": [],
    "p_value": 0.04,
    "candidates": [
        {"effect": "leakage", "posterior": 1.0, "heldout_error_ratio": 0.1, "parameters": {"conductance": ROW}},
        {"effect": "tubing_creep", "posterior": 0.001, "heldout_error_ratio": None, "parameters": {"share": ROW}},
    ],
    "error": {"baseline": 14.0, "augmented": 1.15, "floor": 1.0},
    "calibration": {
        "coulomb_positive": {"published": 5.27, "value": 4.21, "unit": "N", "ci95": [4.1, 4.3]},
        "stiffness_asymmetry": {"published": 0.0, "value": -0.001, "unit": "1", "ci95": [-0.002, 0.0]},
    },
    "minimum_detectable": {},
}


def told(**changed: Any) -> Told:
    """Return a diagnosis with some of its answer changed."""
    step = SimpleNamespace(
        null_gains=np.linspace(2.0, 6.0, 24), gain=158.0, best="leakage", p_value=changed.get("p_value", 1.0)
    )
    final = SimpleNamespace(candidate=SimpleNamespace(effects={"leakage": {}}))
    confounded = [
        {"effects": ["encoder_bias"], "cosine": 0.99, "with": "base parameters"},
        {"effects": ["leakage", "tubing_creep"], "cosine": 0.85, "with": "each other"},
    ]
    found: Any = SimpleNamespace(
        steps=[step],
        final=final,
        baseline=None,
        confounded=confounded,
        reason="it is so",
        undecided=(),
        rig_chance=changed.pop("rig_chance", 1 / 201),
    )
    noise_floors = {"arm_deg": 0.4, "pressure1_mpa": 0.009, "pressure2_mpa": 0.009}
    judging: Any = SimpleNamespace(before=judged(14.0), after=judged(1.15), scale=Scale(noise_floors, {}))
    effects = {"leakage": load_effects([])["leakage"]}
    return Told(found, CONTENT | changed, effects, "published", judged(15.5), judging, None)


def judged(score: float) -> Judged:
    """Return errors of so many floors."""
    noise_floors = (("arm_deg", 0.4), ("pressure1_mpa", 0.009), ("pressure2_mpa", 0.009))
    return Judged({name: ChannelError(score * noise_floor, noise_floor, 0.9) for name, noise_floor in noise_floors}, score)


@pytest.mark.parametrize(
    ("p_value", "rig_chance", "verdict", "said"),
    [
        (
            1 / 25,
            1 / 201,
            "effect",
            "Adding leakage raises the log-likelihood by 158; the most in 24 simulations with nothing missing",
        ),
        (1 / 25, 1 / 201, "effect", " is 6 (p <= 0.04, the least that 24 can show). None of 200 simulated rigs"),
        (1 / 25, 1 / 201, "effect", "gained as much for their effect (p <= 0.005)."),
        (3 / 25, 4 / 201, "effect", "by 158, and 2 of 24 simulations with nothing missing by as much (p = 0.12)."),
        (3 / 25, 4 / 201, "effect", "3 of 200 simulated rigs with another contact gained as much for their effect (p = 0.02)."),
        (0.04, 8 / 201, "nothing_missing", "(p = 0.04). A name is given where no more than 5 of these rigs do."),
    ],
)
def test_chance_is_the_gain_against_those_of_twins_and_of_rigs(
    p_value: float, rig_chance: float, verdict: str, said: str
) -> None:
    assert said in told(p_value=p_value, rig_chance=rig_chance, verdict=verdict).chance()


def test_title_and_answer() -> None:
    assert told().title == "Effect: leakage"
    assert told().answer()[0].startswith("Water is lost from each line")
    assert told(verdict="outside_library", drivers=["arm_angle"]).title == "Outside library: depends on arm angle"
    assert told(verdict="cannot_tell").answer() == ["It is so."]


def test_what_is_certain_is_told_before_what_is_not() -> None:
    one = told()
    one.found.undecided = ("line_inertance", "pressure_gain")
    assert one.title == "Effect: leakage" and one.answer()[1] == "It is so."


def test_tables_are_in_readable_units() -> None:
    rows = told().candidates()
    assert rows[0] == ["leakage", "1.00", "10 %", "conductance", "0.279 mm3/(s MPa)", "0.260 to 0.300"]
    assert rows[1][:3] == ["tubing_creep", "<0.01", ""]
    assert told().calibration() == [["Coulomb friction, positive", "5.27 N", "4.21 N", "4.10 to 4.30", "-20 %"]]
    assert told().calibration(every=True)[1][1:3] == ["0", "-0.0010"]


def test_errors_and_what_cannot_be_told_apart() -> None:
    assert told().scores() == [("published", 15.5), ("calibrated", 14.0), ("with leakage", 1.15), ("noise floor", 1.0)]
    assert told().confounded() == (["encoder_bias"], [("leakage / tubing_creep", 0.85)])
    assert told().confounded(0.95) == (["encoder_bias"], [])


def test_errors_are_told_in_their_unit_first_then_in_floors() -> None:
    one = told()
    headings, rows = error_table(one.errors(), one.judging.scale)
    assert headings == ["error", "published", "calibrated", "with leakage", "noise floor"]
    assert rows[0] == ["arm angle", "6.2 deg  15.5 x", "5.6 deg  14.0 x", "0.46 deg  1.1 x", "0.4 deg"]
    assert rows[1][0] == "line 1" and rows[1][1] == "0.139 MPa  15.5 x" and rows[1][-1] == "0.009 MPa"
    assert rows[-1] == ["arm and lines", "15.50 x", "14.00 x", "1.15 x", "1.00 x"]


def test_a_model_that_ran_away_has_no_column_and_nothing_repeated_no_floor() -> None:
    ran = Judged(dict.fromkeys(("arm_deg", "pressure1_mpa", "pressure2_mpa")), float("nan"))
    plain = Judged({name: ChannelError(1.0, None, 0.9) for name in ran.errors}, 0.05)
    headings, rows = error_table([("a", ran), ("b", plain)], Scale(dict.fromkeys(ran.errors), {}))
    assert headings == ["error", "b", "noise floor"]
    assert rows[0] == ["arm angle", "1 deg", "none"] and rows[-1] == ["arm and lines", "0.05", ""]


@pytest.mark.parametrize(
    ("rms", "noise_floor", "there"),
    [(0.0, 0.1, False), (0.004, 0.1, False), (0.1, 0.1, True), (0.0, None, False), (0.2, None, True)],
)
def test_a_first_reading_that_no_model_misses_has_no_row(rms: float, noise_floor: float | None, there: bool) -> None:
    errors = {name: ChannelError(1.0, 0.5, 0.9) for name in ("arm_deg", "pressure1_mpa")}
    models = [("a", Judged(errors | {"first_reading": ChannelError(0.0, noise_floor, None)}, 1.0))]
    models.append(("b", Judged(errors | {"first_reading": ChannelError(rms, noise_floor, None)}, 1.0)))
    rows = error_table(models, Scale({"arm_deg": 0.5, "pressure1_mpa": 0.5, "first_reading": noise_floor}, {}))[1]
    assert [row[0] for row in rows] == ["arm angle", "line 1", *["first reading"] * there, "arm and lines"]


def test_a_negative_r2_is_said() -> None:
    assert worse_than_mean({"arm_deg": ChannelError(1.0, None, 0.1), "pump_deg": None}) == []
    said = worse_than_mean({"arm_deg": ChannelError(1.0, None, -2.2), "pressure1_mpa": ChannelError(1.0, None, 0.5)})
    assert said[0].startswith("r2 is negative for arm angle (-2.2):")
