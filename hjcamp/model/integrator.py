"""The time integrator, copied into every generated kernel: exponential steps, halved where a regime ends.

A regime says on which side every contact is (held, moving in the positive or the negative direction) and what every
limiter does (nothing, holds at its low or at its high end). Within one regime the model is z' = f(z), nearly linear with
Jacobian L; what L leaves over, N(z) = f(z) - L z, is taken as a straight line in time, its slope s that of the step
before. One step of length h is

    a = z + P1 f(z) + P2 s h,    z+ = a + w P2 (f(a) - f(z) - s h - L (a - z)),
    P1 = h phi1(h L), P2 = h phi2(h L), w = 1 - h / (3 (h + length of the step before)),

exact where the model is linear (s and the correction vanish), of third order elsewhere, as w bends N to the parabola
through two steps; after a change of regime s = 0 and w = 1, and the order is two. Step lengths are h / 2**level; the
propagators of all levels of a regime are computed by doubling when the model first comes into it, always about the same
state, so that they do not depend on what was simulated before. Where a step is at most twice as long as that before, the
formula differs from that of second order (w = 1) by less than a third of the correction, (1 - w) / w <= 2/7: so the correction
may be three times what it may be where no step went before. A step whose correction is larger than allowed, in units of the states'
resolutions, or in which a contact's regime ends, is tried again one level finer; at the finest level (1 us) the event is
taken. Where a limiter begins or ceases to act within a step the rates have a kink, no leap: every rate is corrected there,
and the size of the correction says how finely. Where nothing locks friction passes rest without a leap, and a turn is no
event. ``before`` holds f(z), s and the next s.
Source: Hochbruck & Ostermann (2010), Acta Numerica 19, 209-286, sections 2.4, 2.5 (Rosenbrock) and 2.7 (multistep).

``direction`` is the sum of 3^k times the side (-1, 0 or 1) of contact k: that of the only contact where there is one.

Whole numbers that are constants are passed as ``np.int64``: numba compiles a function anew for each literal.

The names in capitals, ``rates``, ``contact``, ``locking``, ``facing``, ``faced``, ``limiting``, ``predict``, ``glide`` and ``correct``
are supplied by the generated file, ``propagators`` and ``mend`` by the file that all kernels share (`hjcamp.model.shared`).
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
AFFINE = True
GLIDES = False
CONTACT = True
LIMITS_VARY = True
WRITTEN = 0
RESOLUTION: Any = None
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
predict: Any = None
glide: Any = None
correct: Any = None
begin: Any = None
lead: Any = None
mend: Any = None
propagators: Any = None


def predict_present(time, span, direction, z, u, p, plan, space, steps, row, a, before):  # type: ignore[no-untyped-def]
    """Write rates into ``before`` and the state after one step, without its correction, into ``a``."""
    rates(np.int64(-1), time, direction, z, u, p, before)
    lead(span, z, plan, space, steps, row, a, before)


def correct_present(  # type: ignore[no-untyped-def]
    time, span, direction, z, a, u, p, plan, space, steps, row, before, weight, everything
):
    """Add the correction to ``a`` and return its size in units of the states' resolution."""
    after = space[HIGH]
    rates(np.int64(-1), time, direction, a, u, p, after)
    return mend(span, weight, everything, z, plan, space, steps, row, a, before, after, RESOLUTION)


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
        rates(limits, 0.0, direction, moved, u, p, high)
        moved[at] = kept - step
        rates(limits, 0.0, direction, moved, u, p, low)
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


def glided(time, direction, z, u, p, steps, h, a, before, counter):  # type: ignore[no-untyped-def]
    """Move ``z`` on by a whole sample on which only the linear part acts, and return True; else return False and move nothing."""
    glide(time, h, direction, z, u, p, steps, int(counter[8]), a, before)
    if limiting(time + h, direction, a, u, p) != 0:
        return False
    if CONTACT and ending(time, time + h, h, direction, z, a, u, p, before, counter) != 0:
        return False
    for i in range(N):
        z[i] = a[i]
    counter[1] += 1.0
    return True


