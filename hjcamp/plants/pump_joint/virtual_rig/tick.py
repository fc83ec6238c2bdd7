"""One sample of the plant, copied into the generated kernel: what happened since the last one, then the sensors."""

from __future__ import annotations

from typing import Any

PRESSURE1 = 0
PRESSURE2 = 0
sense: Any = None
act: Any = None
procedure: Any = None


def rig_tick(
    k, outputs, z, u, p, plan, space, steps, h, pc, pm, delay, preload_area, burst, counts, phases, noise, scatter,
    history, memory, seen, work,
):  # fmt: skip
    """Move the plant from sample k - 1 to sample ``k`` under ``outputs``, then fill ``seen`` with its readings (SI).

    ``outputs``: pump command (rad), dither (V), preload speed (m/s). ``burst``: positions of open lines in ``z``.
    ``sense`` and ``act``, with their ``memory``, are the simulator's (`hjcamp.plants.pump_joint.sample`); the procedure runs along only
    because effects count time from the start of the command phase.
    """
    if k > 0:
        act(
            k - 1, outputs[0], outputs[1], outputs[2], z, u, p, plan, space, steps, h, delay, preload_area, history, memory,
            work,
        )  # fmt: skip
        for i in range(len(burst)):
            z[burst[i]] = 0.0
            work[2, 8] = -1.0
    sense(k, z, u, p, h, counts, phases, noise, scatter, memory, seen)
    memory[3], _, _ = procedure(seen[PRESSURE1], seen[PRESSURE2], h, pc, pm)
