"""The time integrator, copied into every generated kernel: exponential steps, halved where a regime ends.

Within one friction regime the model is z' = f(z), nearly linear with Jacobian L found beforehand; what L leaves over,
N(z) = f(z) - L z, is taken as a straight line in time, its slope s that of the step before. One step of length h is

    a = z + P1 f(z) + P2 s h,    z+ = a + w P2 (f(a) - E f(z) - P1 s),
    E = exp(h L), P1 = h phi1(h L), P2 = h phi2(h L), w = 1 - h / (3 (h + length of the step before)),

exact where the model is linear (s and the correction vanish), of third order elsewhere, as w bends N to the parabola
through two steps; after an event s = 0 and w = 1, and the order is two. Step lengths are h / 2**level; the propagators
of every level are computed once, by doubling. A step whose correction is larger than the states' resolution, or in
which a regime ends, is tried again one level finer; at the finest level (1 us) the event is taken. Where nothing locks
friction passes rest without a leap, and a turn is no event. ``before`` holds f(z), s and the next s. Where a limiter
acts every rate is corrected, else only the curved ones.
Source: Hochbruck & Ostermann (2010), Acta Numerica 19, 209-286, sections 2.4, 2.5 (Rosenbrock) and 2.7 (multistep).

``steps`` has a row for each regime and level, of which ``row`` holds E, P1 and P2 one after the other: constant places in
it cost no view of an array, so that one copy of a step serves all regimes.
The names in capitals, ``rates``, ``contact``, ``predict`` and ``correct`` are supplied by the generated file.
"""

from __future__ import annotations

from typing import Any

import numpy as np

N = 0
VELOCITY = 0
LEVELS = 0
AFFINE = True
CONTACT = True
RESOLUTION: Any = None
TYPICAL: Any = None
rates: Any = None
contact: Any = None
predict: Any = None
correct: Any = None
predict_all: Any = None
correct_all: Any = None
begin: Any = None
CURVED: Any = None
CREEP = 0.3


def linearise(time, direction, z, u, p, jacobian):  # type: ignore[no-untyped-def]
    """Fill ``jacobian`` (N, N) with d rates / d z by central differences about ``z``."""
    low = np.empty(N)
    high = np.empty(N)
    moved = z.copy()
    for j in range(N):
        step = 1e-3 * TYPICAL[j]
        moved[j] = z[j] + step
        rates(time, direction, moved, u, p, high)
        moved[j] = z[j] - step
        rates(time, direction, moved, u, p, low)
        moved[j] = z[j]
        for i in range(N):
            jacobian[i, j] = (high[i] - low[i]) / (2.0 * step)


def propagators(jacobian, h, out):  # type: ignore[no-untyped-def]
    """Fill ``out`` (LEVELS + 1, 3, N, N) with E, P1 and P2 for the steps h / 2**level.

    Series at the finest level, then doubling from s to 2 s: P2 <- P2 + P1 P1 / (2 s), P1 <- P1 + E P1, E <- E E.
    """
    s = h / 2.0**LEVELS
    unit = np.eye(N)
    e, p1, p2 = unit.copy(), s * unit, 0.5 * s * unit
    power = unit.copy()
    factor = 1.0
    for order in range(1, 9):
        power = np.dot(power, jacobian) * s
        factor /= order
        e += factor * power
        p1 += (s * factor / (order + 1)) * power
        p2 += (s * factor / ((order + 1) * (order + 2))) * power
    for back in range(LEVELS + 1):
        level = LEVELS - back
        out[level, 0] = e
        out[level, 1] = p1
        out[level, 2] = p2
        p2 = p2 + np.dot(p1, p1) / (2.0 * s)
        p1 = p1 + np.dot(e, p1)
        e = np.dot(e, e)
        s *= 2.0


