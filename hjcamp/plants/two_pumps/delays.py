"""The delay of two pump commands."""

from __future__ import annotations

from hjcamp.model.declare.law import Law, Memory
from hjcamp.model.declare.parameter import Parameter

LONGEST_S = 0.06


class TwoDelays(Law):
    """Each pump's position loop gets its command later: whole samples and the fraction of one (thesis 4.3.4)."""

    samples = ("command1", "command2", "period")
    results = ("command1", "command2")

    pump_delay = Parameter("s", 0.002, (0.0, LONGEST_S), text="delay of the commands (4.3.4)")

    count = Memory()
    before = Memory(size=128)

    @staticmethod
    def step(sample, parameter, memory):  # type: ignore[no-untyped-def]
        """Return both commands as they arrive."""
        now = int(memory.count) % 64
        memory.before[now] = sample.command1
        memory.before[64 + now] = sample.command2
        late = parameter.pump_delay / sample.period
        whole = int(late + 1e-9)
        part = max(late - whole, 0.0)
        one = (now - whole + 64) % 64
        other = (now - whole + 127) % 64
        memory.count = memory.count + 1.0
        first = (1.0 - part) * memory.before[one] + part * memory.before[other]
        second = (1.0 - part) * memory.before[64 + one] + part * memory.before[64 + other]
        return first, second
