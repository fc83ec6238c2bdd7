"""What every kernel calls and no model changes: propagators, and the sums of a step over the states that are present.

These functions stand in a generated file of their own, which is compiled once and linked into every kernel.

``plan`` (whole numbers) says what there is: how many regimes have propagators, how many states are present, how many of
them have curved rates, and the width w of a matrix, the number of present states made up to a multiple of 4; then the codes
of those regimes, the positions of the present states, the curved among them, and room for places in a row. A row
of ``steps`` holds what belongs to one regime and level: the Jacobian L row by row, P1 and P2 column by column, each (w, w).
``before`` holds the rates at the start of a step, their slopes, and their next slopes, N each.
"""

from __future__ import annotations

from typing import Any

import numpy as np

MADE = 0
PRESENT = 1
CURVED = 2
WIDTH = 3
CODES = 4
REGIMES = 24
STATES = CODES + REGIMES
JACOBIAN = 5
E = 6
P1 = 7
P2 = 8
POWER = 9
SPARE = 10
SPACE = 11
strided: Any = None


def width(count: int) -> int:
    """Return the width of the matrices of so many states."""
    return (count + 3) // 4 * 4


def product(space, left, right, into, w):  # type: ignore[no-untyped-def]
    """Fill the row ``into`` of ``space`` with the product of two of its matrices (w, w)."""
    for i in range(w):
        for j in range(0, w, 4):
            a, b, c, d = strided(space, left, i * w, right, j, w)
            at = i * w + j
            space[into, at] = a
            space[into, at + 1] = b
            space[into, at + 2] = c
            space[into, at + 3] = d


def propagators(h, levels, w, space, steps, first):  # type: ignore[no-untyped-def]
    """Fill ``levels`` + 1 rows of ``steps`` from ``first`` on with L, P1 and P2 for the steps h / 2**level.

    The Jacobian (w, w) of the present states stands in ``space``. Series at the finest level, then
    doubling from s to 2 s: P2 <- P2 + P1 P1 / (2 s), P1 <- P1 + E P1, E <- E E.
    """
    size = w * w
    s = h / 2.0**levels
    for i in range(size):
        space[E, i] = 0.0
        space[P1, i] = 0.0
        space[P2, i] = 0.0
        space[SPARE, i] = space[JACOBIAN, i]
    for i in range(w):
        space[E, i * w + i] = 1.0
        space[P1, i * w + i] = s
        space[P2, i * w + i] = 0.5 * s
    factor = 1.0
    for order in range(1, 9):
        if order > 1:
            product(space, POWER, JACOBIAN, SPARE, w)
        factor *= s / order
        for i in range(size):
            power = factor * space[SPARE, i]
            space[POWER, i] = space[SPARE, i]
            space[E, i] += power
            space[P1, i] += power * s / (order + 1)
            space[P2, i] += power * s / ((order + 1) * (order + 2))
    for back in range(levels + 1):
        row = first + levels - back
        for i in range(w):
            for j in range(w):
                steps[row, i * w + j] = space[JACOBIAN, i * w + j]
                steps[row, size + j * w + i] = space[P1, i * w + j]
                steps[row, 2 * size + j * w + i] = space[P2, i * w + j]
        if back == levels:
            return
        product(space, P1, P1, SPARE, w)
        for i in range(size):
            space[P2, i] += space[SPARE, i] / (2.0 * s)
        product(space, E, P1, SPARE, w)
        for i in range(size):
            space[P1, i] += space[SPARE, i]
        product(space, E, E, SPARE, w)
        for i in range(size):
            space[E, i] = space[SPARE, i]
        s *= 2.0


def summed(matrices, values, plan, count, out):  # type: ignore[no-untyped-def]
    """Fill ``out`` with a sum of columns, each times its value; ``plan`` says where each begins in ``matrices``.

    Unsigned places save the test for an index from the end.
    """
    one, two, three = np.uint64(1), np.uint64(2), np.uint64(3)
    begins = STATES + plan[PRESENT] + plan[CURVED]
    for block in range(0, plan[WIDTH], 4):
        a = 0.0
        b = 0.0
        c = 0.0
        d = 0.0
        for k in range(count):
            value = values[k]
            at = np.uint64(plan[begins + k] + block)
            a += value * matrices[at]
            b += value * matrices[at + one]
            c += value * matrices[at + two]
            d += value * matrices[at + three]
        out[block] = a
        out[block + 1] = b
        out[block + 2] = c
        out[block + 3] = d


def lead(span, z, plan, space, steps, row, a, before):  # type: ignore[no-untyped-def]
    """Fill ``a`` with the state after one step without its correction, from the rates in ``before``."""
    n = z.shape[0]
    m = plan[PRESENT]
    w = plan[WIDTH]
    curved = STATES + m
    begins = curved + plan[CURVED]
    values, change = space[E], space[P1]
    count = 0
    for k in range(m):
        value = before[plan[STATES + k]]
        if value != 0.0:
            values[count] = value
            plan[begins + count] = w * (w + k)
            count += 1
    for other in range(plan[CURVED]):
        k = plan[curved + other]
        value = before[n + plan[STATES + k]]
        if value != 0.0:
            values[count] = value * span
            plan[begins + count] = w * (2 * w + k)
            count += 1
    summed(steps[row], values, plan, count, change)
    for i in range(n):
        a[i] = z[i]
    for k in range(m):
        at = plan[STATES + k]
        a[at] = z[at] + change[k]


def mend(span, weight, everything, z, plan, space, steps, row, a, before, after, resolution):  # type: ignore[no-untyped-def]
    """Add the correction of one step to ``a``, from the rates ``after`` it; return its size in units of ``resolution``.

    Only the curved rates are corrected, with ``everything`` all of them. What they have beyond the linear part is taken from
    the Jacobian: E f + P1 s = f + s h + L (a - z).
    """
    n = resolution.shape[0]
    m = plan[PRESENT]
    w = plan[WIDTH]
    curved = STATES + m
    begins = curved + plan[CURVED]
    matrices, values, change = steps[row], space[E], space[P1]
    one, two, three = np.uint64(1), np.uint64(2), np.uint64(3)
    for k in range(m):
        at = plan[STATES + k]
        change[k] = a[at] - z[at]
    for k in range(m, w):
        change[k] = 0.0
    count = m if everything else plan[CURVED]
    for other in range(count):
        k = other if everything else plan[curved + other]
        first = 0.0
        second = 0.0
        third = 0.0
        fourth = 0.0
        for block in range(0, w, 4):
            at = np.uint64(k * w + block)
            first += matrices[at] * change[block]
            second += matrices[at + one] * change[block + 1]
            third += matrices[at + two] * change[block + 2]
            fourth += matrices[at + three] * change[block + 3]
        place = plan[STATES + k]
        value = after[place] - before[place] - before[n + place] * span - ((first + second) + (third + fourth))
        values[other] = value
        before[2 * n + place] = before[n + place] + value / span
        plan[begins + other] = w * (2 * w + k)
    summed(matrices, values, plan, count, change)
    worst = 0.0
    for k in range(m):
        place = plan[STATES + k]
        size = weight * change[k]
        a[place] += size
        size = abs(size) / resolution[place]
        if not size <= worst:
            worst = size
    return worst
