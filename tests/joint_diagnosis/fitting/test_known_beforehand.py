"""A scale of both sensors explains nothing, and what lets the rig be as it was known to be does."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import plain_kernel
import pytest

from hjcamp.effects import load_effects
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.run import simulator
from hjcamp.plants.pump_joint.analyses.evidence import evidence_of
from hjcamp.plants.pump_joint.diagnosis.models.saved import complete
from hjcamp.plants.pump_joint.diagnosis.residuals.views import HOME, Views
from hjcamp.plants.pump_joint.diagnosis.screening.normal_equations import Gram, Group, Known, all_gains

SCALED = ("static", "coulomb", "viscous", "moving_mass", "line_stiffness")


@pytest.mark.parametrize("scale", [0.2, -0.1])
def test_forces_are_read_in_the_units_of_the_sensors(leak: Path, scale: float, monkeypatch: pytest.MonkeyPatch) -> None:
    # one test in plain Python: a kernel with this effect would be compiled for nothing else
    monkeypatch.setattr(simulator, "load_model", plain_kernel.plain)
    monkeypatch.setattr(Views, "_needed", lambda self, candidate, hardware: self.effects)
    views = Views(evidence_of([leak / "ramp_hold_r1.mcap"]), (load_effects([])["pressure_gain"],))
    plain = complete(Candidate({}), views.evidence)
    scaled = {name: value / (1.0 + scale) if name.startswith(SCALED) else value for name, value in plain.base.items()}
    both = Candidate(scaled, {"pressure_gain": {"error1": scale, "error2": scale}})
    found, wanted = views.residuals(both), views.residuals(plain)
    assert np.any(wanted[:, HOME - 1] != 0.0)
    for channel in range(found.shape[1]):
        assert found[:, channel] == pytest.approx(wanted[:, channel], abs=1e-6 * np.abs(wanted[:, channel]).max())


def gram(columns: np.ndarray) -> Gram:
    """Products of columns (columns, blocks) seen in one channel of two tests."""
    blocks = columns.shape[1]
    edges, counts = np.array([0, blocks // 2, blocks]), np.full((2, 1), blocks // 2)
    features = SimpleNamespace(edges=edges, counts=counts)
    features.mean_square = lambda residual: np.add.reduceat(residual**2, edges[:-1], axis=0) / counts
    return Gram.of(columns[:, :, None], cast(Any, features), np.array([0.01]))


def test_what_lets_a_known_parameter_go_back_gains_by_that() -> None:
    generator = np.random.default_rng(5)
    response, noise = generator.standard_normal(200), 0.01 * generator.standard_normal((200, 1))
    same = gram(np.stack([response, response]))
    far, near = Known(np.array([100.0]), np.array([0.2])), Known(np.array([100.0]), np.array([0.0]))
    similar = Group((1,), (True,), np.zeros((1, 1)))
    (gain,), (found,) = all_gains(same, noise, far, [similar])
    assert gain == pytest.approx(4.0, rel=0.05), "all of (0.2 / 0.1)^2"
    assert found == pytest.approx([-0.2, 0.2], abs=0.02)
    (gain,), _ = all_gains(same, noise, near, [similar])
    assert gain == pytest.approx(0.0, abs=0.1)


def test_the_move_of_the_base_within_a_column_counts_as_one() -> None:
    generator = np.random.default_rng(6)
    response, noise = generator.standard_normal(200), 0.01 * generator.standard_normal((200, 1))
    # the column holds its own compensation: an effect that looks like the base moved by -1, and the base moved back by it
    nothing = gram(np.stack([response, np.zeros(200)]))
    known = Known(np.array([100.0]), np.array([0.2]))
    (gain,), (found,) = all_gains(nothing, noise, known, [Group((1,), (True,), np.array([[-1.0]]))])
    assert gain == pytest.approx(4.0, rel=0.05)
    assert found == pytest.approx([0.0, 0.2], abs=0.02)
    (gain,), _ = all_gains(nothing, noise, known, [Group((1,), (True,), np.array([[0.0]]))])
    assert gain == pytest.approx(0.0, abs=1e-3)
