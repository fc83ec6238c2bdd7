"""A store whose capacity depends on its level is outside the library, in its own place and with its curve."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hjcamp.commands.shared.effect_from import begun_from
from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.candidates.nonparametric_laws import ENDS, KNOT, gain_over
from hjcamp.diagnosis.candidates.nonparametric_terms import unknowns_of
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.decision.verdict import decided
from hjcamp.diagnosis.results.answer import answer
from hjcamp.diagnosis.results.candidate_rows import unknown_rows
from hjcamp.diagnosis.screening.screening import free_of_effect
from hjcamp.effects import load_effects
from hjcamp.known_plants import find_plant
from hjcamp.model.declare.effect import Effect
from hjcamp.records.log import TestLog

AREA, OUTFLOW, WIDE = 2.0, 0.02, 1.2
PLANT = '''"""A bowl."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, path, sensor, sqrt, store


class Bowl(Plant):
    """A bowl that a pump fills and that runs out below."""

    period = 2.0
    level = State("m", typical=1.0, low=0.0)
    pump = Input("m^3/s", typical=0.02)
    area = Parameter("m^2", 2.5, (0.1, 50.0), "log-uniform", base=True)
    k = Parameter("m^2.5/s", 0.025, (1e-4, 1.0), "log-uniform", base=True)
    level_m = Measured("gauge", of="level")

    @staticmethod
    def equations(state, parameter, drive, rate):
        inflow = actuator(drive.pump)
        outflow = path(parameter.k * sqrt(state.level), upstream=state.level)
        rate.level = store(inflow - outflow, capacity=parameter.area)
        gauge = sensor(state.level)
