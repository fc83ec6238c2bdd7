"""A limiter that acts, or a contact that holds, is a linear regime of its own, whose propagators are made once."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pytest
from quiet_loop import columns, cycloid, sine

from hjcamp.model.compile import regimes, shared
from hjcamp.model.compile.kernel import LEVELS, shared_source
from hjcamp.model.compile.kernel_cache import load_kernel
from hjcamp.model.run.simulator import Propagators, Simulator
from hjcamp.plants.pump_joint.controllers.pid import Pid
from hjcamp.plants.pump_joint.loop import JointSimulator

LOW_PRESSURES = (0.02e6, 0.12e6)


def hunting(tolerance: float, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Return a test of the published loop with the payload, whose lines run down to the vapour pressure."""
    with monkeypatch.context() as patch:
        patch.setattr(JointSimulator, "run", functools.partialmethod(JointSimulator.run, tolerance=tolerance))
        return columns(
            cycloid(-120.0), LOW_PRESSURES, Pid, {"first_direction": -1.0}, ("gravity_load", "payload_inertia"),
            {"gravity_load.load_mass": 0.0}, count=2 * np.pi / 1024, dither=1.2,
        )  # fmt: skip


def test_where_a_line_is_at_the_vapour_pressure_the_steps_are_long_and_converged(monkeypatch: pytest.MonkeyPatch) -> None:
    found, finer, finest = (hunting(tolerance, monkeypatch) for tolerance in (1.0, 0.1, 0.001))
    at_the_floor = np.mean(found["pressure1_mpa"] <= -98.9e3) + np.mean(found["pressure2_mpa"] <= -98.9e3)
    assert at_the_floor > 0.05
    samples = len(found["arm_deg"])
    # when every rate was corrected there, a sample took eight steps and more
    assert found["steps"] < 3.0 * samples
    assert finest["steps"] < 4.0 * samples
    for one in (found, finer):
        np.testing.assert_array_equal(one["arm_deg"][:1000], finest["arm_deg"][:1000])


def test_regimes_are_made_when_they_are_entered_and_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[Propagators] = []
    plain = Simulator.propagators
    with monkeypatch.context() as patch:
        patch.setattr(Simulator, "propagators", lambda self, z, p: made.append(plain(self, z, p)) or made[-1])
        columns(sine(60.0, 0.5, 1.0), (0.32e6, 0.14e6))
    plan = made[0].plan
    codes = plan[shared.CODES : shared.CODES + plan[shared.MADE]]
    # held, positive and negative; held again while a line is emptied: the third limiter holds its low end, 3^2
    assert sorted(codes) == [0, 1, 2, regimes.SIDES * 3**2]
    held = made[0].steps[list(codes).index(0) * (LEVELS + 1)]
    assert np.all(np.isfinite(held))


def test_propagators_are_those_of_the_matrix_exponential() -> None:
    from scipy.linalg import expm

    generator = np.random.default_rng(5)
    n, w, h = 6, shared.width(6), 1e-3
    jacobian = np.zeros((w, w))
    jacobian[:n, :n] = generator.normal(size=(n, n)) * 500.0
    space, steps = np.zeros((shared.SPACE, w * w)), np.zeros((LEVELS + 1, 3 * w * w))
    space[shared.JACOBIAN] = jacobian.ravel()
    load_kernel(shared_source()).propagators(h, LEVELS, w, space, steps, 0)
    for level in (0, 3, LEVELS):
        span = h / 2**level
        block = np.zeros((3 * n, 3 * n))
        block[:n, :n] = jacobian[:n, :n]
        block[:n, n : 2 * n] = block[n : 2 * n, 2 * n :] = np.eye(n)
        whole = expm(block * span)
        linear, first, second = steps[level].reshape(3, w, w)
        assert linear[:n, :n] == pytest.approx(jacobian[:n, :n])
        assert first.T[:n, :n] == pytest.approx(whole[:n, n : 2 * n], rel=1e-10, abs=1e-12 * span)
        assert second.T[:n, :n] * span == pytest.approx(whole[:n, 2 * n :], rel=1e-9, abs=1e-12 * span**2)
