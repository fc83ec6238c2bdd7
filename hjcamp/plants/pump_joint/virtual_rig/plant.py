"""The plant on the virtual bench: the simulator's own kernel, one sample at a time."""

from __future__ import annotations

import copy
import functools
import inspect
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.compile.kernel import load_model
from hjcamp.model.run.simulator import PERIOD, Propagators
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.loop import FRESH, JointSimulator
from hjcamp.plants.pump_joint.procedure import Procedure
from hjcamp.plants.pump_joint.simulation import prepare
from hjcamp.plants.pump_joint.virtual_rig import tick

Array = NDArray[np.float64]
LONGEST_DELAY = 1024  # samples of the command that are kept
READINGS = tuple(channel.field for channel in PumpJoint.channels)


@functools.cache
def _tick_text() -> str:
    return f"@entry\n{inspect.getsource(tick.rig_tick)}"


def bench_text(simulator: JointSimulator) -> str:
    """Return the text of the kernel that stands for the joint on the bench."""
    return f"{simulator.bench_source}\n\n{_tick_text()}\n\n"


class VirtualPlant:
    """The joint of one test, at rest when it is made.

    The draws (friction, noise, first pressures) are those that ``backend=simulation`` makes from the same seed, so
    equal outputs give equal readings. ``hidden`` is what the client does not know: {effect: {parameter: SI value}}.
    """

    def __init__(self, config: Mapping[str, Any], seed: int, hidden: Mapping[str, Mapping[str, float]] | None = None) -> None:
        known = copy.deepcopy(dict(config))
        for name, given in (hidden or {}).items():
            known["effects"] = {**(known.get("effects") or {}), name: dict(given or {})}
        prepared = prepare(known, seed)
        self._simulator, self._test, p = prepared.simulator, prepared.test, prepared.p.copy()
        if known["rig"].get("outputs", {}).get("pump", {}).get("quantity") == "voltage":
            # Without the drive's own position loop the motor has no restoring term: x''' = K V - a2 x'' - a1 x'.
            p[list(self._simulator.composition.parameters).index("pump_a0")] = 0.0
        self._p = p
        self._z = self._simulator.begin(prepared.start, p)
        self._propagators = self._simulator.propagators(self._z, p)
        self._u = self._simulator.inputs()
        whole, part = divmod(round(self._test.delay / PERIOD, 9), 1.0)
        self._delay = np.array([whole, part])
        self._procedure_memory = Procedure.fresh_memory()
        self._history = np.zeros(LONGEST_DELAY)
        self._memory = FRESH.copy()
        self._work = self._simulator.scratch()
        self._kernel = load_model(bench_text(self._simulator))
        self._burst = np.zeros(0, dtype=np.int64)
        self.sample = -1
        self.seen = np.zeros(len(READINGS))
        if not getattr(self._kernel.rig_tick, "signatures", True):
            self._compile()

    def _compile(self) -> None:
        # By a sample of a twin: in the first sample of a test a client on another computer would give up waiting.
        copied = copy.copy(self)
        for name, value in vars(self).items():
            if isinstance(value, np.ndarray):
                setattr(copied, name, value.copy())
        plan, space, steps = self._propagators
        copied._propagators = Propagators(plan.copy(), space.copy(), steps.copy())
        copied.advance(np.zeros(3))

    def advance(self, outputs: Array) -> Array:
        """Go on to the next sample under ``outputs`` (pump command rad, dither V, preload speed m/s).

        Returns the readings (channels of the plant, SI): encoders in whole counts, pressures with noise.
        """
        self.sample += 1
        test = self._test
        self._kernel.rig_tick(
            self.sample, outputs, self._z, self._u, self._p, *self._propagators, PERIOD, test.procedure,
            self._procedure_memory, self._delay, test.preload_area, self._burst, test.counts, test.phases, test.noise,
            test.scatter, self._history, self._memory, self.seen, self._work,
        )  # fmt: skip
        return self.seen

    def burst(self, line: int) -> None:
        """Open line 1 or 2 to the air from the next sample on."""
        self._burst = np.array([self._simulator.states.index(f"pressure{line}")], dtype=np.int64)

    def count(self, field: str) -> float:
        """Return one count of an encoder, rad."""
        return float(self._test.counts[READINGS.index(field)])
