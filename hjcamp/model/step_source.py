"""The source of one step, ``predict`` and ``correct``: an effect whose gate is closed costs a test, not its rows."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.compose import Composition, function_source

Pattern = NDArray[np.bool_]
E, P1, P2 = range(3)


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
    lines += step.sums("m", P1, "f", pattern)
    lines += step.sums("n", P2, "b", pattern & step.curved)
    lines += step.rows(lambda i: [f"a[{i}] = z[{i}] + m{i} + n{i}"], lambda i: [f"a[{i}] = z[{i}]"])
    name = "predict_all" if everything else "predict"
    return function_source(f"{name}(time, span, direction, z, u, p, steps, row, a, before)", composition.body(lines))


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
    lines += step.sums("m", E, "b", pattern & step.curved[:, None])
    lines += step.sums("n", P1, "s", bent & step.curved[:, None])
    lines += step.rows(surplus)
    lines += step.sums("c", P2, "g", bent)
    lines += ["worst = 0.0", *step.rows(corrected), "return worst"]
    name = "correct_all" if everything else "correct"
    lines = [re.sub(r"\bz\[", "a[", line) for line in composition.body(lines)]
    return function_source(f"{name}(time, span, direction, a, u, p, steps, row, before, weight)", lines)


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
        # One test for all of them: most models have no effect with states.
        self.any_gate = composition.any_gate

    def rows(
        self, lines: Callable[[int], Sequence[str]], otherwise: Callable[[int], Sequence[str]] | None = None
    ) -> list[str]:
        """Return the lines of every state behind its gate, and what is done where the gate is closed."""
        always, *gated = self.blocks
        inside: list[str] = []
        for gate, own in gated:
            absent = [line for i in own for line in otherwise(i)] if otherwise else []
            inside += _guarded(gate, [line for i in own for line in lines(i)], absent)
        absent = [line for _, own in gated for i in own for line in otherwise(i)] if otherwise else []
        return [line for i in always[1] for line in lines(i)] + _guarded(self.any_gate, inside, absent)

    def sums(self, name: str, matrix: int, vector: str, pattern: Pattern) -> list[str]:
        """Return the lines that sum up a matrix times a vector, what is behind a closed gate left out."""
        n = len(self.names)

        def sums(rows: Sequence[int], columns: Sequence[int]) -> list[str]:
            found = []
            for i in rows:
                terms = [f"steps[row, {(matrix * n + i) * n + j}] * {vector}{j}" for j in columns if pattern[i, j]]
                found += [f"{name}{i} = {' + '.join([f'{name}{i}', *terms])}"] if terms else []
            return found

        always, *gated = self.blocks
        found = [f"{name}{i} = 0.0" for i in always[1]] + sums(always[1], always[1])
        inside = [f"{name}{i} = 0.0" for _, own in gated for i in own]
        for gate, rows in gated:
            inside += _guarded(gate, sums(rows, always[1]))
        for gate, columns in gated:
            part: list[str] = []
            for other, rows in self.blocks:
                part += _guarded(other if other != gate else "", sums(rows, columns))
            inside += _guarded(gate, part)
        return found + _guarded(self.any_gate, inside)


def _guarded(gate: str, lines: Sequence[str], otherwise: Sequence[str] = ()) -> list[str]:
    if not gate or not lines:
        return list(lines)
    found = [f"if {gate}:", *(f"    {line}" for line in lines)]
    return found + (["else:", *(f"    {line}" for line in otherwise)] if otherwise else [])
