"""The source of one step, ``predict`` and ``correct``, its rows written out one by one.

Of a model with gates these are the rows of the plant's own states, for effects without states; else sums in loops serve.
"""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.compile.compose import Composition
from hjcamp.model.compile.shared import width
from hjcamp.model.compile.source_text import function_source

Pattern = NDArray[np.bool_]
L, P1, P2 = range(3)


def written(composition: Composition) -> list[str]:
    """Return the states whose rows are written out."""
    return list(composition.plant.states if composition.gated else composition.states)


def predict_source(composition: Composition, pattern: Pattern, curved: Pattern) -> str:
    """Return the source of ``predict``: rates into ``before`` and the state after one step into ``a``.

    Equations and sparse product stand in one function so that everything stays in registers. ``before[N:]`` holds
    the slope of the nonlinear part of the ``curved`` rates.
    """
    names = written(composition)
    n = len(composition.states)
    lines = [f"for i in range({len(names)}, {n}):", "    a[i] = z[i]"] if len(names) < n else []
    for i, name in enumerate(names):
        lines += [f"f{i} = {composition.rate(name)}", f"before[{i}] = f{i}"]
        lines += [f"b{i} = before[{n + i}] * span"] if curved[i] else []
    for first in range(0, len(names), 4):
        lines += _four(pattern, curved, first)
    signature = "predict(time, span, direction, z, u, p, steps, row, a, before)"
    return function_source(signature, composition.body(lines))


def glide_source(composition: Composition, pattern: Pattern) -> str:
    """Return the source of ``glide``: what ``predict`` does where no rate is curved and no limiter acts."""
    text = predict_source(composition, pattern, np.zeros(len(pattern), dtype=bool)).replace("def predict(", "def glide(")
    return re.sub(r"\blimited\(", "unlimited(", text)


def correct_source(composition: Composition, direct: Pattern, pattern: Pattern, curved: Pattern) -> str:
    """Return the source of ``correct``: add the correction to ``a`` and return its size.

    Only the ``curved`` rates are corrected; ``before[2 * N:]`` receives the slope of their nonlinear part over this step.
    """
    names = written(composition)
    n = len(composition.states)
    bent = pattern & curved
    lines = []
    for i, name in enumerate(names):
        if curved[i]:
            linear = " + ".join([f"before[{i}] + before[{n + i}] * span", *_terms(L, i, "m", direct)])
            lines += [f"g{i} = {composition.rate(name)} - ({linear})"]
            lines += [f"before[{2 * n + i}] = before[{n + i}] + g{i} / span"]
    lines.append("worst = 0.0")
    for i, name in enumerate(names):
        if bent[i].any():
            size = f"size = abs(c{i}) * {1.0 / composition.states[name].resolution!r}"
            lines += [f"c{i} = weight * ({' + '.join(_terms(P2, i, 'g', bent))})", f"a[{i}] += c{i}", size]
            lines += ["if not size <= worst:", "    worst = size"]
    lines.append("return worst")
    # the rates are those after the step
    lines = [re.sub(r"\bz\[", "a[", line) for line in composition.body(lines)]
    moved = np.flatnonzero(direct[curved].any(axis=0))
    lines = [*(f"m{j} = a[{j}] - z[{j}]" for j in moved), *lines]
    signature = "correct(time, span, direction, z, a, u, p, steps, row, before, weight)"
    return function_source(signature, lines)


def _four(pattern: Pattern, curved: Pattern, first: int) -> list[str]:
    """Return the lines that move four states on from the ``first``: their sums at once, over what any of them depends on."""
    n = len(pattern)
    w, count = width(n), min(4, n - first)
    rows = pattern[first : first + 4].any(axis=0)
    found = [(w + j, f"f{j}") for j in np.flatnonzero(rows)] + [(2 * w + j, f"b{j}") for j in np.flatnonzero(rows & curved)]
    if not found:
        return [f"a[{i}] = z[{i}]" for i in range(first, first + count)]
    places = "".join(f"{column * w + first}, " for column, _ in found)
    values = "".join(f"{value}, " for _, value in found)
    return [f"ahead(a, z, {first}, {count}, steps, row, ({places}), ({values}))"]


def _terms(matrix: int, i: int, vector: str, pattern: Pattern) -> list[str]:
    n = len(pattern)
    w = width(n)
    places = [i * w + j if matrix == L else (matrix * w + j) * w + i for j in range(n)]
    return [f"steps[row, {places[j]}] * {vector}{j}" for j in range(n) if pattern[i, j]]
