"""A sensor that ends: seen by equal readings where noise is, by nothing else; left out of fits, and said."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from answer_schemas import check_answer
from gauge import BETWEEN, OUTFLOW, PUMP, measured_log

from hjcamp.commands.any_plant.comparison_words import notes_on
from hjcamp.commands.any_plant.verdict_words import Words
from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.data.saturation import ends_of, within
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.decision.verdict import decided
from hjcamp.diagnosis.design.truth import bench_of
from hjcamp.diagnosis.design.wanted import Wanted
from hjcamp.diagnosis.estimation.intervals import intervals
from hjcamp.diagnosis.results.answer import answer
from hjcamp.diagnosis.results.comparison import answer as answer_of_comparison
from hjcamp.diagnosis.results.comparison import compared
from hjcamp.effects import load_effects
from hjcamp.model.declare.candidate import Candidate
from hjcamp.records.noise import step_of

CHANCE = np.random.default_rng(3)
AT = np.arange(2000)
SINE = np.sin(2.0 * np.pi * AT / 500.0)
NOISY = SINE + 0.01 * CHANCE.standard_normal(2000)
LIBRARY = ("spill_over", "overflow_at_lower", "overflow_at_upper", "flow_exponent_at_outflow")
NONE = (-np.inf, np.inf)


def seen(*tests: np.ndarray) -> tuple[float, float]:
    return ends_of(tests, step_of(np.concatenate(tests)))


def rounded(values: np.ndarray, step: float) -> np.ndarray:
    return np.round(values / step) * step


def test_an_end_is_seen_where_noise_would_not_repeat_it() -> None:
    assert seen(np.minimum(NOISY, 0.9)) == (-np.inf, 0.9)
    assert seen(np.clip(NOISY, -0.8, 0.9)) == (-0.8, 0.9)
    # a converter whose steps are as large as its noise
    low, high = seen(rounded(np.minimum(NOISY, 0.9), 0.01))
    assert (low, high) == (-np.inf, pytest.approx(0.9))
    # one test is enough
    assert seen(0.5 * NOISY, np.minimum(NOISY, 0.9), 0.2 * NOISY) == (-np.inf, 0.9)


@pytest.mark.parametrize(
    "values",
    [
        NOISY,
        rounded(NOISY, 0.1),
        # rest at the largest reading: of an encoder, of a converter as coarse as its noise, with noise
        np.round(np.clip(600.3 * SINE, -400.0, 400.0)),
        np.round(np.clip(4.4 * (AT % 400 - 150), -440.0, 440.0) + 0.6),
        rounded(np.minimum(SINE, 0.9) + 0.01 * CHANCE.standard_normal(2000), 0.02),
        np.minimum(SINE, 0.9) + 0.01 * CHANCE.standard_normal(2000),
        # no noise at all: nothing says that the machine does not rest there
        np.minimum(SINE, 0.9),
        # rest at the beginning, before anything is switched on
        np.concatenate([np.full(300, -2.0), NOISY]),
        np.full(500, 3.0),
        # a channel that is refreshed each tenth sample
        np.repeat(NOISY[::10], 10),
        np.repeat([0.0, 1.0, 0.0, 2.0], 100),
    ],
)
def test_what_rests_has_no_end(values: np.ndarray) -> None:
    assert seen(values) == NONE


def test_noise_is_that_between_the_ends() -> None:
    held = np.minimum(NOISY, 0.0)
    assert seen(held) == (-np.inf, 0.0)
    assert len(within(held, -np.inf, 0.0)) < 1100 and within(np.zeros(70), -np.inf, 0.0).shape == (70,)


def asked(tanks: Path, *, end: float, brim: float = np.inf, seed: int = 1) -> tuple[dict, str]:  # type: ignore[type-arg]
    measured = measured_tests([measured_log(end, brim, seed)])
    library = load_effects(plant=measured.plant)
    chosen = {name: library[name] for name in LIBRARY}
    analysis = calibrated(measured, chosen)
    found = analysis, decided(analysis)
    content = json.loads(json.dumps(answer(*found, 0.0), allow_nan=False))
    check_answer(content)
    return content, " ".join(Words(*found, content).sentences())


@pytest.mark.study
def test_the_spill_of_the_upper_tank_is_named_though_the_gauge_of_the_lower_one_ends(tanks: Path) -> None:
    found, said = asked(tanks, end=6.0, brim=7.0)
    assert (found["verdict"], found["effects"]) == ("effect", ["spill_over"])
    row = found["candidates"][0]["parameters"]
    assert row["brim"]["value"] == pytest.approx(7.0, rel=0.1) and row["caught"]["value"] == pytest.approx(0.5, abs=0.1)
    assert found["ends"]["level_v"] == {"low": None, "high": 6.0, "unit": "V", "share": pytest.approx(0.11, abs=0.02)}
    assert "level reads no higher than 6 V: predictions are held there" in said


@pytest.mark.study
@pytest.mark.parametrize("seed", [1, 4])
def test_an_end_is_nothing_that_a_model_lacks(tanks: Path, seed: int) -> None:
    # taken as it is read, the end passes for an overflow of the lower tank, or for something outside the library
    found, _ = asked(tanks, end=6.0, seed=seed)
    assert found["verdict"] == "nothing_missing" and found["error"]["baseline"] < 1.4
    assert asked(tanks, end=np.inf, seed=seed)[0]["ends"] == {}


def test_the_base_is_found_beside_an_end_and_predictions_are_held_there(tanks: Path) -> None:
    # a quarter of the readings of seed 4 stand at the end
    measured = measured_tests([measured_log(6.0, seed=seed) for seed in (4, 1)])
    found = compared(measured, {}, {"published": Candidate({}, {})})
    base = {one.name: one.value for one in intervals(found.analysis.base.fitted, found.analysis.search.blocks)}
    assert [base[name] for name in ("k1", "k3", "k4")] == pytest.approx([BETWEEN, OUTFLOW, PUMP], rel=0.03)
    layout = found.analysis.windows.layout
    there = layout.readings[:, 0] == 6.0
    assert 0.1 < there.mean() < 0.4
    predicted = layout.readings - found.calibrated.errors
    assert predicted[there].max() == 6.0 and np.mean(predicted[there] == 6.0) > 0.9
    raw = found.analysis.windows.readings(found.analysis.base.fitted.candidate)[0]
    assert raw[there].max() > 6.3
    content = answer_of_comparison(found)
    check_answer(content)
    assert content["ends"]["level_v"]["high"] == 6.0 and "no higher than 6 V" in notes_on(found)[0]


def test_simulated_tests_of_the_menu_end_where_the_measured_ones_do(tanks: Path) -> None:
    analysis = calibrated(measured_tests([measured_log(6.0, seed=4)]), {}, unknowns=False)
    measured, model = analysis.measured, analysis.base.fitted.candidate
    fuller = Wanted("fuller", "", 0, 1.1 * measured.tests[0].inputs, measured.tests[0].readings)
    simulated = bench_of(analysis, [fuller], model, by_motion=False).simulated(analysis, model).layout
    assert simulated.readings.max() == 6.0 and simulated.at_ends.mean() > analysis.windows.layout.at_ends.mean()
