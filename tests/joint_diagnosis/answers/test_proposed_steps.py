"""What compare and diagnose propose can be pasted, and what is unexplained is told as a curve."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from discrepancy_answers import Call

from hjcamp.analyses.data import free_model_name
from hjcamp.plants.pump_joint.answers.compare import next_commands
from hjcamp.plants.pump_joint.answers.diagnose import next_command
from hjcamp.plants.pump_joint.diagnosis.localisation.unexplained import Unexplained
from hjcamp.plants.pump_joint.diagnosis.scale import Judged, fall_of

LOGS = [Path("logs")]


def compared(*scores: tuple[str, float], repeated: bool = True) -> SimpleNamespace:
    """Return a comparison of models with these scores."""
    evidence = SimpleNamespace(repeated=repeated)
    return SimpleNamespace(
        models=[SimpleNamespace(score=score, replay=SimpleNamespace(name=name, evidence=evidence)) for name, score in scores]
    )


def test_a_free_name_is_proposed(call: Call) -> None:
    assert free_model_name("with_leakage") == "with_leakage"
    Path("conf/model").mkdir(parents=True)
    for name in ("with_leakage", "with_leakage_2"):
        Path(f"conf/model/{name}.yaml").write_text(f"name: {name}\n")
    assert free_model_name("with_leakage") == "with_leakage_3" and free_model_name("published") == "published_2"


@pytest.mark.parametrize(
    ("verdict", "effects", "model", "command"),
    [
        ("effect", ["leakage"], "published", "hjcamp add leakage logs --as with_leakage"),
        ("effect", ["leakage"], "bench", "hjcamp add leakage logs --model bench --as with_leakage"),
        ("nothing_missing", [], "bench", "hjcamp compare logs --model bench"),
        ("one_of", ["leakage", "tubing_creep"], "published", "hjcamp next logs"),
        ("cannot_tell", [], "published", "hjcamp next logs"),
    ],
)
def test_after_diagnose(call: Call, verdict: str, effects: list[str], model: str, command: str) -> None:
    assert next_command({"verdict": verdict, "effects": effects, "drivers": []}, LOGS, model) == command


def test_after_something_outside_the_library(call: Call) -> None:
    told = next_command({"verdict": "outside_library", "effects": [], "drivers": ["arm_angle"]}, LOGS)
    assert told.startswith("hjcamp effects new arm_angle_effect   # ")


def test_after_compare() -> None:
    def commands(*scores: tuple[str, float], repeated: bool = True) -> list[str]:
        return next_commands(compared(*scores, repeated=repeated), LOGS)  # type: ignore[arg-type]

    run = "hjcamp run campaign=controllers controller.model=bench"
    assert commands(("published", 6.0)) == ["hjcamp diagnose logs"]
    assert commands(("published", 6.0), ("bench", 1.1)) == [run]
    assert commands(("published", 6.0), ("bench", 2.1)) == ["hjcamp diagnose logs --model bench", run]
    assert commands(("bench", 0.01), repeated=False) == ["hjcamp diagnose logs --model bench"]


def test_an_effect_helps_where_the_error_falls_by_more_than_its_standard_error() -> None:
    def judged(*each: float) -> Judged:
        return Judged({}, 1.0, each)

    assert fall_of(judged(2.0, 3.0, 4.0), judged(1.0, 2.0, 3.0)) == (1.0, 0.0)
    mean, error = fall_of(judged(2.0, 2.0), judged(1.0, 2.8))
    assert mean == pytest.approx(0.1) and error == pytest.approx(0.9) and not mean > error
    assert fall_of(judged(2.0), judged(1.5)) == (0.5, 0.0)
    assert all(math.isnan(one) for one in fall_of(judged(2.0), judged()))


def test_a_spring_is_told_by_its_slope_and_friction_by_its_turn() -> None:
    angle = np.linspace(-60.0, 60.0, 12)
    spring = -0.01 * angle
    curve = Unexplained("arm_angle", "deg", "force on the arm", "N", angle, spring + 0.1, spring - 0.1)
    assert curve.sentence("best") == (
        "What the best model lacks is a force on the arm that depends on arm angle: about -0.01 N/deg."
    )
    wave = 0.5 * np.cos(angle / 5)
    hidden = np.where(angle > 50, np.nan, wave)
    curve = Unexplained("arm_angle", "deg", "force on the arm", "N", angle, hidden, -wave)
    said = curve.sentence("best")
    assert "depends on arm angle and turns with the direction of motion: between -0." in said and "nan" not in said
