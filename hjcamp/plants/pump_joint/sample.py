"""One sample of the pump joint, and the loop of a test, copied into generated kernels.

A sample is sensed, decided and acted on: ``sense``, ``decide`` and ``act`` serve the simulator (``closed_loop``) and the virtual
rig (`hjcamp.plants.pump_joint.virtual_rig.tick`); the rig has its own sensors and outputs, and ``decide``.
"""

from __future__ import annotations

from typing import Any

import numpy as np

READINGS = 0
PRESSURE1 = 0
PRESSURE2 = 0
ARM = 0
COMMAND = 0
DITHER = 0
PRELOAD = 0
SCATTER = 0
readings: Any = None
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


def sense(k, z, u, p, h, counts, phases, noise, scatter, memory, seen):  # type: ignore[no-untyped-def]
    """Begin sample ``k``: fill ``seen`` with what the sensors deliver.

    ``memory``: friction regime, first sample of the command phase or -1, time of the present sample, its phase, where the
    next command goes in ``history``.
    """
    memory[2] = (k - memory[1]) * h if memory[1] >= 0.0 else 0.0
    row = k if k < scatter.shape[0] else k % scatter.shape[0]  # a division takes as long as the rest of this
    u[SCATTER] = scatter[row]
    measure(memory[2], memory[0], z, u, p, counts, phases, noise[row], seen)


def decide(pressure1, pressure2, arm, steps, h, c, m, pc, pm, reference, dither, state, out):  # type: ignore[no-untyped-def]
    """Fill ``out`` with phase, reference, command, pid, feedforward, dither (V) and preload speed (m/s) of a sample.

    ``steps``: sample periods since the last call, 1 unless samples were missed. ``state``: samples of the command
    phase controlled so far, and periods passed in it. ``reference`` (n, 4): arm angle, velocity, acceleration, feedforward.
    """
    phase, speed, offset = procedure(pressure1, pressure2, h * steps, pc, pm)
    pid = 0.0
    ahead = 0.0
    shake = 0.0
    wanted = reference[0, 0]
    index = int(state[0])
    if phase == 3.0:
        passed = int(state[1]) + int(steps) if index > 0 else 0
        row = min(passed, reference.shape[0] - 1)
        wanted = reference[row, 0]
        pid, ahead = control(wanted, reference[row, 1], reference[row, 2], arm, reference[row, 3], h, index, c, m)
        shake = dither[row]
        state[0] = index + 1.0
        state[1] = passed
    elif index > 0:
        wanted = out[1]
        pid = out[3]
        ahead = out[4]
    out[0] = phase
    out[1] = wanted
    out[2] = offset + pid + ahead
    out[3] = pid
    out[4] = ahead
    out[5] = shake
    out[6] = speed


def act(  # type: ignore[no-untyped-def]
    k, command, shake, speed, z, u, p, plan, space, steps, h, delay, preload_area, history, memory, work
):
    """End sample ``k``: move the plant on under pump command (rad), dither (V) and preload speed (m/s).

    ``delay``: whole samples and the fraction of one; ``history`` is a ring of more samples of the command than that, 0 at first.
    """
    if memory[3] == 3.0 and memory[1] < 0.0:
        memory[1] = k
        memory[2] = 0.0
    whole = int(delay[0])
    size = history.shape[0]
    place = int(memory[4])
    history[place] = command
    memory[4] = place + 1 if place + 1 < size else 0
    late = place - whole if place >= whole else place - whole + size
    later = late - 1 if late > 0 else size - 1
    u[COMMAND] = (1.0 - delay[1]) * history[late] + delay[1] * history[later]
    u[DITHER] = shake
    u[PRELOAD] = speed * preload_area
    remember(memory[2], memory[0], z, u, p)
    memory[0] = move(memory[2], memory[0], z, u, p, plan, space, steps, h, work[0], work[1], work[2])


def closed_loop(  # type: ignore[no-untyped-def]
    z, u, p, plan, space, steps, h, c, m, pc, pm, reference, dither, delay, preload_area, counts, phases, noise, scatter,
    history, memory, state, out, record, work,
):  # fmt: skip
    """Run a whole test: each sample is sensed, decided and acted on; return the number of samples recorded.

    ``record`` (samples, 6 + READINGS): phase, reference, command, pid, feedforward, dither, readings; ``work`` (4, columns):
    scratch. -1: the record was too short.
    """
    for k in range(record.shape[0]):
        seen = record[k, 6:]
        sense(k, z, u, p, h, counts, phases, noise, scatter, memory, seen)
        decide(seen[PRESSURE1], seen[PRESSURE2], seen[ARM], 1.0, h, c, m, pc, pm, reference, dither, state, out)
        if out[0] > 4.0:
            return k
        memory[3] = out[0]
        for i in range(6):
            record[k, i] = out[i]
        act(k, out[2], out[5], out[6], z, u, p, plan, space, steps, h, delay, preload_area, history, memory, work)
    return -1
