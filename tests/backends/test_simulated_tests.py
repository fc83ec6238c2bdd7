"""Whole simulated tests: the procedure's pressures, the same answer in every process, compiled or not."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hjcamp.configuration.composer import Composer
from hjcamp.errors import HjcampError
from hjcamp.plants.pump_joint.simulation import run_test

ROOT = Path(__file__).parents[2]
QUIET = ["rig.scatter.friction_between=0", "rig.scatter.friction_within=0", "rig.scatter.initial_pressure_mpa=0"]
SCRIPT = """
import json, sys
import numpy as np
from hjcamp.plants.pump_joint.simulation import run_test
columns, _ = run_test(json.load(sys.stdin), 7)
np.savez(sys.argv[1], **columns)
"""


def in_another_process(config: dict[str, Any], place: Path, **environment: str) -> dict[str, np.ndarray]:
    """Return the columns of the test with seed 7, simulated by a fresh Python."""
    path = [str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
    subprocess.run(
        [sys.executable, "-c", SCRIPT, str(place)],
        input=json.dumps(config),
        text=True,
        check=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(path), **environment},
        timeout=300,
    )
    with np.load(place) as found:
        return {name: found[name] for name in found.files}


def digest(columns: dict[str, np.ndarray]) -> str:
    """Return one hash of all columns."""
    total = hashlib.sha256()
    for name in sorted(columns):
        total.update(name.encode() + np.ascontiguousarray(columns[name]).tobytes())
    return total.hexdigest()


def test_procedure_builds_up_the_initial_pressures(composer: Composer) -> None:
    config = composer.compose(["trajectory=ramp_pos", "controller=pid", "rig.sensors.pressure_noise_mpa=0", *QUIET]).config
    columns, _ = run_test(config, 1)
    phase, p1, p2 = columns["phase"], columns["pressure1_mpa"], columns["pressure2_mpa"]
    # 1 mm/s of a 6.35 mm piston into 0.0257 MPa/mm3: 0.814 MPa/s in both lines, from 0.06 to 0.26 MPa
    rate = 0.0257 * np.pi / 4 * 6.35**2
    assert np.sum(phase == 0) == pytest.approx(0.20 / rate * 1000, abs=1.5)
    assert np.diff(p1[phase == 0]) == pytest.approx(rate * 1e-3, rel=1e-6)
    rest = phase == 2
    assert np.sum(rest) == 200
    # The pump runs on for its lag after the adjustment has ended at 0.2 MPa
    assert 0.2 <= (p1 - p2)[rest][0] < 0.23
    assert (p1 - p2)[rest][-1] < 0.573
    assert (p1 + p2)[rest] == pytest.approx(2 * 0.26, abs=2e-3)
    assert np.ptp(columns["arm_deg"][phase < 3]) == 0.0
    assert columns["time_s"][int(np.argmax(phase == 3))] == 0.0


@pytest.mark.parametrize(("trajectory", "direction"), [("ramp_pos", 1), ("ramp_neg", -1)])
def test_adjustment_goes_the_way_the_test_starts(composer: Composer, trajectory: str, direction: int) -> None:
    config = composer.compose([f"trajectory={trajectory}", "controller=pid", *QUIET]).config
    columns, _ = run_test(config, 1)
    difference = (columns["pressure1_mpa"] - columns["pressure2_mpa"])[columns["phase"] == 2]
    assert direction * difference.mean() > (0.19 if direction > 0 else 0.09)


def test_equal_seeds_give_equal_columns_in_two_processes(composer: Composer, tmp_path: Path) -> None:
    config = composer.compose(["trajectory=ramp_pos", "controller=ffwd_pid"]).config
    here, _ = run_test(config, 7)
    other, _ = run_test(config, 8)
    there = in_another_process(config, tmp_path / "columns.npz")
    assert digest(here) == digest(there)
    assert digest(here) != digest(other)


def test_kernel_gives_the_same_answer_as_plain_python(composer: Composer, tmp_path: Path) -> None:
    chosen = ["controller=pid", "trajectory=ramp", "trajectory.amplitude_deg=12", "trajectory.duration=0.2"]
    chosen += ["trajectory.rise_time=0.2", "procedure.initial.pressure1_mpa=0.3", "procedure.initial.pressure2_mpa=0.2"]
    chosen += ["procedure.release_mpa=0.25"]
    config = composer.compose(chosen).config
    compiled, _ = run_test(config, 7)
    plain = in_another_process(config, tmp_path / "columns.npz", NUMBA_DISABLE_JIT="1", HJCAMP_CACHE=str(tmp_path))
    assert len(plain["time_s"]) == len(compiled["time_s"])
    assert np.ptp(plain["arm_deg"]) > 1.0
    for name in compiled:
        # whole counts, and analog values to round-off
        assert plain[name] == pytest.approx(compiled[name], rel=1e-9, abs=1e-9), name


@pytest.mark.parametrize("lines", [["controller.positive.kp=900"], ["++model.parameters.pump_area=0.01"]])
def test_an_arm_that_goes_where_none_can_is_a_failed_test(composer: Composer, lines: list[str]) -> None:
    composition = composer.compose(["trajectory=ramp_pos", *lines])
    with pytest.raises(HjcampError, match="more than a turn: no arm of this joint can"):
        run_test({**composition.config, "controller_model": composer.model("published")}, 1)
