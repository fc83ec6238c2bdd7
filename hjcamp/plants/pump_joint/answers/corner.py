"""What the tests of the pump joint say of every fitted parameter."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hjcamp.commands.shared.corner import Estimate
    from hjcamp.plants.pump_joint.diagnosis.fitting.heldout import Local


def fitted_parameters(local: Local) -> tuple[list[Estimate], Any]:
    """Return every fitted parameter of a fit, and how the curvature of its loss correlates them (k, k)."""
    from hjcamp.commands.shared.corner import Estimate
    from hjcamp.report.pictures.corner import correlation_of
    from hjcamp.report.wording.units import label

    intervals = local.intervals()
    found = []
    for one, error in zip(local.unknowns, local.standard_errors.tolist(), strict=True):
        value, low, high = intervals[one.effect, one.name]
        said = f"{one.effect.replace('_', ' ')} {label(one.name)}".strip()
        at_bound = not one.parameter.cyclic and value in one.parameter.bounds
        found.append(Estimate(one.effect, said, value, one.parameter.unit, (low, high), error, at_bound))
    return found, correlation_of(local.covariance)
