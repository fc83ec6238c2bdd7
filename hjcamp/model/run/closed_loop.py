"""Any plant in a closed loop: its equations, a controller's law and its actuation in one kernel."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import HjcampError
from hjcamp.model.compile.compose import Composition
from hjcamp.model.compile.kernel import kernel_source
from hjcamp.model.declare import loop
from hjcamp.model.declare.law import Law, law_source
from hjcamp.model.language.term_checks import limited
from hjcamp.model.run.simulator import BEFORE, Simulator

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LoopTest:
    """What one test needs beyond the model, n samples: SI.

    The law runs from sample ``first`` to before ``last``. ``reference`` (n, columns): value, velocity, acceleration and what
    was planned; ``inputs`` (n, inputs) where nothing commands; ``late`` (inputs,) samples by which an input acts later than it
    is recorded; ``counts``, ``phases`` (readings) and ``noise`` (n, readings). With phases ``reference`` ends with two columns
    for each commanded input: where it goes outside the law, and which part of the way it goes in this sample.
    """

    control: Array
    first: int
    last: int
    reference: Array
    inputs: Array
    late: Array
    counts: Array
    phases: Array
    noise: Array


@dataclass(frozen=True)
class LoopSimulator(Simulator):
    """A plant with a law in its loop.

    ``reads`` are the expressions that give the law's samples, ``sums`` for each commanded input the answers whose sum it
    is (see `hjcamp.controllers.fit`). Where the plant has an ``actuation``, that turns the answers into inputs.
    """

    law: type[Law] = Law
    reads: tuple[str, ...] = ()
    sums: tuple[tuple[str, tuple[str, ...]], ...] = ()

    @property
    def actuation(self) -> type[Law] | None:
        """The law between the controller's answers and the inputs; none where its answers are inputs."""
        known = self.composition.plant.actuation
        return known if known is not None and set(known.results) == {name for name, _ in self.sums} else None

    def _text(self) -> str:
        inputs = self.composition.inputs
        commanded = [name for name, _ in self.sums]
        given = tuple(place for place, name in enumerate(inputs) if name not in commanded)
        lines = [
            f"READINGS = {len(self.composition.measured)}",
            f"GIVEN = {given}",
            f"ANSWERS = {len(self.law.results)}",
        ]
        text = "\n".join(lines) + "\n\n\n" + self.law_text()
        text += f"@inlined\n{inspect.getsource(loop.late_input)}\n\n@loop\n{inspect.getsource(loop.run_loop)}"
        return kernel_source(self.composition, text)

    def law_text(self) -> str:
        """Return the text of the law and the actuation, and of ``command`` between the readings and the inputs."""
        moved = "" if self.actuation is None else law_source(self.actuation, "actuate")
        return law_source(self.law, "control") + moved + self._command()

    @property
    def phased(self) -> bool:
        """Whether the plant declares what is commanded before or after the law: two more columns of the reference for each input."""
        return bool(self.composition.plant.phases_before or self.composition.plant.phases_after)

    def fresh_memory(self) -> Array:
        """Return the memory of the law at the begin of a test, with what was commanded last where there are phases."""
        return np.concatenate([self.law.fresh_memory(), np.zeros(len(self.sums) if self.phased else 0)])

    def actuator(self, p: Array) -> tuple[Array, Array]:
        """Return the parameters and the memory of the actuation; one number each where there is none."""
        moving = self.actuation
        if moving is None:
            return np.zeros(1), np.zeros(1)
        values = dict(zip(self.composition.parameters, p, strict=True))
        return moving.vector({name: values[name] for name in moving.parameters}), moving.fresh_memory()

    def _command(self) -> str:
        """Return the function between the readings and the inputs, in the names of the laws."""
        inputs = self.composition.inputs
        answers = [f"answer_{name}" for name in self.law.results]
        lines = [
            *(f"{one} = 0.0" for one in answers),
            "if running:",
            f"    {', '.join(answers)} = control({', '.join([*self.reads, 'c', 'm'])})",
            *(f"record[{place}] = {one}" for place, one in enumerate(answers)),
        ]
        if self.actuation is not None:
            known = {name: f"answer_{name}" for name in self.law.results} | {
                "period": "h",
                "time": "time",
                "index": "index",
            }
            moved = ", ".join(f"moved_{name}" for name in self.actuation.results)
            lines.append(f"{moved} = actuate({', '.join([*(known[name] for name in self.actuation.samples), 'ap', 'am'])})")
            lines += [f"u[{inputs.index(name)}] = moved_{name}" for name in self.actuation.results]
        else:
            lines += [
                f"u[{inputs.index(name)}] = {' + '.join(f'answer_{part}' for part in parts)}" for name, parts in self.sums
            ]
        if self.phased:
            held = len(self.law.fresh_memory())
            for place, (name, _) in enumerate(self.sums):
                asked, goal, last = f"u[{inputs.index(name)}]", 2 * (place - len(self.sums)), f"m[{held + place}]"
                lines += [
                    "if not running:",
                    f"    {asked} = {last} + row[{goal + 1}] * (row[{goal}] - {last})",
                    f"{last} = {asked}",
                ]
        head = "@inlined\ndef command(running, time, index, row, seen, h, c, m, ap, am, record, u):\n"
        return head + "".join(f"    {line}\n" for line in lines) + "\n\n"

    @property
    def laws(self) -> tuple[type[Law], ...]:
        """The controller."""
        return (self.law,)

    @limited
    def run_loop(self, start: Mapping[str, float], p: Array, test: LoopTest, tolerance: float = 1.0) -> dict[str, Array]:
        """Return what a test records (n,), SI: the law's answers ``answer.NAME``, the inputs, and the readings ``reading.NAME``.

        ``start`` holds the plant's states; ``tolerance`` is the accepted correction of a step
        without one before it, in resolutions of the states; others may take `BEFORE` times that.
        Raises ``HjcampError`` where the simulation leaves the finite numbers.
        """
        composition = self.composition
        z = np.zeros(len(self.states))
        for name, value in start.items():
            z[self.states.index(name)] = value
        answers, inputs, measured = self.law.results, composition.inputs, composition.measured
        record = np.empty((len(test.inputs), len(answers) + len(inputs) + len(measured)))
        ap, am = self.actuator(p)
        work = self.scratch()
        work[2, 3], work[2, 5] = BEFORE * tolerance, tolerance
        period = composition.plant.period
        self.kernel.run_loop(
            z, self.inputs(), p, *self.propagators(z, p), period, test.first, test.last, test.control,
            self.fresh_memory(), ap, am, test.reference, test.inputs, test.late, test.counts, test.phases, test.noise, record, work,
        )  # fmt: skip
        if not np.isfinite(record).all():
            where = int(np.argmax(~np.all(np.isfinite(record), axis=1)))
            raise HjcampError(
                f"the simulation left the finite numbers {where * period:.4g} s after its begin; check the parameters and the start"
            )
        names = [*(f"answer.{name}" for name in answers), *inputs, *(f"reading.{name}" for name in measured)]
        return dict(zip(names, record.T, strict=True))


def loop_simulator(
    composition: Composition, law: type[Law], reads: list[str], sums: Mapping[str, tuple[str, ...]]
) -> LoopSimulator:
    """Return the simulator of a plant with a law, by what `hjcamp.controllers.fit` says of the two."""
    return LoopSimulator(composition, law=law, reads=tuple(reads), sums=tuple(sums.items()))
