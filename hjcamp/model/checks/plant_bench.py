"""Run a plant on made-up inputs, and tell which of its base parameters its sensors cannot tell, and which effects they show."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import UsageError
from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.course import Given
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.plant import ALWAYS, Plant
from hjcamp.model.run.simulator import Simulator

Array = NDArray[np.float64]
SAMPLES = 1500
TESTS = 3
# The signs that inputs take.
BOTH, ONE = (-1.0, 1.0), (1.0,)
STEP = 1e-2
# Sensitivities are this accurate: a parameter of which no more is left beside the others moves together with them.
ALONE = 1e-3
SEEN = 1e-6
# A state so many times its usual size, under inputs of at most twice theirs, is where its plant is not meant to be; inputs so many
# times smaller are tried then.
FAR = 10.0
SHARES = (1.0, 0.1, 0.01)


@dataclass(frozen=True)
class Bench:
    """A plant with effects behind gates, on inputs that step up and down between rests, from several starts."""

    plant: type[Plant]
    effects: tuple[type[Effect], ...] = ()

    @property
    def simulator(self) -> Simulator:
        """The simulator, its effects behind gates."""
        return Simulator(Composition(self.plant, self.effects, gated=bool(self.effects)), free=True)

    def given(self, simulator: Simulator, signs: tuple[float, ...] = BOTH, share: float = 1.0) -> Given:
        """Return the tests: every input steps at random between rest and twice a ``share`` of its usual size, each at its own times.

        No input is taken beyond what is plausible of it.
        """
        generator = np.random.default_rng(20090405)
        inputs = np.tile(simulator.inputs(), (SAMPLES * TESTS, 1))
        for place, name in enumerate(simulator.composition.inputs):
            known = self.plant.inputs.get(name)
            if known is None or name in ALWAYS:
                continue
            lengths = generator.integers(SAMPLES // 40, SAMPLES // 8, SAMPLES)
            sizes = generator.choice((0.0, 0.5, 1.0, 2.0), SAMPLES) * generator.choice(signs, SAMPLES)
            inputs[:, place] = np.clip(share * known.typical * np.repeat(sizes, lengths)[: len(inputs)], *known.plausible)
        begins = np.zeros(len(inputs), dtype=np.int64)
        begins[::SAMPLES] = 1
        starts = np.array([[state.usual(generator) for state in self.plant.states.values()] for _ in range(TESTS)])
        # what nothing drives shows its friction while it rolls out alone
        for contact in simulator.composition.vocabulary.contacts if set(self.plant.inputs) - set(ALWAYS) else ():
            starts[:, list(self.plant.states).index(contact.velocity)] = 0.0
        time = np.tile(np.arange(SAMPLES) * self.plant.period, TESTS)
        return Given(self.plant.period, begins, time, inputs, starts)


def identified(plant: type[Plant]) -> str:
    """Refuse a plant with a base parameter that no log can tell; the message names what it moves together with.

    Inputs step to both signs, and where these do not tell it, to one: a valve cannot open less than not at all. Where they drive a
    state far beyond its usual size, smaller ones are tried, and at last that is what is said.
    """
    return under_either(lambda signs, share: _identified(plant, signs, share))


def _under(plant: type[Plant]) -> str:
    """Return in words the inputs under which a plant was tried: too small ones may move nothing."""
    own = [one for name, one in plant.inputs.items() if name not in ALWAYS]
    sizes = " and ".join(f"{one.name} of up to {2.0 * one.typical:.3g} {one.unit}" for one in own)
    return f" under {sizes} (twice its typical=...; does that move the machine?)" if own else ""


class FarAway(UsageError):  # noqa: N818 - it says where a test went, not that somebody made a mistake
    """The inputs of a check drove a state to where nobody knows whether the equations hold."""


def under_either(check: Callable[[tuple[float, ...], float], str]) -> str:
    """Return what a check says under inputs of both signs, else of one, of usual size, else of smaller.

    What it says against inputs under which states stay usual stands for smaller ones of these signs: those show less. It is raised,
    that against both signs first.
    """
    far: list[FarAway] = []
    stands: dict[tuple[float, ...], UsageError] = {}
    for share in SHARES:
        for signs in (BOTH, ONE):
            if signs in stands:
                continue
            try:
                return check(signs, share)
            except FarAway as problem:
                far.append(problem)
            except UsageError as problem:
                stands[signs] = problem
    raise stands.get(BOTH) or stands.get(ONE) or far[0]


def check_within(plant: type[Plant], states: Array, signs: tuple[float, ...], share: float) -> None:
    """Refuse a run whose states (n, states) left the finite numbers, or what is usual of them by far."""
    size = "" if share == 1.0 else f" {share:.2g} times as large"
    made = f"the inputs that this check made up{size}{' of one sign' if signs == ONE else ''}{_under(plant)}"
    names = list(plant.states)
    lost = ~np.isfinite(states).all(axis=1)
    if lost.any():
        first = int(np.argmax(lost))
        last = np.abs(states[max(first - 1, 0)]) / [abs(one.typical) for one in plant.states.values()]
        name = names[int(np.nanargmax(np.where(np.isfinite(last), last, -1.0)))]
        raise FarAway(
            f"plant {plant.name}: the simulation leaves the finite numbers at ordinary inputs and starts: {name} diverges, "
            f"{(first % SAMPLES) * plant.period:.3g} s after a start, by {made}"
        )
    largest = np.abs(states).max(axis=0) / [abs(one.typical) for one in plant.states.values()]
    place = int(np.argmax(largest))
    if largest[place] > FAR:
        item = plant.states[names[place]]
        raise FarAway(
            f"plant {plant.name}: {made} drove {names[place]} to {largest[place] * abs(item.typical):.3g} {item.unit}, "
            f"{largest[place]:.2g} times its typical=...: whether the equations hold there (a piston out of its stroke?) nobody "
            "knows, so what can be identified is not said; give the input a smaller typical=..., or the state its own"
        )


def _identified(plant: type[Plant], signs: tuple[float, ...], share: float) -> str:
    """Refuse what `identified` does under inputs of these signs, or that these drove a state too far to say so."""
    simulator = Bench(plant).simulator
    given = Bench(plant).given(simulator, signs, share)
    try:
        return _told(plant, simulator, given)
    except UsageError:
        check_within(plant, simulator.run_free(simulator.vector({}), given)[1], signs, share)
        raise


def _told(plant: type[Plant], simulator: Simulator, given: Given) -> str:
    names = [name for name in plant.base_parameters if plant.parameters[name].default != 0.0]
    if not names:
        return "no base parameters"
    columns = _sensitivities(simulator, given, names)
    sizes = np.linalg.norm(columns, axis=0)
    for name, size in zip(names, sizes[: len(names)], strict=True):
        if not size > SEEN * np.sqrt(len(columns)):
            raise UsageError(
                f"plant {plant.name}: the base parameter '{name}' changes nothing that is measured{_under(plant)}; is its input or "
                "sensor missing?"
            )
    directions = columns / np.where(sizes > 0.0, sizes, 1.0)
    for place, name in enumerate(names):
        others = np.delete(directions, place, axis=1)
        weights = np.linalg.lstsq(others, directions[:, place], rcond=None)[0]
        left = float(np.linalg.norm(directions[:, place] - others @ weights))
        if left < ALONE:
            rest = [other for other in range(directions.shape[1]) if other != place]
            labels = [*names, *(f"the start of {state}" for state in _unknown_starts(plant) for _ in given.starts)]
            found = sorted(zip(np.abs(weights), rest, strict=True), reverse=True)
            partners = dict.fromkeys(labels[other] for weight, other in found if weight > 0.05)
            raise UsageError(
                f"plant {plant.name}: the base parameter '{name}' moves together with {', '.join(partners)}: what is measured "
                "tells only their combination. Fix one of them (base=False), or measure more"
            )
    return f"{len(names)} base parameters, each by itself"


def effects_seen(plant: type[Plant], effects: Mapping[str, type[Effect]]) -> str:
    """Return how many of the effects change what is measured, and name those that do not."""
    if not effects:
        return "no effects fit"
    bench = Bench(plant, tuple(effects.values()))
    simulator = bench.simulator
    return under_either(lambda signs, share: _seen(plant, effects, simulator, bench.given(simulator, signs, share)))


def _seen(plant: type[Plant], effects: Mapping[str, type[Effect]], simulator: Simulator, given: Given) -> str:
    absent = simulator.run_free(simulator.vector({}), given)[0]
    scale = np.maximum(np.std(absent, axis=0), 1e-300)
    unseen, lost = [], []
    nothing = [name for name, item in plant.parameters.items() if item.default == 0.0]
    for name in effects:
        present = simulator.run_free(simulator.vector({f"gate.{name}": 1.0}), given)[0]
        if not np.all(np.isfinite(present)):
            if not nothing:
                raise UsageError(
                    f"plant {plant.name}: with the effect '{name}' at its defaults the simulation leaves the finite numbers"
                )
            lost.append(name)
        elif np.max(np.sqrt(np.mean((present - absent) ** 2, axis=0)) / scale) < SEEN:
            unseen.append(name)
    found = f"{len(effects) - len(unseen) - len(lost)} of {len(effects)}" + (f"; not {', '.join(unseen)}" if unseen else "")
    # bristles bend as far as a dry friction that is not there
    return found + (f"; not {', '.join(lost)} while {', '.join(nothing)} is 0" if lost else "")


def _unknown_starts(plant: type[Plant]) -> list[str]:
    """Return the states of which nobody knows where a test begins: so it is declared, or nothing measures them."""
    seen = {one.of for one in plant.measured.values()}
    return [name for name, state in plant.states.items() if state.start == "unknown" or not (plant.channels or name in seen)]


def _sensitivities(simulator: Simulator, given: Given, names: Sequence[str]) -> Array:
    """Return the change of all readings (readings, parameters and each test's unknown starts) for one relative change of each."""
    plant = simulator.composition.plant
    defaults = {name: plant.parameters[name].default for name in names}
    base = simulator.run_free(simulator.vector({}), given)[0]
    if not np.all(np.isfinite(base)):
        raise UsageError(f"plant {plant.name}: the simulation leaves the finite numbers at ordinary inputs and starts")
    scale = np.maximum(np.std(base, axis=0), 1e-300)

    def readings(values: Mapping[str, float], starts: Array) -> Array:
        moved = Given(given.period, given.begins, given.time, given.inputs, starts)
        return np.asarray(simulator.run_free(simulator.vector(values), moved)[0] / scale)

    columns = []
    for name, value in defaults.items():
        ends = [readings({name: value * (1.0 + sign * STEP)}, given.starts) for sign in (1.0, -1.0)]
        columns.append(np.ravel(ends[0] - ends[1]) / (2.0 * STEP))
    for name in _unknown_starts(plant):
        for test in range(len(given.starts)):  # each has a start of its own
            move = np.zeros_like(given.starts)
            move[test, list(plant.states).index(name)] = STEP * plant.states[name].typical
            ends = [readings({}, given.starts + sign * move) for sign in (1.0, -1.0)]
            columns.append(np.ravel(ends[0] - ends[1]) / (2.0 * STEP))
    return np.column_stack(columns)
