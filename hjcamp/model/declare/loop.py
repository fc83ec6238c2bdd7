"""The sample loop of any plant: sense, command, move, as a kernel can carry it."""

from __future__ import annotations

from typing import Any

import numpy as np

READINGS = 0
GIVEN: Any = ()
COMMANDED = 0
ANSWERS = 0
readings: Any = None
begin: Any = None
remember: Any = None
move: Any = None
command: Any = None


def late_input(asked, k, late):  # type: ignore[no-untyped-def]
    """Return an input of sample k that comes ``late`` samples after it was asked for: a fraction of one as a mean of two."""
    row = k - int(late)
    part = late - int(late)
    return (1.0 - part) * asked[max(row, 0)] + part * asked[max(row - 1, 0)]


def run_loop(  # type: ignore[no-untyped-def]
    z, u, p, plan, space, steps, h, first, last, c, m, ap, am, reference, given, late, counts, phases, noise, record, work
):
    """Run a test; fill ``record`` (samples, ANSWERS + inputs + READINGS): answers of the law, inputs, readings.

    ``reference`` (samples, columns) is the law's, ``given`` (samples, inputs) what it does not command; the law runs from sample
    ``first`` to before ``last``, its answers are 0 elsewhere. An input acts ``late`` (inputs,) samples after it is recorded. A
    reading is noisy, and in whole counts where it has any.
    """
    a, before, counter, seen = work[0], work[1], work[2], work[3]
    direction = 0.0
    for k in range(record.shape[0]):
        time = (k - first) * h
        for i in GIVEN:
            u[i] = late_input(given[:, i], k, late[i])
        if k == 0:
            begin(time, direction, z, u, p)
        readings(time, direction, z, u, p, seen)
        for i in range(READINGS):
            seen[i] += noise[k, i]
            if counts[i] > 0.0:
                seen[i] = np.floor(seen[i] / counts[i] + phases[i]) * counts[i]
        running = first <= k < last
        command(running, time, k - first, reference[k], seen, h, c, m, ap, am, record[k], u)
        for i in range(len(u)):
            record[k, ANSWERS + i] = u[i]
        for i in GIVEN:
            record[k, ANSWERS + i] = given[k, i]
        for i in range(len(u)):
            u[i] = late_input(record[:, ANSWERS + i], k, late[i])
        for i in range(READINGS):
            record[k, ANSWERS + len(u) + i] = seen[i]
        remember(time, direction, z, u, p)
        direction = move(time, direction, z, u, p, plan, space, steps, h, a, before, counter)


def tick(k, time, asked, now, z, u, p, plan, space, steps, h, counts, phases, noise, facing, work):  # type: ignore[no-untyped-def]
    """Move the plant from sample k - 1 to sample ``k`` under the inputs ``asked``, then read it into ``work[3]``.

    ``time`` (s) is that of sample k, ``now`` the inputs while it is read, ``facing`` (1,) the regime of its contact. Sample 0 is the
    start; what `run_loop` does at once is done here one by one.
    """
    a, before, counter, seen = work[0], work[1], work[2], work[3]
    if k > 0:
        for i in range(len(u)):
            u[i] = asked[i]
        remember(time - h, facing[0], z, u, p)
        facing[0] = move(time - h, facing[0], z, u, p, plan, space, steps, h, a, before, counter)
    for i in range(len(u)):
        u[i] = now[i]
    if k == 0:
        begin(time, facing[0], z, u, p)
    readings(time, facing[0], z, u, p, seen)
    for i in range(READINGS):
        seen[i] += noise[i]
        if counts[i] > 0.0:
            seen[i] = np.floor(seen[i] / counts[i] + phases[i]) * counts[i]
