"""The source of one step, ``predict`` and ``correct``: an effect whose gate is closed costs a test, not its rows."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.compose import Composition, function_source

Pattern = NDArray[np.bool_]


def predict_source(composition: Composition, pattern: Pattern, curved: Pattern, everything: bool = False) -> str:
    """Return the source of ``predict``: rates into ``before`` and the state after one step into ``a``.

    Equations and sparse product stand in one function so that everything stays in registers. ``before[N:]`` holds
    the slope of the nonlinear part of the ``curved`` rates, in ``predict_all`` of every rate, which is carried on.
    """
    step = _Step(composition, curved | everything)
    n = len(step.names)

    def rate(i: int) -> list[str]:
        carried = [f"b{i} = before[{n + i}] * span"] if step.curved[i] else []
        return [f"f{i} = {composition.rate(step.names[i])}", f"before[{i}] = f{i}", *carried]

    lines = step.rows(rate)
    lines += step.sums("m", "p1", "f", pattern)
    lines += step.sums("n", "p2", "b", pattern & step.curved)
    lines += step.rows(lambda i: [f"a[{i}] = z[{i}] + m{i} + n{i}"], lambda i: [f"a[{i}] = z[{i}]"])
    name = "predict_all" if everything else "predict"
    return function_source(f"{name}(time, span, direction, z, u, p, p1, p2, a, before)", composition.body(lines))


def correct_source(composition: Composition, pattern: Pattern, curved: Pattern, everything: bool = False) -> str:
    """Return the source of ``correct``: add the correction to ``a`` and return its size.

    Only the ``curved`` rates are corrected, in ``correct_all`` every rate; ``before[2 * N:]`` receives the slope of
    their nonlinear part over this step.
    """
    step = _Step(composition, curved | everything)
    n = len(step.names)
    bent = pattern & step.curved

    def known(i: int) -> list[str]:
        return [f"b{i} = before[{i}]", *([f"s{i} = before[{n + i}]"] if step.curved[i] else [])]

    def surplus(i: int) -> list[str]:
        g = [f"g{i} = {composition.rate(step.names[i])} - m{i} - n{i}", f"before[{2 * n + i}] = s{i} + g{i} / span"]
        return g if step.curved[i] else []

    def corrected(i: int) -> list[str]:
        size = f"size = abs(c{i}) * {1.0 / composition.states[step.names[i]].resolution!r}"
        take = [f"c{i} = weight * c{i}", f"a[{i}] += c{i}", size, "if not size <= worst:", "    worst = size"]
        return take if bent[i].any() else []

    lines = step.rows(known)
    lines += step.sums("m", "e", "b", pattern & step.curved[:, None])
    lines += step.sums("n", "p1", "s", bent & step.curved[:, None])
    lines += step.rows(surplus)
    lines += step.sums("c", "p2", "g", bent)
    lines += ["worst = 0.0", *step.rows(corrected), "return worst"]
    name = "correct_all" if everything else "correct"
    lines = [re.sub(r"\bz\[", "a[", line) for line in composition.body(lines)]
    return function_source(f"{name}(time, span, direction, a, u, p, e, p1, p2, before, weight)", lines)


class _Step:
    """The rows of a step; ``blocks`` are the gates with the states behind them, those without any gate first."""

    def __init__(self, composition: Composition, curved: Pattern) -> None:
        self.names, self.curved = list(composition.states), curved
        self.blocks: list[tuple[str, list[int]]] = [("", [])]
        for index, name in enumerate(self.names):
            gate = composition.gate(name)
            if gate != self.blocks[-1][0]:
                self.blocks.append((gate, []))
            self.blocks[-1][1].append(index)

    def rows(
        self, lines: Callable[[int], Sequence[str]], otherwise: Callable[[int], Sequence[str]] | None = None
    ) -> list[str]:
        """Return the lines of every state behind its gate, and what is done where the gate is closed."""
        found: list[str] = []
        for gate, own in self.blocks:
            absent = [line for i in own for line in otherwise(i)] if otherwise else []
            found += _guarded(gate, [line for i in own for line in lines(i)], absent)
        return found

    def sums(self, name: str, matrix: str, vector: str, pattern: Pattern) -> list[str]:
        """Return the lines that sum up a matrix times a vector, what is behind a closed gate left out."""
        found = [f"{name}{i} = 0.0" for i in range(len(self.names))]
        for gate, columns in self.blocks:
            part: list[str] = []
            for other, rows in self.blocks:
                sums = []
                for i in rows:
                    terms = [f"{matrix}[{i}, {j}] * {vector}{j}" for j in columns if pattern[i, j]]
                    sums += [f"{name}{i} = {' + '.join([f'{name}{i}', *terms])}"] if terms else []
                part += _guarded(other if other != gate else "", sums)
            found += _guarded(gate, part)
        return found


def _guarded(gate: str, lines: Sequence[str], otherwise: Sequence[str] = ()) -> list[str]:
    if not gate or not lines:
        return list(lines)
    found = [f"if {gate}:", *(f"    {line}" for line in lines)]
    return found + (["else:", *(f"    {line}" for line in otherwise)] if otherwise else [])
