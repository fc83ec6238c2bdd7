"""The two sample loops that a kernel can carry: closed loop with procedure and controller, and following a log."""

from __future__ import annotations

from typing import Any

import numpy as np

N = 0
PLANT_STATES = 0
GIVEN = 0
DRIVEN = 0
OBSERVED = 0
CONTACTS = 0
VELOCITIES: Any = ()
OBSERVED_STATES: Any = ()
READINGS = 0
PRESSURE1 = 0
PRESSURE2 = 0
ARM = 0
COMMAND = 0
DITHER = 0
PRELOAD = 0
SCATTER = 0
DRIVEN_STATES: Any = ()
DRIVEN_INPUTS: Any = ()
faced: Any = None
readings: Any = None
balance: Any = None
begin: Any = None
renew: Any = None
remember: Any = None
move: Any = None
control: Any = None
procedure: Any = None


def measure(time, direction, z, u, p, counts, phases, noise, out):  # type: ignore[no-untyped-def]
    """Fill ``out`` with what the sensors deliver: whole counts, or the analog value plus its noise (SI)."""
    readings(time, direction, z, u, p, out)
    for i in range(READINGS):
        if counts[i] > 0.0:
            out[i] = np.floor(out[i] / counts[i] + phases[i]) * counts[i]
        else:
            out[i] += noise[i]


def closed_loop(  # type: ignore[no-untyped-def]
    z,
    u,
    p,
    plan,
    space,
    steps,
    h,
    c,
    m,
    pc,
    pm,
    reference,
    dither,
    delay,
    preload_area,
    counts,
    phases,
    noise,
    scatter,
    record,
    work,
):
    """Run a whole test; return the number of samples recorded.

    ``reference`` (n, 4): arm angle, velocity, acceleration, feedforward. ``record`` (samples, 6 + READINGS): phase,
    reference, command, pid, feedforward, dither, readings. ``work`` (4, columns): scratch. ``delay``: whole samples and
    the fraction of one. A row of zeros after the last sample means the record was too short.
    """
    a, before, counter, seen = work[0], work[1], work[2], work[3]
    direction = 0.0
    whole = int(delay[0])
    part = delay[1]
    index = 0
    first = 0
    for k in range(record.shape[0]):
        time = (k - first) * h if index > 0 else 0.0
        u[SCATTER] = scatter[k]
        measure(time, direction, z, u, p, counts, phases, noise[k], seen)
        phase, speed, offset = procedure(seen[PRESSURE1], seen[PRESSURE2], h, pc, pm)
        if phase > 4.0:
            return k
        pid = 0.0
        ahead = 0.0
        shake = 0.0
        wanted = reference[0, 0]
        if phase == 3.0:
            if index == 0:
                first = k
                time = 0.0
            row = min(index, reference.shape[0] - 1)
            wanted = reference[row, 0]
            pid, ahead = control(
                wanted, reference[row, 1], reference[row, 2], seen[ARM], reference[row, 3], h, index, c, m
            )
            shake = dither[row]
            index += 1
        elif index > 0:
            wanted = record[k - 1, 1]
            pid, ahead = record[k - 1, 3], record[k - 1, 4]
        record[k, 0] = phase
        record[k, 1] = wanted
        record[k, 2] = offset + pid + ahead
        record[k, 3] = pid
        record[k, 4] = ahead
        record[k, 5] = shake
        for i in range(READINGS):
            record[k, 6 + i] = seen[i]
        late = record[k - whole, 2] if k >= whole else 0.0
        later = record[k - whole - 1, 2] if k > whole else 0.0
        u[COMMAND] = (1.0 - part) * late + part * later
        u[DITHER] = shake
        u[PRELOAD] = speed * preload_area
        remember(time, direction, z, u, p)
        direction = move(time, direction, z, u, p, plan, space, steps, h, a, before, counter)
    return -1


def follow(  # type: ignore[no-untyped-def]
    z, u, p, plan, space, steps, h, restart, time, driven, observed, velocity, given, out, ideal, forces, work
):
    """Drive the plant along measured motion; fill ``out`` with its readings, ``ideal`` with its observed states
    and ``forces`` with its force balance.

    Where ``restart`` is 2 a test begins, its other states at 0; where it is 1 the observed states are set to what was
    measured, and where all contacts rest the effects' states that are known from them. ``given`` (n, inputs) holds from
    each sample to the next.
    """
    a, before, counter = work[0], work[1], work[2]
    direction = 0.0
    n = len(time)
    for k in range(n):
        for i in range(GIVEN):
            u[i] = given[k, i]
        ends = k + 1 == n or restart[k + 1] == 2
        if restart[k] == 2:
            for i in range(PLANT_STATES):
                z[i] = 0.0
        for i in range(DRIVEN):
            z[DRIVEN_STATES[i]] = driven[k, i]
            u[DRIVEN_INPUTS[i]] = 0.0 if ends else (driven[k + 1, i] - driven[k, i]) / h
        if restart[k] > 0:
            for i in range(OBSERVED):
                z[OBSERVED_STATES[i]] = observed[k, i]
            rests = True
            for i in range(CONTACTS):
                z[VELOCITIES[i]] = velocity[k, i]
                direction = faced(direction, i, np.sign(velocity[k, i]))
                rests = rests and velocity[k, i] == 0.0
            counter[8] = -1.0
            if restart[k] == 2:
                counter[0] = 0.0
                begin(time[k], direction, z, u, p)
            elif rests:
                renew(time[k], direction, z, u, p)
        readings(time[k], direction, z, u, p, out[k])
        balance(time[k], direction, z, u, p, forces[k])
        for i in range(OBSERVED):
            ideal[k, i] = z[OBSERVED_STATES[i]]
        remember(time[k], direction, z, u, p)
        direction = move(time[k], direction, z, u, p, plan, space, steps, h, a, before, counter)


def run_free(  # type: ignore[no-untyped-def]
    z, u, p, plan, space, steps, h, begins, time, given, starts, out, states, work
):
    """Run the plant under its given inputs alone; fill ``out`` with its readings and ``states`` with its states.

    ``begins`` (n) is 1 where a test begins, with the states in the next row of ``starts``, and 2 where a window of a test
    begins, for which the plant's states alone are set; ``given`` (n, inputs) holds from each sample to the next.
    """
    a, before, counter = work[0], work[1], work[2]
    direction = 0.0
    row = 0
    for k in range(len(time)):
        for i in range(given.shape[1]):
            u[i] = given[k, i]
        if begins[k] > 0:
            for i in range(starts.shape[1]):
                z[i] = starts[row, i]
            row += 1
            for i in range(CONTACTS):
                direction = faced(direction, i, np.sign(z[VELOCITIES[i]]))
            counter[8] = -1.0
            if begins[k] == 1:
                counter[0] = 0.0
                begin(time[k], direction, z, u, p)
        readings(time[k], direction, z, u, p, out[k])
        for i in range(len(z)):
            states[k, i] = z[i]
        remember(time[k], direction, z, u, p)
        direction = move(time[k], direction, z, u, p, plan, space, steps, h, a, before, counter)
