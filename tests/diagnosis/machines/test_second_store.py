"""What remembers is told from what does not: a second store beside one, a leak that grows faster than its level, a damper."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hjcamp.commands.any_plant.remarks.outside_words import no_memory_words
from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.candidates.equivalence import equivalent_laws, memory_end, times_remembered
from hjcamp.diagnosis.candidates.nonparametric_laws import AT, ENDS, KNOT, gain_over
from hjcamp.diagnosis.candidates.nonparametric_terms import unknowns_of
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.decision.verdict import decided
from hjcamp.diagnosis.estimation.intervals import Interval
from hjcamp.diagnosis.results.calibration_rows import calibration
from hjcamp.diagnosis.selection import search as searching
from hjcamp.diagnosis.selection.search import Search
from hjcamp.effects import load_effects
from hjcamp.known_plants import find_plant
from hjcamp.model.declare.candidate import Candidate
from hjcamp.records.log import TestLog

CAPACITY, LOSS, BESIDE, DELAY, PERIOD = 400.0, 1.0, 0.6, 300.0, 5.0
LIBRARY = ("leakage", "overflow", "second_store", "sensor_lag")
PLANT = '''"""A plate."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, path, sensor, store


class Plate(Plant):
    """A plate that a heater warms and the air cools."""

    period = 5.0
    excess = State("K", typical=30.0)
    heater = Input("W", typical=30.0)
    capacity = Parameter("J/K", 500.0, (10.0, 1e5), "log-uniform", base=True)
    conductance = Parameter("W/K", 0.8, (1e-3, 100.0), "log-uniform", base=True)
    excess_k = Measured("probe", of="excess")

    @staticmethod
    def equations(state, parameter, drive, rate):
        heat = actuator(drive.heater)
        loss = path(parameter.conductance * state.excess, upstream=state.excess)
        rate.excess = store(heat - loss, capacity=parameter.capacity)
        probe = sensor(state.excess)
