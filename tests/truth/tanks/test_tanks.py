"""The truth tanks against answers by hand: Torricelli, balance, steady levels, each hidden effect, files and draws."""

import json
from pathlib import Path

import numpy as np
import pytest

from truth.tanks.case import build_tanks_case, simulate_tanks, write_tanks_case
from truth.tanks.hidden import FORMS
from truth.tanks.plant import PERIOD, Tanks, run

QUIET = Tanks(noise=0.0, count=1e-9)


def quiet(tanks: Tanks, pump: np.ndarray, start: tuple[float, float]) -> np.ndarray:
    """Return the rows of a test without chance."""
    return run(tanks, pump, start, np.zeros((pump.size, 2)), np.zeros(pump.size))


def brimming(flow: float) -> float:
    """Return the level h with 0.05 sqrt(h) + (h - 3) = flow."""
    root = (-0.05 + (0.05**2 + 4 * (3.0 + flow)) ** 0.5) / 2
    return root**2


def test_a_tank_runs_out_along_a_parabola() -> None:
    rows = quiet(QUIET, np.zeros(100), (9.0, 0.0))
    time = np.arange(100) * PERIOD
    assert np.abs(rows[:, 3] - np.maximum(3.0 - 0.025 * time, 0.0) ** 2).max() < 2e-3


def test_what_flows_in_is_what_stays_and_what_flows_out() -> None:
    rows = quiet(QUIET, np.full(400, 3.0), (2.0, 5.0))
    left = 0.05 * np.sqrt(rows[:, 2])
    out = np.sum(0.5 * (left[1:] + left[:-1])) * PERIOD
    stayed = rows[-1, 2:].sum() - 7.0
    assert stayed + out == pytest.approx(3.0 * 0.035 * PERIOD * 399, rel=1e-3)
    assert rows[-1, 2:] == pytest.approx([(0.105 / 0.05) ** 2] * 2, rel=1e-2)


@pytest.mark.parametrize(
    ("changes", "level"),
    [
        ({"leak": 0.01}, lambda q: ((0.0025 + 0.04 * q) ** 0.5 - 0.05) ** 2 / 4e-4),
        ({"saturation": 2.0}, lambda q: (0.07 / 0.05) ** 2),
        ({"dead_band": 1.0}, lambda q: (0.07 / 0.05) ** 2),
        ({"laminar": 10.0}, lambda q: 10.0 * q + (q / 0.05) ** 2),
        ({"exponent": 0.5}, lambda q: q * 5.0**0.5 / 0.05),
        ({"brim_lower": 3.0, "spill": 1.0}, brimming),
    ],
)
def test_where_the_level_stays(changes: dict[str, float], level) -> None:
    rows = quiet(QUIET._replace(**changes), np.full(900, 3.0), (4.0, 3.0))
    assert rows[-1, 2] == pytest.approx(level(0.105), rel=5e-3)


def test_a_delay_and_a_lag_come_late_by_what_they_say() -> None:
    pump = np.repeat([1.0, 4.0, 2.0], 60)
    plain = quiet(QUIET, pump, (2.0, 2.0))
    late = quiet(QUIET._replace(delay=20.0), pump, (2.0, 2.0))
    waited = quiet(QUIET, np.concatenate([np.full(5, pump[0]), pump])[: pump.size], (2.0, 2.0))
    assert late == pytest.approx(waited)
    ramp = quiet(QUIET._replace(lag=12.0), pump, (2.0, 2.0))
    shift = np.argmin([np.abs(ramp[k + 10 : 170 + k, 0] - plain[10:170, 0]).sum() for k in range(8)])
    assert shift == 3


@pytest.mark.parametrize("form", FORMS, ids=lambda form: f"{form.effect}-{form.name}")
def test_what_hides_changes_the_level(form) -> None:
    # the strongest of a few rigs: not every rig's levels reach a brim
    ratios = []
    for seed in (1, 2):
        case = build_tanks_case(form.effect, form.name, seed)
        rows, plain, again = (
            simulate_tanks(tanks, seed, "steps", k)[2][:, 0] for tanks, k in ((case.tanks, 0), (case.plain, 0), (case.plain, 1))
        )
        ratios.append((np.mean((rows - plain) ** 2) / np.mean((again - plain) ** 2)) ** 0.5)
    assert np.isfinite(ratios).all()
    assert max(ratios) > (1.0 if form.effect in ("command_delay", "sensor_lag", "siphon") else 1.5)


def test_every_effect_has_a_form_that_the_program_does_not_know() -> None:
    assert {form.effect for form in FORMS} == {form.effect for form in FORMS if not form.ours or not form.names}


@pytest.mark.parametrize("observed", [True, False])
def test_a_case_on_disk(tmp_path: Path, observed: bool) -> None:
    path = write_tanks_case(tmp_path / "case", "sensor_offset", "steady", 5, False, observed=observed)
    answer = json.loads(path.read_text())
    assert answer["effects"] == ["sensor_offset_at_gauge" if observed else "sensor_offset"]
    assert len(list((path.parent / "measured").iterdir())) == 15
    table = np.loadtxt(path.parent / "measured" / "fill_1.csv", delimiter=",", skiprows=1)
    assert table.shape == (180, 4 if observed else 3)
    assert np.diff(table[:, 0]) == pytest.approx(4.0)
    source = (path.parent / "plants" / "tanks.py").read_text()
    compile(source, "tanks.py", "exec")
    assert ('start="unknown"' in source) != observed
    again = write_tanks_case(tmp_path / "again", "sensor_offset", "steady", 5, False, observed=observed)
    assert (again.parent / "measured" / "fill_1.csv").read_bytes() == (path.parent / "measured" / "fill_1.csv").read_bytes()


def test_starts_and_rigs_differ() -> None:
    case, other = build_tanks_case(seed=1), build_tanks_case(seed=2)
    assert case.tanks.between != other.tanks.between
    first, second = (simulate_tanks(case.tanks, 1, "fill", k)[2][0, 2] for k in (0, 1))
    assert first != second
    with pytest.raises(ValueError, match="known are nothing, leak"):
        build_tanks_case("leek")
