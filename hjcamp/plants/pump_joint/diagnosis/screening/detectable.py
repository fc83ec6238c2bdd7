"""How small an effect would have been seen in these tests, and which effects they cannot tell apart."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.declare.effect import Effect
from hjcamp.plants.pump_joint.diagnosis.screening.screening import Screening

Array = NDArray[np.float64]
SIMILAR = 0.8
INVISIBLE = 0.02


def detectable_amplitudes(
    screening: Screening, effects: Sequence[type[Effect]], needed: Mapping[str, float]
) -> dict[str, tuple[str, float, str]]:
    """Return for each effect the amplitude whose predicted gain would be the ``needed`` one: (parameter, value, unit)."""
    found: dict[str, tuple[str, float, str]] = {}
    by_name = {effect.name: effect for effect in effects}
    base = len(screening.unknowns)
    beside = _Beside(screening)
    for probe in screening.probes:
        for name, column, height in zip(probe.lifted, probe.columns, probe.heights, strict=True):
            unexplained = beside.product([base + column])[0, 0]
            if not name or unexplained < 1e-12:
                continue
            smallest = math.sqrt(needed[probe.effect] / unexplained) * abs(height)
            if probe.effect not in found or smallest < found[probe.effect][1]:
                found[probe.effect] = (name, smallest, by_name[probe.effect].parameters[name].unit)
    return found


def confounded(screening: Screening) -> list[dict[str, object]]:
    """Return pairs of effects whose responses these tests cannot tell apart, and effects that they cannot see at all.

    The cosine is the largest canonical one between the responses of two effects, beside the base parameters. An effect
    that keeps less than a fiftieth of its response beside the base parameters counts as invisible.
    """
    beside = _Beside(screening)
    base = len(screening.unknowns)
    groups = {name: [base + column for column in probe.columns] for name, (probe, _) in screening.best.items()}
    found: list[dict[str, object]] = []
    names = sorted(groups)
    for name in names:
        share = beside.share(groups[name])
        if share < INVISIBLE:
            found.append({"effects": [name], "cosine": round(1.0 - share, 3), "with": "base parameters"})
    for index, first in enumerate(names):
        for second in names[index + 1 :]:
            cosine = beside.cosine(groups[first], groups[second])
            if cosine > SIMILAR:
                found.append({"effects": [first, second], "cosine": round(cosine, 3), "with": "each other"})
    return sorted(found, key=lambda row: -float(str(row["cosine"])))


def similar(screening: Screening, name: str, least: float) -> list[str]:
    """Return the effects whose response has a cosine of at least ``least`` with that of ``name``, beside the base."""
    beside, base = _Beside(screening), len(screening.unknowns)
    groups = {one: [base + column for column in probe.columns] for one, (probe, _) in screening.best.items()}
    return [one for one in groups if one != name and beside.cosine(groups[name], groups[one]) >= least]


class _Beside:
    """Products of response columns after the base parameters have taken up what they can."""

    def __init__(self, screening: Screening) -> None:
        gram = screening.gram
        square = gram.features.mean_square(screening.about.features) + gram.least**2
        self.total = (gram.products / square[:, :, None, None]).sum(axis=(0, 1))
        own = np.arange(len(screening.unknowns))
        held = self.total[np.ix_(own, own)] + np.diag(screening.known.stiff)
        held += 1e-9 * np.trace(held) / max(len(own), 1) * np.eye(len(own))
        self.left = self.total - self.total[:, own] @ np.linalg.solve(held, self.total[own])

    def product(self, columns: list[int]) -> Array:
        return np.asarray(self.left[np.ix_(columns, columns)])

    def share(self, columns: list[int]) -> float:
        """Return the share of the squared response that the base parameters cannot take up."""
        whole = np.trace(self.total[np.ix_(columns, columns)])
        return float(np.trace(self.product(columns)) / whole) if whole > 0 else 0.0

    def cosine(self, first: list[int], second: list[int]) -> float:
        """Return the largest canonical cosine between two groups of columns."""
        a, b = _root(self.product(first)), _root(self.product(second))
        cross = a @ self.left[np.ix_(first, second)] @ b.T
        return float(min(np.linalg.svd(cross, compute_uv=False)[0], 1.0)) if cross.size else 0.0


def _root(product: Array) -> Array:
    """Return the inverse root of a product matrix; directions without response are left out."""
    values, vectors = np.linalg.eigh(product)
    keep = values > 1e-9 * max(float(values[-1]), 1e-30)
    return np.asarray((vectors[:, keep] / np.sqrt(values[keep])).T)
