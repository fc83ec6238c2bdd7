"""The phases around the control law: preload, initial pressure adjustment, rest, command and control, release."""

from __future__ import annotations

from hjcamp.model.declare.law import Law, Memory
from hjcamp.model.declare.parameter import Parameter

PRELOAD, ADJUSTMENT, REST, CONTROL, RELEASE, FINISHED, FAILED = range(7)


class Procedure(Law):
    """The test procedure as a state machine that runs once per sample on the measured pressures.

    It returns the phase, the speed of the preload pistons (m/s) and the offset of the pump command (rad).
    Source: thesis 5.2.4.1, 5.2.5; the phases are numbered as in the test log.
    """

    samples = ("pressure1", "pressure2", "period")
    results = ("phase", "preload_speed", "pump_offset")

    preload = Parameter("Pa", 0.26e6, text="both lines above this end the preload phase")
    preload_speed = Parameter("m/s", 1e-3, (0.0, 1.0), text="speed of the preload pistons")
    adjust = Parameter("1", 1.0, text="0 leaves the initial pressure adjustment out")
    difference = Parameter("Pa", 0.2e6, text="pressure difference in the starting direction that ends the adjustment")
    first_direction = Parameter("1", 1.0, (-1.0, 1.0), text="direction of the first motion")
    adjustment_speed = Parameter("rad/s", 6.283185307179586, text="speed of the pump motor during the adjustment")
    rest = Parameter("s", 0.2, (0.0, 60.0), text="rest after the adjustment")
    control = Parameter("s", 1.0, (0.0, 3600.0), text="duration of the command and control phase")
    release = Parameter("Pa", 0.06e6, text="both lines below this end the release phase")
    limit = Parameter("s", 20.0, (0.0, 3600.0), text="longest preload, adjustment or release")
    first_phase = Parameter("1", 0.0, (0.0, 3.0), text="phase in which the test starts")

    phase = Memory(start=-1.0)
    elapsed = Memory()
    offset = Memory()

    @staticmethod
    def step(sample, parameter, memory):  # type: ignore[no-untyped-def]
        """Return phase, preload speed and pump offset of this sample."""
        if memory.phase < 0.0:
            memory.phase = parameter.first_phase
            memory.elapsed = 0.0
        ahead = parameter.first_direction * (sample.pressure1 - sample.pressure2)
        tick = 0.5 * sample.period
        if memory.phase == 0.0 and sample.pressure1 > parameter.preload and sample.pressure2 > parameter.preload:
            memory.phase = 1.0
            memory.elapsed = 0.0
        if memory.phase == 1.0 and (parameter.adjust == 0.0 or ahead >= parameter.difference):
            memory.phase = 2.0
            memory.elapsed = 0.0
        if memory.phase == 2.0 and memory.elapsed >= parameter.rest - tick:
            memory.phase = 3.0
            memory.elapsed = 0.0
        if memory.phase == 3.0 and memory.elapsed >= parameter.control - tick:
            memory.phase = 4.0
            memory.elapsed = 0.0
        if memory.phase == 4.0 and sample.pressure1 < parameter.release and sample.pressure2 < parameter.release:
            memory.phase = 5.0
        if memory.phase < 2.0 and memory.elapsed > parameter.limit:
            memory.phase = 6.0
        if memory.phase == 4.0 and memory.elapsed > parameter.limit:
            memory.phase = 5.0
        memory.elapsed = memory.elapsed + sample.period
        speed = 0.0
        if memory.phase == 0.0:
            speed = parameter.preload_speed
        if memory.phase == 4.0:
            speed = -parameter.preload_speed
        if memory.phase == 1.0:
            memory.offset = memory.offset + parameter.first_direction * parameter.adjustment_speed * sample.period
        return memory.phase, speed, memory.offset
