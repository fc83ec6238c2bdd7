"""The sample loops that a kernel can carry: following a log, and running free."""

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
DRIVEN_STATES: Any = ()
DRIVEN_INPUTS: Any = ()
faced: Any = None
readings: Any = None
balance: Any = None
begin: Any = None
renew: Any = None
remember: Any = None
move: Any = None


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
    z, u, p, plan, space, steps, h, begins, time, given, starts, out, states, ends, work
):
    """Run the plant under its given inputs alone; fill ``out`` with its readings and ``states`` with its states.

    ``ends`` has a row for each row of ``starts``: the plant's states one sample after the last of that test or window.

    ``begins`` (n) is 1 where a test begins, with the states in the next row of ``starts``, and 2 where a window of a test
    begins, for which the states alone are set that ``starts`` has, the plant's at least: where one is infinite it goes on.
    ``given`` (n, inputs) holds from each sample to the next.
    After ``work[3, 0]`` steps, unless that is 0, nothing is simulated any more: all further samples are no numbers.
    """
    a, before, counter = work[0], work[1], work[2]
    direction = 0.0
    row = 0
    for k in range(len(time)):
        if work[3, 0] > 0.0 and counter[1] > work[3, 0]:
            out[k:] = np.nan
            states[k:] = np.nan
            ends[max(row - 1, 0) :] = np.nan
            return
        for i in range(given.shape[1]):
            u[i] = given[k, i]
        if begins[k] > 0:
            for i in range(starts.shape[1]):
                if starts[row, i] != np.inf:
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
        if k + 1 == len(time) or begins[k + 1] > 0:
            for i in range(starts.shape[1]):
                ends[row - 1, i] = z[i]
