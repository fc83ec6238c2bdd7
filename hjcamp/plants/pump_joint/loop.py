"""The pump joint in closed loop: its equations, the procedure and a controller in one kernel."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import HjcampError
from hjcamp.model.compile.kernel import copied, kernel_source
from hjcamp.model.declare.law import Law, law_source
from hjcamp.model.language.term_checks import limited
from hjcamp.model.run.simulator import BEFORE, PERIOD, Propagators, Simulator
from hjcamp.plants.pump_joint import sample
from hjcamp.plants.pump_joint.procedure import Procedure

Array = NDArray[np.float64]
FUNCTIONS = ("measure", "sense", "decide", "act", "closed_loop")
BENCH = ("measure", "sense", "act")
RECORDED = ("phase", "reference", "command", "pid", "feedforward", "dither")
FRESH = np.array([0.0, -1.0, 0.0, 0.0, 0.0])  # what `sample.sense` remembers before the first sample


class NotEndedError(HjcampError):
    """A test used up its rows of noise before it came to its end."""


@dataclass(frozen=True)
class ClosedLoop:
    """What one test needs beyond the model: laws with their parameters, reference, sensors and the draws of its seed.

    ``reference`` (n, 4): angle, velocity, acceleration, feedforward in rad; ``delay`` in s; ``noise`` (samples,
    channels) and ``scatter`` (samples) hold one row for each sample that the test may last.
    """

    control: Array
    procedure: Array
    reference: Array
    dither: Array
    delay: float
    preload_area: float
    counts: Array
    phases: Array
    noise: Array
    scatter: Array


@dataclass(frozen=True)
class JointSimulator(Simulator):
    """The pump joint with a controller and its procedure."""

    controller: type[Law] = Law
    procedure: type[Law] = Procedure

    @property
    def laws(self) -> tuple[type[Law], ...]:
        """The controller."""
        return (self.controller,)

    @cached_property
    def bench_source(self) -> str:
        """The text of a kernel with plant, sensors and procedure: whatever controls is elsewhere, so all controllers share it."""
        return self._looked_at(
            lambda: kernel_source(
                self.composition, self._places() + law_source(self.procedure, "procedure") + copied(sample, BENCH)
            )
        )

    def _text(self) -> str:
        text = self._places() + law_source(self.controller, "control") + law_source(self.procedure, "procedure")
        return kernel_source(self.composition, text + copied(sample, FUNCTIONS))

    def _places(self) -> str:
        composition, inputs = self.composition, self.composition.inputs
        fields = [channel.field for channel in composition.plant.channels]
        lines = [
            f"READINGS = {len(fields)}",
            f"PRESSURE1 = {fields.index('pressure1_mpa')}",
            f"PRESSURE2 = {fields.index('pressure2_mpa')}",
            f"ARM = {fields.index('arm_deg')}",
            f"COMMAND = {inputs.index('command')}",
            f"DITHER = {inputs.index('dither')}",
            f"PRELOAD = {inputs.index('preload_flow')}",
            f"SCATTER = {inputs.index('friction_scatter')}",
        ]
        return "\n".join(lines) + "\n\n\n"

    @limited
    def run(
        self,
        start: Mapping[str, float],
        p: Array,
        test: ClosedLoop,
        propagators: Propagators | None = None,
        tolerance: float = 1.0,
    ) -> dict[str, Any]:
        """Run one test from its preload to its release; return the recorded columns in SI units by name.

        ``tolerance`` is the accepted correction of a step without one before it, in units of the states' resolution; others may
        take `BEFORE` times that.
        """
        z = self.begin(start, p)
        propagators = propagators or self.propagators(z, p)
        channels = self.composition.plant.channels
        record = np.empty((len(test.noise), len(RECORDED) + len(channels)))
        work = self.scratch()
        work[2, 3], work[2, 5] = BEFORE * tolerance, tolerance
        procedure_memory = self.procedure.fresh_memory()
        whole, part = divmod(round(float(test.delay) / PERIOD, 9), 1.0)
        count = self.kernel.closed_loop(
            z, self.inputs(), p, *propagators, PERIOD, test.control, self.controller.fresh_memory(), test.procedure,
            procedure_memory, test.reference, test.dither, np.array([whole, part]), test.preload_area,
            test.counts, test.phases, test.noise, test.scatter, np.zeros(int(whole) + 2),
            FRESH.copy(), np.zeros(2), np.zeros(len(RECORDED) + 1), record, work,
        )  # fmt: skip
        phase = int(procedure_memory[list(self.procedure.memories).index("phase")])
        if count < 0 or phase > 5:
            reached = record[: count if count >= 0 else None, 0]
            last = int(reached[-1]) if len(reached) else 0
            raise (NotEndedError if count < 0 else HjcampError)(
                f"the test never left phase {last} (0 preload, 1 pressure adjustment, "
                "2 rest, 3 control, 4 release); check procedure.preload_mpa, the adjustment and procedure.phase_limit_s"
            )
        record = record[:count]
        if not np.isfinite(record).all():
            where = int(np.argmax(~np.all(np.isfinite(record), axis=1)))
            raise HjcampError(f"the simulation left its valid range after {where * PERIOD:.3f} s; check the parameters")
        columns: dict[str, Any] = {name: record[:, index] for index, name in enumerate(RECORDED)}
        columns.update({channel.field: record[:, len(RECORDED) + i] for i, channel in enumerate(channels)})
        columns["steps"], columns["events"] = work[2, 1], work[2, 2]
        return columns
