"""The regimes that the time integrator goes through, copied into every generated kernel: contacts and limiters.

A regime says on which side every contact is (held, moving in the positive or the negative direction) and what every limiter
does. ``direction`` is the sum of 3^k times the side (-1, 0 or 1) of contact k: that of the only contact where there is one.
``counter`` and ``before`` are as in `hjcamp.model.compile.integrator.move`.

The names in capitals, ``rates``, ``contact``, ``locking``, ``facing``, ``faced`` and ``limiting`` are supplied by the generated file,
``propagators`` by the file that all kernels share (`hjcamp.model.compile.shared`).
"""

from __future__ import annotations

from typing import Any

import numpy as np

N = 0
CONTACTS = 0
VELOCITIES: Any = ()
FREE: Any = ()
SLOPES: Any = ()
DRAGGED = False
LEVELS = 0
CONTACT = True
TYPICAL: Any = None
MADE = PRESENT = CURVED = WIDTH = CODES = REGIMES = STATES = JACOBIAN = 0
ABOUT, INPUTS, MOVED, LOW, HIGH = range(5)
SIDES = 5
ALL_SIDES = 5
KINDS = 9
CREEP = 0.3
PACES = (10.0, 3.0, 1.0, 0.3)
rates: Any = None
contact: Any = None
locking: Any = None
facing: Any = None
faced: Any = None
limiting: Any = None
begin: Any = None
propagators: Any = None


def linearise(side, limits, p, plan, space):  # type: ignore[no-untyped-def]
    """Fill the Jacobian (w, w) of ``space`` with d rates / d z in a regime, by central differences.

    ``side``, for each contact one digit: 0 held, 1 and 2 moving in the positive and negative direction, 3 creeping as after
    rest, where nothing locks; for one that is driven its `pace`.
    """
    start, u, moved, low, high = space[ABOUT], space[INPUTS], space[MOVED], space[LOW], space[HIGH]
    direction = 0.0
    for i in range(N):
        moved[i] = start[i]
    if CONTACT or DRAGGED:
        rest = side
        for k in range(CONTACTS):
            digit = rest % SIDES
            way = 0.0 if digit == 0 else (-1.0 if digit == 2 and SLOPES[k] < 0 else 1.0)
            direction = faced(direction, k, way)
            if FREE[k]:
                # Well above the speeds at which friction bends, so that the linear part is that of steady sliding.
                moved[VELOCITIES[k]] = (CREEP if digit == 3 else 10.0) * way * TYPICAL[VELOCITIES[k]]
            elif SLOPES[k] >= 0:
                u[SLOPES[k]] = way * PACES[digit - 1] * TYPICAL[VELOCITIES[k]]
            rest //= SIDES
        passing = False
        rest = side
        for k in range(CONTACTS):
            digit = rest % SIDES
            if SLOPES[k] >= 0 or (FREE[k] and (digit == 1 or digit == 2)):
                passing = passing or (digit > 0 and locking(k, 0.0, direction, moved, u, p) == 0.0)
            rest //= SIDES
        if passing:
            begin(0.0, direction, moved, u, p)
    m = plan[PRESENT]
    w = plan[WIDTH]
    for i in range(w * w):
        space[JACOBIAN, i] = 0.0
    for j in range(m):
        at = plan[STATES + j]
        kept = moved[at]
        step = 1e-3 * TYPICAL[at]
        moved[at] = kept + step
        # as a type of its own: for a literal 0, where nothing limits, `rates` would be compiled once more
        rates(np.int64(limits), 0.0, direction, moved, u, p, high)
        moved[at] = kept - step
        rates(np.int64(limits), 0.0, direction, moved, u, p, low)
        moved[at] = kept
        for i in range(m):
            space[JACOBIAN, i * w + j] = (high[plan[STATES + i]] - low[plan[STATES + i]]) / (2.0 * step)


def regime_row(side, limits, p, plan, space, steps, h):  # type: ignore[no-untyped-def]
    """Return the row of the propagators of a whole sample in a regime, which are made when it is first asked for."""
    code = side + ALL_SIDES * limits
    for place in range(plan[MADE]):
        if plan[CODES + place] == code:
            return place * (LEVELS + 1)
    # Hardly ever: what is needed again is made again.
    place = plan[MADE] if plan[MADE] < REGIMES else 0
    linearise(side, limits, p, plan, space)
    propagators(h, np.int64(LEVELS), plan[WIDTH], space, steps, place * (LEVELS + 1))
    plan[CODES + place] = code
    plan[MADE] = place + 1
    return place * (LEVELS + 1)


