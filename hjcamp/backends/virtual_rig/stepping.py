"""Any plant one sample at a time, as a rig has it: under the inputs that were written last."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.backends.plant_simulation import apart, draws, model_of, plant_in
from hjcamp.errors import HjcampError
from hjcamp.model.compile.compose import Composition
from hjcamp.model.compile.kernel import kernel_source
from hjcamp.model.declare import loop
from hjcamp.model.run.simulator import Simulator

Array = NDArray[np.float64]
DRAWN = 20_000  # samples after which the scatter of friction and the noise of sensors begin again


@dataclass(frozen=True)
class StepSimulator(Simulator):
    """A plant whose kernel makes one sample for each call."""

    def _text(self) -> str:
        head = f"READINGS = {len(self.composition.measured)}\n\n\n"
        return kernel_source(self.composition, f"{head}@entry\n{inspect.getsource(loop.tick)}")


def step_simulator(config: Mapping[str, Any]) -> StepSimulator:
    """Return the simulator of a configuration's plant with its effects; nothing controls it."""
    plant = plant_in(config)
    return StepSimulator(Composition(plant, tuple(model_of(config, plant)[0])))


def compile_stepping(config: Mapping[str, Any]) -> None:
    """Compile what a sample of a configuration's plant needs, so that no deadline passes while it is compiled."""
    VirtualPlant(config, 1, samples=2).advance({})


class VirtualPlant:
    """The plant of one test, at its start when it is made; what differs from test to test follows from the seed.

    After ``samples`` draws begin again; the command phase begins at sample ``first``, to which ``brought`` gives states as a law does.
    With those of a simulated test, equal outputs give equal readings.
    """

    def __init__(
        self,
        config: Mapping[str, Any],
        seed: int,
        samples: int = DRAWN,
        first: int = 0,
        brought: Mapping[str, float] | None = None,
    ) -> None:
        plant = plant_in(config)
        self.plant, self.simulator = plant, step_simulator(config)
        values, delays = apart(model_of(config, plant)[1])
        generator = np.random.default_rng(seed)
        for name in plant.drawn:
            drawn = generator.uniform(*plant.parameters[name].bounds)
            values.setdefault(name, drawn)
        self._p = self.simulator.vector(values)
        known = dict(zip(self.simulator.composition.parameters, self._p, strict=True))
        self._drawn = draws(config, self.simulator, known, generator, samples, brought or {})
        self._kernel, self._first = self.simulator.kernel, first
        self._z = np.zeros(len(self.simulator.states))
        for name, value in self._drawn.start.items():
            self._z[self.simulator.states.index(name)] = value
        self._propagators = self.simulator.propagators(self._z, self._p)
        self._u, self._work, self._facing = self.simulator.inputs(), self.simulator.scratch(), np.zeros(1)
        self.inputs = list(self.simulator.composition.inputs)
        self._late = np.array([max(delays.get(name, 0.0), 0.0) for name in self.inputs]) / plant.period
        self._asked: list[Array] = []
        self.sample = -1

    def advance(self, given: Mapping[str, float]) -> Array:
        """Go on to the next sample under the inputs ``given`` by name (SI); return the readings, SI."""
        self.sample += 1
        rows, drawn = len(self._drawn.inputs), self._drawn
        asked, now = (drawn.inputs[max(row, 0) % rows].copy() for row in (self.sample - 1, self.sample))
        for name, value in given.items():
            asked[self.inputs.index(name)] = value
        acting = self._delayed(asked)
        for name in given:
            now[self.inputs.index(name)] = acting[self.inputs.index(name)]
        self._kernel.tick(
            self.sample, (self.sample - self._first) * self.plant.period, acting, now, self._z, self._u, self._p, *self._propagators,
            self.plant.period, drawn.counts, drawn.phases, drawn.noise[self.sample % rows], self._facing, self._work,
        )  # fmt: skip
        if not np.isfinite(self._z).all():
            raise HjcampError(f"the virtual rig's plant left the finite numbers after {self.sample * self.plant.period:.4g} s")
        return np.array(self._work[3, : len(drawn.counts)])

    def _delayed(self, asked: Array) -> Array:
        """Return the inputs that act now: each comes as late as its delay says, a fraction of a sample as a mean of two."""
        if not self._late.any():
            return asked
        self._asked = [*self._asked, asked][-int(self._late.max()) - 2 :]
        history, last = np.array(self._asked), len(self._asked) - 1
        found = asked.copy()
        for place, late in enumerate(self._late):
            whole, part = int(late), late - int(late)
            found[place] = (1.0 - part) * history[max(last - whole, 0), place] + part * history[max(last - whole - 1, 0), place]
        return found
