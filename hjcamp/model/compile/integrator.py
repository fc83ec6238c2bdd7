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

Whole numbers that are constants are passed as ``np.int64``: numba compiles a function again for each literal.

The names in capitals, ``rates``, ``limiting``, ``predict``, ``glide`` and ``correct`` are supplied by the generated file, ``lead`` and
``mend`` by the file that all kernels share (`hjcamp.model.compile.shared`), what follows an event by `hjcamp.model.compile.regimes`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

N = 0
CONTACTS = 0
SLOPES: Any = ()
DRAGGED = False
LEVELS = 0
AFFINE = True
GLIDES = False
CONTACT = True
LIMITS_VARY = True
WRITTEN = 0
RESOLUTION: Any = None
PRESENT = CURVED = 0
HIGH = 4
KINDS = 9
rates: Any = None
limiting: Any = None
predict: Any = None
glide: Any = None
correct: Any = None
lead: Any = None
mend: Any = None
arrive: Any = None
ending: Any = None
pace: Any = None
regime_after: Any = None
shifted: Any = None


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
    # The rows of the states that are always there are written out; where others are present, too, sums in loops serve.
    sparse = WRITTEN < N and plan[PRESENT] > WRITTEN
    if (
        GLIDES
        and not sparse
        and accuracy == 0
        and counter[4] == 0.0
        and glided(time, direction, z, u, p, steps, h, a, before, counter)
    ):
        if CONTACT and direction != 0.0 and shifted(time + h, direction, z, u, p, counter):
            direction = arrive(time + h, direction, z, u, p, plan, space, steps, h, before, counter)
        return direction
    bent = not AFFINE and plan[CURVED] > 0
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