def arrive(time, direction, z, u, p, plan, space, steps, h, before, counter):  # type: ignore[no-untyped-def]
    """Begin in the regime of ``z``: note it, its propagators' row, and that nothing is known of slopes.

    Return the direction of motion: where nothing locks a slider turns without an event, and is said to creep or slide.
    """
    side = 0
    if CONTACT or DRAGGED:
        place = 1
        for k in range(CONTACTS):
            own = facing(direction, k)
            counter[KINDS + k] = 0.0
            if SLOPES[k] >= 0:
                counter[KINDS + k] = pace(k, u, plan)
                side += place * int(counter[KINDS + k])
            elif own != 0.0:
                if FREE[k] and locking(k, time, direction, z, u, p) == 0.0:
                    if z[VELOCITIES[k]] * own < 0.0:
                        own = -own
                        direction = faced(direction, k, own)
                    counter[KINDS + k] = 1.0 if abs(z[VELOCITIES[k]]) > CREEP * TYPICAL[VELOCITIES[k]] else 2.0
                side += place * (3 if counter[KINDS + k] == 2.0 else (1 if own > 0.0 else 2))
            place *= SIDES
    limits = limiting(time, direction, z, u, p)
    counter[4] = limits
    counter[8] = regime_row(side, limits, p, plan, space, steps, h)
    forget(before, counter)
    return direction


def pace(k, u, plan):  # type: ignore[no-untyped-def]
    """Return for a driven contact that bends what it drags along the place, from 1, of the least of `PACES` above its speed.

    0 at rest. What is dragged along follows the sooner the faster the contact is.
    """
    speed = abs(u[SLOPES[k]]) / TYPICAL[VELOCITIES[k]]
    if speed == 0.0 or plan[CURVED] == 0:
        return 0.0
    place = 1.0
    for most in PACES[1:]:
        if speed <= most:
            place += 1.0
    return place


def forget(before, counter):  # type: ignore[no-untyped-def]
    """Start without a slope of the nonlinear part: at a test's beginning and after each change of regime."""
    for i in range(N):
        before[N + i] = 0.0
        before[2 * N + i] = 0.0
    counter[6] = 0.0


def turned(span, velocity, own, z, a, before):  # type: ignore[no-untyped-def]
    """Return True where what moves to the side ``own`` came to rest within the step, also if it moves on at its end."""
    end = a[velocity] * own
    if end < 0.0:
        return True
    slowing = before[velocity] * own
    start = z[velocity] * own
    if slowing >= 0.0 or start <= 0.0:
        return False
    # A parabola through both speeds and the first acceleration: its lowest point may lie inside the step.
    curve = end - start - slowing * span
    if curve <= 0.0 or -slowing * span >= 2.0 * curve:
        return False
    return 4.0 * start * curve < (slowing * span) * (slowing * span)


def ending(now, end, span, direction, z, a, u, p, before, counter):  # type: ignore[no-untyped-def]
    """Return the sum of 2^k over the contacts whose regime ends within a step from ``z`` to ``a``.

    Negative: over those that are held although nothing locks them, neither before nor after it.
    """
    found = 0
    loose = 0
    for k in range(CONTACTS):
        if FREE[k]:
            own = facing(direction, k)
            if own == 0.0:
                push, limit, locks = contact(k, end, direction, a, u, p)
                if locks == 0.0 and contact(k, now, direction, z, u, p)[2] == 0.0:
                    loose += 1 << k
                if abs(push) > limit or locks == 0.0:
                    found += 1 << k
            elif counter[KINDS + k] == 0.0 and turned(span, VELOCITIES[k], own, z, a, before):
                found += 1 << k
    return -loose if loose > 0 else found


def shifted(time, direction, z, u, p, counter):  # type: ignore[no-untyped-def]
    """Return whether what moves has begun or ceased to lock, or has turned, or changed from creeping to sliding or back."""
    for k in range(CONTACTS):
        own = facing(direction, k)
        if FREE[k] and own != 0.0:
            kind = 0.0
            if locking(k, time, direction, z, u, p) == 0.0:
                kind = 1.0 if abs(z[VELOCITIES[k]]) > CREEP * TYPICAL[VELOCITIES[k]] else 2.0
            if kind != counter[KINDS + k] or (kind > 0.0 and z[VELOCITIES[k]] * own < 0.0):
                return True
    return False


def regime_after(which, time, direction, z, u, p):  # type: ignore[no-untyped-def]
    """Return the regime that follows an event at the contacts ``which``, the sum of their 2^k."""
    for k in range(CONTACTS):
        if (which >> k) & 1:
            direction = faced(direction, k, side_after(k, time, direction, z, u, p))
    if CONTACTS > 1:
        # What moves from now on may push others over their limits.
        for _ in range(CONTACTS - 1):
            for k in range(CONTACTS):
                if FREE[k] and facing(direction, k) == 0.0:
                    direction = faced(direction, k, side_after(k, time, direction, z, u, p))
    return direction


def side_after(k, time, direction, z, u, p):  # type: ignore[no-untyped-def]
    """Return the side of a contact after an event: held, or moving in the direction of the push."""
    push, limit, locks = contact(k, time, faced(direction, k, 0.0), z, u, p)
    if locks == 0.0:
        if facing(direction, k) == 0.0:
            return 1.0 if push > 0.0 else -1.0
        return -facing(direction, k)
    ahead = 0.0 if abs(push) <= limit else (1.0 if push > 0.0 else -1.0)
    # What turns back without rest keeps the little speed it has gained since it turned.
    if z[VELOCITIES[k]] * ahead <= 0.0:
        z[VELOCITIES[k]] = 0.0
    return ahead