def prepare(z, u, p, h, out):  # type: ignore[no-untyped-def]
    """Fill ``out`` (3, LEVELS + 1, 3, N, N) with the propagators of the regimes held, positive and negative."""
    jacobian = np.empty((N, N))
    for regime in range(3):
        direction = 0.0
        moving = z.copy()
        if CONTACT:
            direction = 0.0 if regime == 0 else (1.0 if regime == 1 else -1.0)
            # Well above the speeds at which friction bends, so that the linear part is that of steady sliding.
            moving[VELOCITY] = 10.0 * direction * TYPICAL[VELOCITY]
            if contact(0.0, direction, z, u, p)[2] == 0.0:
                # Nothing is ever held: the first regime creeps, as after rest, the others have come to steady sliding.
                if regime == 0:
                    direction, moving[VELOCITY] = 1.0, CREEP * TYPICAL[VELOCITY]
                else:
                    begin(0.0, direction, moving, u, p)
        linearise(0.0, direction, moving, u, p, jacobian)
        propagators(jacobian, h, out[regime])


def attempt(time, span, direction, z, u, p, steps, row, a, before, counter):  # type: ignore[no-untyped-def]
    """Write into ``a`` the state after one step; return its correction in units of the states' resolution.

    Where the model is linear and no limiter acts at either end, the correction is zero and is not computed;
    ``counter[4]`` remembers whether a limiter acted at the end of the step before, ``counter[6]`` its length.
    """
    limited = counter[4] != 0.0
    if limited:
        predict_all(time, span, direction, z, u, p, steps, row, a, before)
    else:
        predict(time, span, direction, z, u, p, steps, row, a, before)
        limited = contact(time + span, direction, a, u, p)[3] != 0.0
        if AFFINE and not limited:
            return 0.0
    weight = 1.0
    if counter[6] > 0.0:
        weight -= span / (3.0 * (span + counter[6]))
    if limited:
        return correct_all(time + span, span, direction, a, u, p, steps, row, before, weight)
    return correct(time + span, span, direction, a, u, p, steps, row, before, weight)


def accept(span, z, a, before, counter):  # type: ignore[no-untyped-def]
    """Take the step: ``z`` becomes ``a``, and the slope of the nonlinear part is kept for the next one."""
    for i in range(N):
        z[i] = a[i]
    if not AFFINE or counter[4] != 0.0:
        for i in range(N):
            before[N + i] = before[2 * N + i]
        counter[6] = span
    counter[1] += 1.0


def straighten(time, direction, z, u, p, before, counter):  # type: ignore[no-untyped-def]
    """Note whether a limiter acts; where none does any more, the rates that are not curved have no slope.

    Return the direction of motion: where nothing locks, a slider turns without an event, and is said to creep or slide.
    """
    _, _, locks, limits = contact(time, direction, z, u, p)
    if counter[4] != limits:
        counter[4] = limits
        for i in range(N):
            if not CURVED[i]:
                before[N + i] = 0.0
                before[2 * N + i] = 0.0
        if AFFINE:
            counter[6] = 0.0
    if CONTACT and direction != 0.0:
        kind = 0.0 if locks != 0.0 else (1.0 if abs(z[VELOCITY]) > CREEP * TYPICAL[VELOCITY] else 2.0)
        turns = locks == 0.0 and z[VELOCITY] * direction < 0.0
        if turns or counter[7] != kind:
            forget(before, counter)
            counter[7] = kind
        if turns:
            return -direction
    return direction


def forget(before, counter):  # type: ignore[no-untyped-def]
    """Start without a slope of the nonlinear part: at a test's beginning and after each event."""
    for i in range(N):
        before[N + i] = 0.0
        before[2 * N + i] = 0.0
    counter[6] = 0.0


def trial(time, h, direction, z, u, p, steps, row, a, before, counter):  # type: ignore[no-untyped-def]
    """Try one whole sample in regime ``direction``; return True where it is accurate and the regime goes on."""
    if not attempt(time, h, direction, z, u, p, steps, row, a, before, counter) <= counter[5]:
        return False
    if CONTACT:
        if direction == 0.0:
            push, limit, locks, _ = contact(time + h, 0.0, a, u, p)
            return abs(push) <= limit and locks != 0.0
        return not turned(h, direction, z, a, before) or counter[7] != 0.0
    return True


def first_row(direction, counter):  # type: ignore[no-untyped-def]
    """Return the row of the propagators of a whole sample: of the regimes held (or creeping), positive and negative."""
    return 0 if direction == 0.0 or counter[7] == 2.0 else (LEVELS + 1 if direction > 0.0 else 2 * (LEVELS + 1))