def move(time, direction, z, u, p, plan, space, steps, h, a, before, counter):  # type: ignore[no-untyped-def]
    """Move ``z`` on by one sample in as many steps as accuracy and the ends of regimes ask for; return the direction.

    ``counter``: 0 level that accuracy asks for, 1 steps, 2 events, 3 the correction that is accepted where a step went before,
    in units of the states' resolution, 4 code of what the limiters do, 5 the correction that is accepted elsewhere, 6 length of
    the step before, 7 whether the states left the finite numbers: then ``z`` is not a number and nothing moves, 8 row of the
    regime's propagators, negative where the regime is not known, 9 + k whether contact k locks (0) or, where it does not,
    slides (1) or creeps (2); its `pace` where it is driven.
    """
    if DRAGGED:
        for k in range(CONTACTS):
            if SLOPES[k] >= 0 and pace(k, u, plan) != counter[KINDS + k]:
                counter[8] = -1.0
    if counter[8] < 0.0 or (LIMITS_VARY and limiting(time, direction, z, u, p) != counter[4]):
        direction = arrive(time, direction, z, u, p, plan, space, steps, h, before, counter)
        counter[7] = 0.0
    if counter[7] > 0.0:
        return direction
    ticks = 1 << LEVELS
    tick = h / ticks
    done = 0
    accuracy = int(counter[0])
    level = accuracy
    searching = False
    if GLIDES and accuracy == 0 and counter[4] == 0.0 and glided(time, direction, z, u, p, steps, h, a, before, counter):
        if CONTACT and direction != 0.0 and shifted(time + h, direction, z, u, p, counter):
            direction = arrive(time + h, direction, z, u, p, plan, space, steps, h, before, counter)
        return direction
    bent = not AFFINE and plan[CURVED] > 0
    # The rows of the states that are always there are written out; where others are present, too, sums in loops serve.
    sparse = WRITTEN < N and plan[PRESENT] > WRITTEN
    while done < ticks:
        length = ticks >> level
        while (done & (length - 1)) != 0:
            level += 1
            length = ticks >> level
        span = tick * length
        now = time + tick * done
        end = now + span
        row = int(counter[8]) + level
        if sparse:
            predict_present(now, span, direction, z, u, p, plan, space, steps, row, a, before)
        else:
            predict(now, span, direction, z, u, p, steps, row, a, before)
        limits = limiting(end, direction, a, u, p)
        kink = limits != counter[4]
        error = 0.0
        allowed = counter[5]
        if bent or kink:
            weight = 1.0
            if counter[6] > 0.0:
                weight -= span / (3.0 * (span + counter[6]))
            if kink or sparse:
                error = correct_present(end, span, direction, z, a, u, p, plan, space, steps, row, before, weight, kink)
            else:
                error = correct(end, span, direction, z, a, u, p, steps, row, before, weight)
            allowed = counter[3] if counter[6] > 0.0 and not kink else counter[5]
            if not error <= allowed and level < LEVELS:
                level += 1
                if kink:
                    searching = True
                elif not searching:
                    accuracy = level
                continue
        ended = 0
        if CONTACT:
            ended = ending(now, end, span, direction, z, a, u, p, before, counter)
            if ended < 0:
                # What does not lock has not been held before either: it moves from here on.
                direction = regime_after(-ended, now, direction, z, u, p)
                direction = arrive(now, direction, z, u, p, plan, space, steps, h, before, counter)
                continue
            if ended > 0 and level < LEVELS:
                level += 1
                searching = True
                continue
        if length == ticks and ended == 0 and not bent and not kink:
            # A whole sample on which only the linear part acts: nothing is left to do but to look at what passes rest.
            for i in range(N):
                z[i] = a[i]
            counter[1] += 1.0
            if CONTACT and direction != 0.0 and shifted(end, direction, z, u, p, counter):
                direction = arrive(end, direction, z, u, p, plan, space, steps, h, before, counter)
            return direction
        if level == LEVELS:
            # No step is short enough for what is no number: each further one would be tried at every level.
            for i in range(N):
                if not abs(a[i]) < np.inf:
                    counter[7] = 1.0
            if counter[7] > 0.0:
                for i in range(N):
                    z[i] = np.nan
                return direction
        for i in range(N):
            z[i] = a[i]
        counter[1] += 1.0
        done += length
        if bent and not kink:
            for i in range(N):
                before[N + i] = before[2 * N + i]
            counter[6] = span
        other = kink
        if ended > 0:
            direction = regime_after(ended, end, direction, z, u, p)
            counter[2] += 1.0
            other = True
        elif CONTACT and direction != 0.0:
            other = shifted(end, direction, z, u, p, counter) or other
        if other:
            direction = arrive(end, direction, z, u, p, plan, space, steps, h, before, counter)
        if ended > 0 or kink:
            searching = False
        elif not searching and error < 0.1 * allowed and accuracy > 0:
            accuracy -= 1
        if not searching:
            level = accuracy
    counter[0] = float(accuracy)
    return direction


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