'''


@pytest.fixture
def bowl(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "bowl.py").write_text(PLANT, encoding="utf-8")
    return tmp_path


def area_at(level: float | np.ndarray) -> float | np.ndarray:
    return AREA * (0.4 + (level / WIDE) ** 2)


def measured_log(seed: int, rain: float = 0.0, leak: float = 0.0) -> TestLog:
    """Return a log of the bowl; where ``rain`` falls or dries up (m^3/s at most), or it leaks (m^2/s), it is as wide everywhere."""
    generator, count, small = np.random.default_rng(seed), 1500, 10
    pump = np.repeat(generator.uniform(0.005, 0.03, count // 60 + 1), 60)[:count]
    level, levels = 0.8, np.empty(count)
    for k in range(count):
        levels[k] = level
        for _ in range(small):
            inflow, area = pump[k] + rain * np.sin(k / 150.0), AREA if rain or leak else area_at(level)
            level = max(level + 2.0 / small * (inflow - OUTFLOW * np.sqrt(level) - leak * level) / area, 0.0)
    columns = {
        "time_s": 2.0 * np.arange(count),
        "level_m": levels + 1e-3 * generator.standard_normal(count),
        "pump_m3_per_s": pump,
    }
    return TestLog(columns, {"plant": "bowl", "period_s": "2.0", "condition": f"train {seed}"})


def test_a_bowl_that_widens_is_outside_and_its_capacity_is_drawn(bowl: Path) -> None:
    measured = measured_tests([measured_log(1), measured_log(2)])
    library = load_effects(plant=measured.plant)
    analysis = calibrated(measured, {name: library[name] for name in ("leakage", "flow_exponent", "sensor_gain")})
    found = decided(analysis)
    row = unknown_rows(analysis, found)[0]
    assert (found.word, found.effects) == ("outside_library", ())
    assert (row["quantity"], row["port"], row["driver"], row["slots"]) == (
        "capacity",
        "level",
        "level_level",
        ["level_capacity"],
    )
    x, y = (np.array(row["knots"][name]) for name in "xy")
    content = answer(analysis, found, 1.0)
    # the base that is printed, times the curve as it is printed, is the area
    area = content["calibration_with_unknown"]["area"]["value"]
    assert area * (1.0 + y)[1:-1] == pytest.approx(area_at(x)[1:-1], rel=0.07) and np.all(1.0 + y > 0.0)
    drawn = np.interp(x, row["curve"]["x"], row["curve"]["y"])
    assert area * (1.0 + drawn)[1:-1] == pytest.approx(area_at(x)[1:-1], rel=0.07)
    begun = begun_from(content, Path("answer.json"))
    places = np.linspace(begun.first, begun.last, len(begun.tables[0].values))
    assert np.interp(x, places, begun.tables[0].values) == pytest.approx(y, abs=0.02)
    assert row["left"] < 0.3 and row["left_above_repeatability"] < row["left"]
    # the error of the answer is that of its channels, and only drivers of laws that are kept stand there, each once
    assert content["error"]["augmented"] < 0.5 * content["error"]["baseline"]
    kept = [one["driver"] for one in content["unknowns"] if not one["ruled_out"]]
    assert content["drivers"] == list(dict.fromkeys(kept)) and content["drivers"][0] == "level_level"


def test_what_a_store_gets_or_loses_in_the_course_of_a_test_is_outside(bowl: Path) -> None:
    measured = measured_tests([measured_log(1, rain=0.01), measured_log(2, rain=0.01)])
    library = load_effects(plant=measured.plant)
    analysis = calibrated(measured, {name: library[name] for name in ("leakage", "flow_exponent", "sensor_gain")})
    found = decided(analysis)
    row = unknown_rows(analysis, found)[0]
    assert (found.word, found.effects) == ("outside_library", ())
    assert (row["quantity"], row["port"], row["driver"]) == ("loss", "level", "time")
    assert row["left"] < 0.6


@pytest.mark.parametrize("typical", [pytest.param(1.0, marks=pytest.mark.study), 1e-3])
def test_an_effect_is_as_small_as_it_is_whatever_size_was_declared_usual(bowl: Path, typical: float) -> None:
    (bowl / "plants" / "bowl.py").write_text(PLANT.replace("typical=1.0", f"typical={typical}"), encoding="utf-8")
    measured = measured_tests([measured_log(1, leak=0.004)])
    library = load_effects(plant=measured.plant)
    analysis = calibrated(measured, {"leakage": library["leakage"]}, unknowns=False)
    start = analysis.base.fitted.candidate.with_effect("leakage", {**library["leakage"].defaults(), "conductance": 0.01})
    own = analysis.search.fitted(start).fitted.candidate.effects["leakage"]
    found = own["conductance"] * WIDE + own["conductance_above"] * max(WIDE - own["threshold"], 0.0)
    assert found == pytest.approx(0.004 * WIDE, rel=0.02)
    assert typical == 1.0 or found < 0.03 * library["leakage"].parameters["conductance"].default * WIDE


@pytest.mark.parametrize("effect", load_effects().values(), ids=lambda one: one.name)
def test_bounds_of_an_effect_are_those_that_it_declares(effect: type[Effect]) -> None:
    assert [(one.low, one.high) for one in free_of_effect(effect)] == [one.bounds for one in effect.parameters.values()]


def test_a_positive_law_leaves_something_whatever_its_amplitudes_are(bowl: Path) -> None:
    law = gain_over("bowl", "level_capacity", "level_capacity", "level", "m", positive=True)
    given = dict(zip(ENDS, (0.0, 1.0), strict=True)) | {f"{KNOT}{k}": -1e3 for k in range(6)}
    assert 0.0 < law.level_capacity(2.0, 0.5, **given) < 2e-3
    nothing = given | {f"{KNOT}{k}": 0.0 for k in range(6)}
    assert law.level_capacity(2.0, 0.5, **nothing) == 2.0
    one = unknowns_of(find_plant("bowl"), {"level": (0.1, 2.0), "time": (0.0, 9.0)})[
        "unknown_gain_of_level_capacity_over_level"
    ]
    assert one.amount(0.0) == 0.0 and one.amount(0.75) == pytest.approx(0.75 + 1.25 - 1.0)
    assert (one.quantity, one.driver, one.place) == ("capacity", "level", "level")