def move(time, direction, z, u, p, steps, h, a, before, counter):  # type: ignore[no-untyped-def]
    """Move ``z`` on by one sample, most of them in one step; return the friction regime at its end."""
    row = first_row(direction, counter)
    if counter[0] == 0.0 and trial(time, h, direction, z, u, p, steps, row, a, before, counter):
        accept(h, z, a, before, counter)
    else:
        direction = advance(time, direction, z, u, p, steps, h, a, before, counter)
    return straighten(time + h, direction, z, u, p, before, counter)


def turned(span, direction, z, a, before):  # type: ignore[no-untyped-def]
    """Return True where the moving slider came to rest within the step, also if it moves on at its end."""
    if a[VELOCITY] * direction < 0.0:
        return True
    slowing = before[VELOCITY] * direction
    if slowing >= 0.0 or z[VELOCITY] * direction <= 0.0:
        return False
    # A parabola through both speeds and the first acceleration: its lowest point may lie inside the step.
    start = z[VELOCITY] * direction
    curve = (a[VELOCITY] * direction - start - slowing * span) / (span * span)
    if curve <= 0.0:
        return False
    lowest = -slowing / (2.0 * curve)
    return lowest < span and start + 0.5 * slowing * lowest < 0.0


def advance(time, direction, z, u, p, steps, h, a, before, counter):  # type: ignore[no-untyped-def]
    """Move ``z`` on by one sample in as many steps as accuracy and the ends of regimes ask for.

    ``counter``: 0 level that accuracy asks for, 1 steps, 2 events, 3 largest correction accepted at the finest level,
    4 whether a limiter acts, 5 the correction that is accepted, in units of the states' resolution, 6 length of the step
    before, 7 whether friction locks (0) or, where nothing does, the slider slides (1) or creeps (2).
    """
    ticks = 1 << LEVELS
    tick = h / ticks
    done = 0
    accuracy = int(counter[0])
    level = accuracy
    searching = False
    while done < ticks:
        length = ticks >> level
        while (done & (length - 1)) != 0:
            level += 1
            length = ticks >> level
        span = tick * length
        now = time + tick * done
        row = first_row(direction, counter) + level
        error = attempt(now, span, direction, z, u, p, steps, row, a, before, counter)
        if not error <= counter[5] and level < LEVELS:
            level += 1
            accuracy = level if not searching else accuracy
            continue
        ended = False
        if CONTACT:
            if direction == 0.0:
                push, limit, locks, _ = contact(now + span, direction, a, u, p)
                if locks == 0.0 and contact(now, direction, z, u, p)[2] == 0.0:
                    # What does not lock has not been held before either: it moves from here on.
                    direction = straighten(now, regime_after(now, direction, z, u, p), z, u, p, before, counter)
                    forget(before, counter)
                    continue
                ended = abs(push) > limit or locks == 0.0
            else:
                ended = counter[7] == 0.0 and turned(span, direction, z, a, before)
            if ended and level < LEVELS:
                level += 1
                searching = True
                continue
        accept(span, z, a, before, counter)
        done += length
        if error > counter[5] and error > counter[3]:
            counter[3] = error
        direction = straighten(now + span, direction, z, u, p, before, counter)
        if ended:
            direction = regime_after(time + tick * done, direction, z, u, p)
            forget(before, counter)
            counter[2] += 1.0
            searching = False
            level = accuracy
        elif not searching and error < 0.1 * counter[5] and accuracy > 0:
            accuracy -= 1
            level = accuracy
        elif not searching:
            level = accuracy
    counter[0] = float(accuracy)
    return direction


def regime_after(time, direction, z, u, p):  # type: ignore[no-untyped-def]
    """Return the regime that follows an event: held, or moving in the direction of the push."""
    push, limit, locks, _ = contact(time, 0.0, z, u, p)
    if locks == 0.0:
        if direction == 0.0:
            return 1.0 if push > 0.0 else -1.0
        return -direction
    ahead = 0.0 if abs(push) <= limit else (1.0 if push > 0.0 else -1.0)
    # A slider that turns back without rest keeps the little speed it has gained since it turned.
    if z[VELOCITY] * ahead <= 0.0:
        z[VELOCITY] = 0.0
    return ahead
