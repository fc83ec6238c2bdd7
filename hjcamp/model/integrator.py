"""The time integrator, copied into every generated kernel: exponential steps, halved where a regime ends.

Within one friction regime the model is z' = f(z), nearly linear with Jacobian L found beforehand. One step of
length h is the exponential Rosenbrock-Euler step with a second-order correction,

    a = z + P1 f(z),    z+ = a + P2 (f(a) - E f(z)),    E = exp(h L), P1 = h phi1(h L), P2 = h phi2(h L),

exact where the model is linear (the correction vanishes), of second order elsewhere. Step lengths are h / 2**level;
the propagators of every level are computed once, by doubling. A step whose correction is larger than the states'
resolution, or in which a regime ends, is tried again one level finer; at the finest level (1 us) the event is taken.
Source: Hochbruck & Ostermann (2010), Acta Numerica 19, 209-286, sections 2.4 and 2.5.

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
            moving[VELOCITY] = direction * TYPICAL[VELOCITY]
        linearise(0.0, direction, moving, u, p, jacobian)
        propagators(jacobian, h, out[regime])


def attempt(time, span, direction, z, u, p, e, p1, p2, a, before, counter):  # type: ignore[no-untyped-def]
    """Write into ``a`` the state after one step; return its correction in units of the states' resolution.

    Where the model is linear and no limiter acts at either end, the correction is zero and is not computed;
    ``counter[4]`` remembers whether a limiter acted at the end of the step before.
    """
    predict(time, direction, z, u, p, p1, a, before)
    if AFFINE and counter[4] == 0.0 and contact(time + span, direction, a, u, p)[3] == 0.0:
        return 0.0
    return correct(time + span, direction, a, u, p, e, p2, before)


def trial(time, h, direction, z, u, p, e, p1, p2, a, before, counter):  # type: ignore[no-untyped-def]
    """Try one whole sample in regime ``direction``; return True where it is accurate and the regime goes on."""
    if not attempt(time, h, direction, z, u, p, e, p1, p2, a, before, counter) <= counter[5]:
        return False
    if CONTACT:
        if direction == 0.0:
            push, limit, locks, _ = contact(time + h, 0.0, a, u, p)
            return abs(push) <= limit and locks != 0.0
        return not turned(h, direction, z, a, before)
    return True


def move(time, direction, z, u, p, fast, propagator, h, a, before, counter):  # type: ignore[no-untyped-def]
    """Move ``z`` on by one sample; return the friction regime at its end.

    ``fast`` holds E, P1, P2 of a whole sample for the regimes held, positive, negative: most samples need no more.
    """
    done = False
    if counter[0] == 0.0:
        if direction == 0.0:
            done = trial(time, h, 0.0, z, u, p, fast[0], fast[1], fast[2], a, before, counter)
        elif direction > 0.0:
            done = trial(time, h, 1.0, z, u, p, fast[3], fast[4], fast[5], a, before, counter)
        else:
            done = trial(time, h, -1.0, z, u, p, fast[6], fast[7], fast[8], a, before, counter)
    if done:
        for i in range(N):
            z[i] = a[i]
        counter[1] += 1.0
    else:
        direction = advance(time, direction, z, u, p, propagator, h, a, before, counter)
    counter[4] = contact(time + h, direction, z, u, p)[3]
    return direction


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


def advance(time, direction, z, u, p, propagator, h, a, before, counter):  # type: ignore[no-untyped-def]
    """Move ``z`` on by one sample in as many steps as accuracy and the ends of regimes ask for.

    ``counter``: 0 level that accuracy asks for, 1 steps, 2 events, 3 largest correction accepted at the finest level,
    4 whether a limiter acts, 5 the correction that is accepted, in units of the states' resolution.
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
        regime = 0 if direction == 0.0 else (1 if direction > 0.0 else 2)
        now = time + tick * done
        steps = propagator[regime, level]
        error = attempt(now, span, direction, z, u, p, steps[0], steps[1], steps[2], a, before, counter)
        if not error <= counter[5] and level < LEVELS:
            level += 1
            accuracy = level if not searching else accuracy
            continue
        ended = False
        if CONTACT:
            if direction == 0.0:
                push, limit, locks, _ = contact(now + span, direction, a, u, p)
                ended = abs(push) > limit or locks == 0.0
            else:
                ended = turned(span, direction, z, a, before)
            if ended and level < LEVELS:
                level += 1
                searching = True
                continue
        for i in range(N):
            z[i] = a[i]
        done += length
        counter[1] += 1.0
        if error > counter[5] and error > counter[3]:
            counter[3] = error
        counter[4] = contact(now + span, direction, z, u, p)[3]
        if ended:
            direction = regime_after(time + tick * done, direction, z, u, p)
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
    if direction != 0.0:
        z[VELOCITY] = 0.0
    if abs(push) <= limit:
        return 0.0
    return 1.0 if push > 0.0 else -1.0