'''


@pytest.fixture
def plate(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "plate.py").write_text(PLANT, encoding="utf-8")
    return tmp_path


def measured_log(seed: int, hidden: str) -> TestLog:
    """Return a log of the plate, with a second mass beside it or a loss that grows with the third power of its excess."""
    generator, count, small = np.random.default_rng(seed), 1200, 20
    heater = np.repeat(generator.uniform(0.0, 60.0, 40), generator.integers(20, 80, 40))[:count]
    first = second = 0.0
    excess = np.empty(count)
    for k in range(count):
        excess[k] = first
        for _ in range(small):
            step = PERIOD / small
            given = BESIDE * (first - second) if hidden == "second" else 2e-4 * first**3
            second += step * given / (BESIDE * DELAY)
            first += step * (heater[k] - LOSS * first - given) / CAPACITY
    columns = {
        "time_s": PERIOD * np.arange(count),
        "excess_k": excess + 0.05 * generator.standard_normal(count),
        "heater_w": heater,
    }
    return TestLog(columns, {"plant": "plate", "period_s": "5.0", "condition": f"train {seed}"})


@pytest.mark.parametrize("hidden", ["second", "cube"])
def test_what_remembers_is_told_from_what_does_not(plate: Path, hidden: str) -> None:
    measured = measured_tests([measured_log(1, hidden), measured_log(2, hidden)])
    library = load_effects(plant=measured.plant)
    analysis = calibrated(measured, {name: library[name] for name in LIBRARY})
    found = decided(analysis)
    if hidden == "second":
        own = found.model.fitted.candidate.effects["second_store"]
        assert (found.word, found.effects) == ("effect", ("second_store",))
        assert own == {"conductance": pytest.approx(BESIDE, rel=0.05), "delay": pytest.approx(DELAY, rel=0.05)}
        assert found.model.fitted.candidate.base["capacity"] == pytest.approx(CAPACITY, rel=0.02)
    else:
        assert found.word in ("effect", "one_of") and set(found.effects) <= {"leakage", "overflow"} and found.law_left > 0.0


def test_a_free_law_is_no_form_of_what_remembers(plate: Path) -> None:
    plant = find_plant("plate")
    library = load_effects(plant=plant)
    law = unknowns_of(plant, {"excess": (0.0, 50.0)})["unknown_loss_over_level"]
    assert equivalent_laws(law, library["leakage"]) and equivalent_laws(law, library["overflow"])
    assert not equivalent_laws(law, library["second_store"])


@pytest.mark.parametrize(
    ("effect", "low", "high", "shown"),
    [
        ("second_store", 5.0, 9.0, False),
        ("second_store", 300.0, 5e4, False),
        ("second_store", 200.0, 400.0, True),
        ("second_store", 19.0, 40.0, False),
        # a lag that is short is hardly there, which its value says
        ("sensor_lag", 0.5, 0.6, True),
    ],
)
def test_a_memory_that_stands_at_its_end_is_not_shown(
    plate: Path, effect: str, low: float, high: float, shown: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    library = load_effects(plant=find_plant("plate"))
    name = {"second_store": "delay", "sensor_lag": "lag"}[effect]
    assert library[effect].parameters[name].bounds == {"second_store": (5.0, 5e4), "sensor_lag": (0.5, 1e3)}[effect]
    monkeypatch.setattr(
        searching, "intervals", lambda fitted, blocks: [Interval(effect, name, 0.5 * (low + high), low, high, False)]
    )
    search = Search.__new__(Search)
    search.library, search.blocks = library, np.zeros(3, dtype=int)
    # six coefficients of 24 samples of 5 s: what is forgotten within 20 s follows the moment
    layout: Any = SimpleNamespace(width=24, basis=np.zeros((24, 6)), measured=SimpleNamespace(period=PERIOD))
    search.windows = SimpleNamespace(layout=layout)  # type: ignore[assignment]
    assert search.shortest_memory == 20.0
    model: Any = SimpleNamespace(fitted=None, beyond=lambda before: (effect,))
    assert search.of_no_memory(model, model) != shown


@pytest.mark.parametrize("driver", ["low", "high", "w", "a0"])
def test_a_state_may_have_any_name_beside_those_of_a_free_law(driver: str) -> None:
    law: Any = gain_over("arm", "force", "force", driver, "m")
    assert set(law.terms["force"].arguments) == {"force", driver, *ENDS, *(f"{KNOT}{k}" for k in range(6))} and driver != AT
    assert law.force(2.0, 0.5, 0.0, 1.0, *(0.1 * k for k in range(6))) == pytest.approx(2.0 * 1.25)


def test_what_a_model_has_is_fitted_with_the_base_and_shown_beside_it(plate: Path) -> None:
    measured = measured_tests([measured_log(1, "second")])
    library = load_effects(plant=measured.plant)
    start = Candidate({}, {"second_store": {"conductance": 0.5, "delay": 250.0}})
    rows = calibration(calibrated(measured, {name: library[name] for name in LIBRARY}, start))
    assert {"capacity", "conductance", "second_store conductance", "second_store delay"} <= rows.keys()
    row = rows["second_store delay"]
    assert (row["published"], row["unit"]) == (250.0, "s") and row["value"] == pytest.approx(DELAY, rel=0.05)
    assert row["ci95"][0] < DELAY < row["ci95"][1]


def test_friction_that_changes_for_longer_than_a_test_is_friction_that_changes(axis: Path) -> None:
    library = load_effects(plant=find_plant("axis"))
    assert library["friction_drift"].states and not times_remembered(library["friction_drift"])
    assert [memory_end((None, 3.0), (1.0, 9.0), 0.0), memory_end((2.0, None), (1.0, 9.0), 0.0)] == ["least", "most"]
    assert set(times_remembered(library["maxwell_element"])) == {"relaxation"} and not times_remembered(
        library["command_delay"]
    )


@pytest.mark.parametrize(("ends", "said"), [((5.0, 9.0), "at the least"), ((300.0, 5e4), "at the most"), ((200.0, 400.0), "")])
def test_a_memory_that_is_not_shown_is_said_to_be_none(plate: Path, ends: tuple[float, float], said: str) -> None:
    library = load_effects(plant=find_plant("plate"))
    row = {
        "effect": "second_store",
        "heldout_error_ratio": 0.6,
        "t": 5.0,
        "t_needed": 3.0,
        "parameters": {"conductance": {"ci95": [0.1, 0.2]}, "delay": {"ci95": [*ends]}},
    }
    found = no_memory_words([row], library)
    assert [said in one and "would take 40 %, but its delay is at the" in one for one in found] == ([True] if said else [])
    assert len(no_memory_words([row], library, shortest=ends[0])) == 1
    assert no_memory_words([row | {"t": 2.0}], library) == []
