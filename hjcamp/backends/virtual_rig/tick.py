"""One sample of the plant, copied into the generated kernel: what happened since the last one, then the sensors."""

from __future__ import annotations

from typing import Any

N = 0
PRESSURE1 = 0
PRESSURE2 = 0
COMMAND = 0
DITHER = 0
PRELOAD = 0
SCATTER = 0
measure: Any = None
remember: Any = None
move: Any = None
procedure: Any = None


def rig_tick(
    k, outputs, z, u, p, plan, space, steps, h, pc, pm, delay, preload_area, burst, counts, phases, noise, scatter,
    history, memory, seen, work,
):  # fmt: skip
    """Move the plant from sample k - 1 to sample ``k`` under ``outputs``, then fill ``seen`` with its readings (SI).

    ``outputs``: pump command (rad), dither (V), preload speed (m/s). ``burst``: positions of open lines in ``z``.
    ``memory``: friction regime, first sample of the command phase or -1, time of the last sample. The order is that of
    ``closed_loop``; the procedure runs along only because effects count time from the start of the command phase.
    """
    a, before, counter = work[0], work[1], work[2]
    whole = int(delay[0])
    part = delay[1]
    size = history.shape[0]
    row = k % scatter.shape[0]
    if k > 0:
        last = k - 1
        history[last % size] = outputs[0]
        late = history[(last - whole) % size] if last >= whole else 0.0
        later = history[(last - whole - 1) % size] if last > whole else 0.0
        u[COMMAND] = (1.0 - part) * late + part * later
        u[DITHER] = outputs[1]
        u[PRELOAD] = outputs[2] * preload_area
        remember(memory[2], memory[0], z, u, p)
        memory[0] = move(memory[2], memory[0], z, u, p, plan, space, steps, h, a, before, counter)
        for i in range(len(burst)):
            z[burst[i]] = 0.0
            counter[8] = -1.0
    time = (k - memory[1]) * h if memory[1] >= 0.0 else 0.0
    u[SCATTER] = scatter[row]
    measure(time, memory[0], z, u, p, counts, phases, noise[row], seen)
    phase, _, _ = procedure(seen[PRESSURE1], seen[PRESSURE2], h, pc, pm)
    if phase == 3.0 and memory[1] < 0.0:
        memory[1] = k
        time = 0.0
    memory[2] = time
