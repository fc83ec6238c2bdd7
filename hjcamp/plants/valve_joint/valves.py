"""Four on/off valves: from two duties to the mean opening of each valve within a sample."""

from __future__ import annotations

from hjcamp.model.declare.law import Law, Memory
from hjcamp.model.declare.parameter import Parameter

HISTORY = 32
LONGEST_S = 0.03


class Valves(Law):
    """Pulse width, dead time and travel of four 2/2 valves.

    ``duty1`` and ``duty2`` (-1 .. 1) are taken once in ``carrier`` samples; a valve is on for the whole samples that come
    nearest to its duty. Cylinder 1: ``duty1`` above 0 opens valve 1 (water in), below 0 valve 2 (out). Cylinder 2: ``duty2``
    above 0 opens valve 4 (out), below 0 valve 3 (in). A valve starts to open ``opening_delay`` after it is switched on, to close
    ``closing_delay`` after it is switched off, and moves from end to end in ``valve_travel``. The mean over the sample keeps the
    volume of a pulse. Source: thesis 2.4, 3.2 (logic); times are assumed, after the 5 ms of the valves in 2.3.
    """

    samples = ("duty1", "duty2", "carrier", "period")
    results = ("valve1", "valve2", "valve3", "valve4")

    opening_delay = Parameter("s", 2.5e-3, (0.0, LONGEST_S), text="dead time of a valve before it opens (assumed)")
    closing_delay = Parameter("s", 2.5e-3, (0.0, LONGEST_S), text="dead time of a valve before it closes (assumed)")
    valve_travel = Parameter("s", 1.0e-3, (0.0, LONGEST_S), text="time of a valve from end to end (assumed)")

    count = Memory()
    place = Memory()
    carrier = Memory()
    duty1 = Memory()
    duty2 = Memory()
    opening = Memory(size=4)
    mean = Memory(size=4)
    switched = Memory(size=4 * HISTORY)

    @staticmethod
    def step(sample, parameter, memory):  # type: ignore[no-untyped-def]
        """Return the mean opening of each valve in this sample."""
        carrier = max(sample.carrier, 1.0)
        if carrier != memory.carrier or memory.place >= carrier:
            memory.carrier = carrier
            memory.place = 0.0
        if memory.place == 0.0:
            memory.duty1 = min(max(sample.duty1, -1.0), 1.0)
            memory.duty2 = min(max(sample.duty2, -1.0), 1.0)
        first = 1.0 if memory.place < int(abs(memory.duty1) * carrier + 0.5) else 0.0
        second = 1.0 if memory.place < int(abs(memory.duty2) * carrier + 0.5) else 0.0
        now = int(memory.count) % 32
        memory.switched[now] = first if memory.duty1 > 0.0 else 0.0
        memory.switched[32 + now] = first if memory.duty1 < 0.0 else 0.0
        memory.switched[64 + now] = second if memory.duty2 < 0.0 else 0.0
        memory.switched[96 + now] = second if memory.duty2 > 0.0 else 0.0
        opens = parameter.opening_delay / sample.period
        closes = parameter.closing_delay / sample.period
        whole_opens = int(opens + 1e-9)
        whole_closes = int(closes + 1e-9)
        part_opens = max(opens - whole_opens, 0.0)
        part_closes = max(closes - whole_closes, 0.0)
        for valve in range(4):
            row = 32 * valve
            area = 0.0
            for piece in range(3):
                low = 0.0 if piece == 0 else (min(part_opens, part_closes) if piece == 1 else max(part_opens, part_closes))
                high = min(part_opens, part_closes) if piece == 0 else (max(part_opens, part_closes) if piece == 1 else 1.0)
                # 64 keeps the place positive: dead times reach back 30 samples and one
                late = (now - whole_opens - (0 if low >= part_opens else 1) + 64) % 32
                opened = memory.switched[row + late]
                late = (now - whole_closes - (0 if low >= part_closes else 1) + 64) % 32
                closed = memory.switched[row + late]
                target = min(opened, closed) if opens >= closes else max(opened, closed)
                length = (high - low) * sample.period
                gap = target - memory.opening[valve]
                needed = abs(gap) * parameter.valve_travel
                if needed <= length:
                    area = area + 0.5 * (memory.opening[valve] + target) * needed + target * (length - needed)
                    memory.opening[valve] = target
                else:
                    moved = (1.0 if gap > 0.0 else -1.0) * length / parameter.valve_travel
                    area = area + (memory.opening[valve] + 0.5 * moved) * length
                    memory.opening[valve] = memory.opening[valve] + moved
            memory.mean[valve] = area / sample.period
        memory.place = memory.place + 1.0
        memory.count = memory.count + 1.0
        return memory.mean[0], memory.mean[1], memory.mean[2], memory.mean[3]
