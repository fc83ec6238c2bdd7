"""The study of the thesis gap: cells, fits, resumption, and that the page says what the committed numbers say."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "benchmarks"))

import thesis_gap_facts  # noqa: E402
import thesis_gap_page  # noqa: E402
import thesis_gap_rig  # noqa: E402
from thesis_gap_cells import HUBER, cells_for, robust  # noqa: E402
from thesis_gap_checks import twin_table  # noqa: E402
from thesis_gap_results import loop_gain  # noqa: E402
from thesis_gap_search import Quantity, base_quantities, evolve, settings_of, surprise  # noqa: E402
from thesis_gap_study import Ledger  # noqa: E402

from hjcamp.backends.simulation import run_test  # noqa: E402
from hjcamp.model.parameter import Parameter  # noqa: E402
from hjcamp.records.log import TestLog  # noqa: E402
from hjcamp.report.indicators import INDICATORS, indicators_of  # noqa: E402

TRAJECTORIES = ("ramp_pos", "ramp_neg", "sine_0p5hz", "sine_1hz", "cycloid_pos", "cycloid_neg", "mixed")
CONDITIONS = [
    {"trajectory": trajectory, "controller": controller, "payload": "none", "orientation": "horizontal"}
    for trajectory in TRAJECTORIES
    for controller in ("pid", "ffwd_pid")
]


def test_the_fitted_cells_are_42_and_4_and_no_payload_is_among_them() -> None:
    cells = cells_for(CONDITIONS, ("5.4.1", "5.4.2"))
    assert len(cells.printed) == 46
    assert np.sum(~cells.logarithmic) == 4
    assert {cells.label(cell)[2] for cell in range(46)} == {"none"}


def test_the_error_of_a_cell_is_made_of_repetitions_rounding_and_form() -> None:
    cells = cells_for(CONDITIONS, ("5.4.1",))
    # Positive ramp, PID, RMSE1: 1.7 with a printed deviation of 0.17 over seven tests.
    place = [cells.label(cell) for cell in range(42)].index(("ramp_pos", "pid", "none", "horizontal", "rmse1_deg"))
    assert cells.sigma[place] == pytest.approx(math.sqrt((0.17**2 / 6 + 0.01 / 12) / 1.7**2 + 0.01))
    assert cells.errors(cells.printed * math.e)[place] == pytest.approx(1 / cells.sigma[place])
    assert np.all(cells.errors(cells.printed) == 0.0)


def test_the_loss_is_a_square_that_goes_on_as_a_line() -> None:
    assert robust(np.array([1.0]))[0] == 1.0
    assert robust(np.array([HUBER + 1.0]))[0] - robust(np.array([HUBER]))[0] == pytest.approx(2 * HUBER)


def test_static_friction_never_falls_below_coulomb_friction() -> None:
    quantities = base_quantities()
    places = np.array([0.1 if one.name.startswith("drop") else one.start for one in quantities])
    settings = settings_of(quantities, places)
    assert settings["static_positive"] == pytest.approx(settings["coulomb_positive"])
    assert surprise(quantities, np.array([one.start for one in quantities])) == 0.0


def test_a_quantity_comes_back_and_stays_within_its_bounds() -> None:
    for parameter in (Parameter("N", 2.0, (0.5, 9.0), "log-uniform"), Parameter("1", 0.0, (-0.4, 0.4))):
        one = Quantity("one", parameter)
        assert one.back(one.forth(0.7 * parameter.bounds[1])) == pytest.approx(0.7 * parameter.bounds[1])
        assert one.back(1e6) == parameter.bounds[1]


def test_the_search_finds_the_bottom_of_a_tilted_bowl_and_repeats_itself() -> None:
    tilt = np.array([[1.0, 0.9], [0.9, 1.0]])

    def bowl(x: np.ndarray) -> float:
        return float((x - 0.5) @ tilt @ (x - 0.5))

    found, lowest = evolve(bowl, np.zeros(2), 0.3, 400, 1)
    assert lowest < 1e-4 and found == pytest.approx([0.5, 0.5], abs=0.05)
    assert np.array_equal(found, evolve(bowl, np.zeros(2), 0.3, 400, 1)[0])


def test_the_ledger_goes_on_where_it_stopped(tmp_path: Path) -> None:
    Ledger(tmp_path / "found.json").keep("one", lambda: 1)
    assert Ledger(tmp_path / "found.json").keep("one", lambda: pytest.fail("computed again")) == 1
    assert not list(tmp_path.glob("*.part"))
    assert Ledger(tmp_path / "found.json", "other equations").keep("one", lambda: 2) == 2


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> Iterator[thesis_gap_rig.Rig]:
    """One condition without the effect library, whose kernel takes a minute to compile."""
    monkeypatch.setattr(thesis_gap_rig, "load_effects", lambda folders: {})
    thesis_gap_rig.gated_simulator.cache_clear()
    places = [
        place for place in thesis_gap_rig.planned("controllers", 1, 1) if place.choices["trajectory"] == "ramp_pos"
    ]
    yield thesis_gap_rig.Rig(places)
    thesis_gap_rig.gated_simulator.cache_clear()


def test_untouched_the_rig_is_the_simulator_of_a_run(small: thesis_gap_rig.Rig) -> None:
    found = small.indicators({})
    for row, place in zip(found, small.places, strict=True):
        config = thesis_gap_rig.configurations("controllers")[f"ramp_pos__{place.choices['controller']}"]
        columns, _ = run_test(config, thesis_gap_rig.seed_of(1, f"ramp_pos__{place.choices['controller']}", 1))
        expected = indicators_of(TestLog(columns, {**place.choices}))
        assert row[0, :3] == pytest.approx([expected[name] for name in INDICATORS[:3]], abs=1e-9)
    neutral = {name: 1.0 if name not in ("moving_mass", "dither_gain") else one.default
               for name, one in thesis_gap_rig.OPENINGS.items()}  # fmt: skip
    assert np.allclose(small.indicators(neutral), found, equal_nan=True, atol=0.05)


def test_every_opening_changes_the_table(small: thesis_gap_rig.Rig) -> None:
    before = small.indicators({})
    for name, one in thesis_gap_rig.OPENINGS.items():
        after = small.indicators({name: one.default * 1.5})
        assert np.nanmax(np.abs(after - before)) > 1e-6, name


def test_a_ramp_says_how_strong_the_integral_is_without_simulation() -> None:
    # 120 deg/s over 70 1/s leaves 1.71 deg where 1.3 is printed: the loop must be stronger than printed.
    positive, negative = loop_gain()
    assert (positive["published"], negative["published"]) == (1.71, 1.33)
    assert positive["least"] == pytest.approx(120 / 70 / 1.35, abs=0.01)
    assert negative["least"] == pytest.approx(120 / 90 / 0.95, abs=0.01)


def test_the_page_is_what_the_committed_numbers_say() -> None:
    found = json.loads((ROOT / "docs" / "thesis_gap.json").read_text(encoding="utf-8"))
    reading = (ROOT / "benchmarks" / "thesis_gap_reading.md").read_text(encoding="utf-8")
    assert (ROOT / "docs" / "thesis_gap.md").read_text(encoding="utf-8") == thesis_gap_page.page(found, reading)
    assert len(found["fitted"]["printed"]) == 46
    assert len(found["predicted"]["printed"]) == 50
    assert {label[2] for label in found["predicted"]["labels"]} == {"brass_8p5g"}
    assert "Written for another result" not in thesis_gap_facts.written(found, reading)
    other = found | {"accepted": 0}
    assert thesis_gap_facts.written(other, reading).startswith("**Written for another result; this run accepts base.**")
    assert thesis_gap_facts.written(found, "<!-- x -->\n{fitted_loss_moonlight}").endswith("(not followed)")


def test_the_page_counts_cells_and_fills_tables() -> None:
    assert thesis_gap_facts.near([0.0, -2.0, 2.1]) == 2
    assert thesis_gap_page.table(["a", "b"], [["x", None]]) == "| a | b |\n|---|---:|\n| x |  |\n"


def test_twins_are_printed_as_the_thesis_prints(small: thesis_gap_rig.Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    import thesis_gap_checks

    cells = cells_for(small.conditions, ("5.4.1",))
    monkeypatch.setattr(thesis_gap_checks, "planned", lambda campaign, repetitions, seed: small.places)
    target = twin_table(cells, {}, 3)
    assert np.allclose(target, target.round(1)) and np.all(target >= 0.1)
    assert np.array_equal(target, twin_table(cells, {}, 3))
    assert not np.array_equal(target, twin_table(cells, {}, 4))
