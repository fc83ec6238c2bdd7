"""What a probe promises beside parameters that are free, and beside one that stands at its bound."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hjcamp.diagnosis.estimation.gauss_newton import Fitted, Free
from hjcamp.diagnosis.estimation.likelihood import loss
from hjcamp.diagnosis.residuals.kernels import Kernels
from hjcamp.diagnosis.screening.screening import Probe, Projection
from hjcamp.model.compile.compose import MOST_GATED
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.parameter import Parameter

LAW: Any = SimpleNamespace(parameters={"delay": Parameter("s", 1.0, (0.0, 10.0), off=0.0)})


@pytest.mark.parametrize(("late", "told"), [(1.0, False), (2.0, True)])
def test_what_stands_at_a_bound_explains_no_more(late: float, told: bool) -> None:
    """The base's delay and an effect's change the features alike; the base's ends at 2 s."""
    generator = np.random.default_rng(4)
    shape = generator.standard_normal((40, 3))
    features = 5.0 * shape + generator.standard_normal((40, 3))
    free = Free("", "late", 1.0, 0.0, 2.0)
    fitted = Fitted(Candidate({"late": late}, {}), (free,), features, -5.0 * shape[:, :, None], loss(features))
    probe = Probe("delay", {"delay": 1.0}, ("delay",), np.array([1.0]), True, -5.0 * shape[:, :, None])
    promise = Projection(fitted).promise(probe, LAW)
    assert (promise.gain > 10.0) == told
    if told:
        assert promise.candidate.effects["delay"]["delay"] == pytest.approx(1.0, abs=0.1)
        assert promise.candidate.base == {"late": 2.0}


def test_forms_and_what_is_held_share_a_kernel_with_every_effect() -> None:
    names = [f"e{k}" for k in range(2 * MOST_GATED + 7)]
    effects: Any = {name: SimpleNamespace(granted="give" if name == "e3" else "") for name in names}
    plant: Any = SimpleNamespace(name="axis")
    kernels = Kernels(plant, effects)
    first = kernels._chunks[0]
    kernels.hold(["e5", names[-1]])
    assert kernels._chunks[0] == first and max(len(chunk) for chunk in kernels._chunks) <= MOST_GATED
    for name in names[MOST_GATED:]:
        assert kernels._gated(kernels._chosen({"e3", "e5", names[-1], name}))
