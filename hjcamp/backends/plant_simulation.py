"""Any plant on the simulator: one resolved configuration with a ``plant`` and one seed give the columns of one test log."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.backends.schedule import schedule_of
from hjcamp.controllers import find_controller
from hjcamp.controllers.controller import Controller
from hjcamp.controllers.fit import commanded, controlled_field, input_field, measured_fields, quantity, sources
from hjcamp.effects import chosen_effects
from hjcamp.errors import UsageError
from hjcamp.known_plants import find_plant
from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.base_values import DELAY, checked_base, period_of
from hjcamp.model.declare.plant import ALWAYS, Plant
from hjcamp.model.language.field_table import fields_of
from hjcamp.model.language.field_unit import FieldUnit, unit_of_field
from hjcamp.model.run.closed_loop import LoopSimulator, LoopTest, loop_simulator
from hjcamp.model.run.simulator import Simulator
from hjcamp.trajectories import build_trajectory

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Prepared:
    """All that one test needs: the simulator, its parameter vector, the start of the plant's states, the test, its phases (n,)."""

    simulator: LoopSimulator
    p: Array
    start: dict[str, float]
    test: LoopTest
    phases: Array


def plant_in(config: Mapping[str, Any]) -> type[Plant]:
    """Return the plant that a configuration names."""
    return find_plant(str(config["plant"]["name"]), "plant")


def model_of(config: Mapping[str, Any], plant: type[Plant]) -> tuple[list[Any], dict[str, float]]:
    """Return the effects of a configuration, and the values of plant and effects under their full names, SI.

    ``delay.INPUT`` (s) is by how much an input acts later than its log says.
    """
    model = config["model"]
    given = {name: dict(values or {}) for name, values in (model.get("effects") or {}).items()}
    for name, values in (config.get("effects") or {}).items():
        given[name] = {**given.get(name, {}), **(values or {})}
    effects, parameters = chosen_effects(given, plant=plant, period=period_of(model, "model"))
    full = checked_base(model.get("parameters"), plant, "model.parameters")
    full |= checked_base(config.get("parameters"), plant, "parameters")
    for effect, own in parameters.items():
        full |= {f"{effect}.{name}": value for name, value in own.items()}
    return effects, full


def law_of(config: Mapping[str, Any]) -> tuple[type[Controller], str]:
    """Return the controller of a configuration and the input that it is told to command, empty where none is said."""
    given = config["controller"]
    return find_controller(str(given["name"])), str(given.get("input") or "")


def law_values(config: Mapping[str, Any], law: type[Controller]) -> dict[str, float]:
    """Return the parameters of a law: what the configuration says, completed by the law's defaults."""
    given = config["controller"]
    flat = {name: float(given[name]) for name in law.parameters if given.get(name) is not None}
    for side in ("positive", "negative"):
        flat |= {f"{side}_{gain}": float(value) for gain, value in (given.get(side) or {}).items()}
    return {name: item.default for name, item in law.parameters.items()} | flat


def followed_unit(config: Mapping[str, Any], plant: type[Plant]) -> tuple[str, FieldUnit]:
    """Return the field that the trajectory is in, and its unit: the input that it is given to, else what is controlled."""
    law, chosen = law_of(config)
    given = next(iter(commanded(law, plant, chosen)), "") if law.results == ("given",) else ""
    field = input_field(plant, given) if given else controlled_field(plant)
    return field, unit_of_field(field, f"plant {plant.name}")


def reference_of(config: Mapping[str, Any], plant: type[Plant]) -> tuple[Array, float]:
    """Return the reference (n, 3): value, velocity and acceleration in SI; and the direction of the first motion."""
    _, unit = followed_unit(config, plant)
    trajectory = build_trajectory(config["trajectory"], unit=unit)
    time = np.arange(max(round(trajectory.duration / plant.period), 1)) * plant.period
    return np.column_stack(trajectory.reference(time)) * (np.degrees(1.0) / unit.scale), trajectory.first_direction


@functools.lru_cache(maxsize=16)
def _simulator(plant: Any, effects: tuple[Any, ...], law: Any, chosen: str) -> LoopSimulator:
    composition = Composition(plant, effects)
    return loop_simulator(composition, law, sources(law, plant, law.planned), commanded(law, plant, chosen))


def simulator_of(config: Mapping[str, Any]) -> LoopSimulator:
    """Return the simulator that a configuration asks for."""
    plant = plant_in(config)
    for name, source in plant.rates_of_inputs().items():
        raise UsageError(
            f"plant {plant.name} is driven by a motion that was measured ('{name}' is the rate of '{source}'): its logs are analysed, "
            "it is not simulated"
        )
    law, chosen = law_of(config)
    hashable: tuple[Any, Any] = (plant, law)
    return _simulator(hashable[0], tuple(model_of(config, plant)[0]), hashable[1], chosen)


def prepare(config: Mapping[str, Any], seed: int) -> Prepared:
    """Return what a resolved configuration and a seed say about one test, before anything is run."""
    plant = plant_in(config)
    law, _ = law_of(config)
    simulator = simulator_of(config)
    values, delays = apart(model_of(config, plant)[1])
    generator = np.random.default_rng(seed)
    for name in plant.drawn:
        drawn = generator.uniform(*plant.parameters[name].bounds)
        values.setdefault(name, drawn)
    p = simulator.vector(values)
    known = dict(zip(simulator.composition.parameters, p, strict=True))
    reference, direction = reference_of(config, plant)
    times = schedule_of(config, plant, [name for name, _ in simulator.sums], len(reference))
    rows = np.clip(np.arange(len(times.phases)) - times.first, 0, len(reference) - 1)
    gains = law_values(config, law)
    if "first_direction" in gains:
        gains["first_direction"] = direction
    if law.planned:
        planned = inverted(config, reference) if law.inverts else law.plan(reference, gains, known, plant.period)
        reference = np.column_stack([reference, planned])
    random = draws(config, simulator, known, generator, len(rows), law.begin(gains, known))
    # what acts earlier than its log says does so on paper alone: no loop sends a command before it knows it
    late = np.array([max(delays.get(name, 0.0), 0.0) for name in simulator.composition.inputs]) / plant.period
    test = LoopTest(
        control=law.vector(gains),
        first=times.first,
        last=times.last,
        reference=np.hstack([reference[rows], times.driven]) if simulator.phased else reference[rows],
        inputs=random.inputs,
        late=late,
        counts=random.counts,
        phases=random.phases,
        noise=random.noise,
    )
    return Prepared(simulator, p, random.start, test, times.phases)


def inverted(config: Mapping[str, Any], reference: Array) -> Array:
    """Return the input (n, 1) with which the controller's model follows a reference (n, 3), SI; raises ``UsageError`` with the reason.

    ``controller_model`` is that model as it was planned; without it the plant is taken as declared.
    """
    from hjcamp.model.run.inverse import inverse_inputs

    plant, (law, chosen) = plant_in(config), law_of(config)
    model = config.get("controller_model") or {"parameters": {}, "effects": {}}
    effects, values = model_of({"model": model}, plant)
    [name] = commanded(law, plant, chosen)
    reading = measured_fields(plant).index(controlled_field(plant))
    start = start_of(config, plant, {})
    return inverse_inputs(Composition(plant, tuple(effects)), reading, name, apart(values)[0], reference, start)[:, None]


@dataclass(frozen=True)
class Draws:
    """What differs from test to test: the start, the inputs (n, inputs) with the scatter of friction, and what sensors do."""

    start: dict[str, float]
    inputs: Array
    counts: Array
    phases: Array
    noise: Array


def draws(
    config: Mapping[str, Any],
    simulator: Simulator,
    known: Mapping[str, float],
    generator: np.random.Generator,
    samples: int,
    brought: Mapping[str, float],
) -> Draws:
    """Return what a test of so many samples draws; ``known`` are the values of the parameters, ``brought`` states as in `start_of`."""
    plant, again = simulator.composition.plant, config["plant"]
    inputs = np.tile(simulator.inputs(), (samples, 1))
    scatter = plant.friction_varies.factors(generator, samples, plant.period)
    inputs[:, simulator.composition.inputs.index("friction_scatter")] = scatter ** float(again["scatter"])
    start = start_of(config, plant, brought)
    for name, state in plant.states.items():
        start[name] += state.scatter * float(again["scatter"]) * generator.standard_normal()
    counts, noise = sensors_of(plant, known)
    phases = generator.uniform(0.0, 1.0, len(counts))
    return Draws(
        start, inputs, counts, phases, generator.standard_normal((samples, len(noise))) * noise * float(again["noise"])
    )


def apart(values: Mapping[str, float]) -> tuple[dict[str, float], dict[str, float]]:
    """Return the values of parameters, and the delays (s) of inputs by the input's name."""
    delays = {name.removeprefix(DELAY): value for name, value in values.items() if name.startswith(DELAY)}
    return {name: value for name, value in values.items() if not name.startswith(DELAY)}, delays


def start_of(config: Mapping[str, Any], plant: type[Plant], brought: Mapping[str, float]) -> dict[str, float]:
    """Return the plant's states at the begin of a test: as configured, else as ``brought`` there, else as declared, else 0."""
    declared = {name: state.start if isinstance(state.start, int | float) else 0.0 for name, state in plant.states.items()}
    return {name: float(value) for name, value in {**declared, **brought, **(config.get("start") or {})}.items()}


def sensors_of(plant: type[Plant], values: Mapping[str, float]) -> tuple[Array, Array]:
    """Return one count and the standard deviation of the noise of each reading, SI; 0 where there is none."""
    if plant.channels:
        pairs = [(values.get(one.counts or "", 0.0), values.get(one.noise or "", 0.0)) for one in plant.channels]
    else:
        pairs = [(one.counts or 0.0, one.noise or 0.0) for one in plant.measured.values()]
    counts, noise = np.array(pairs, dtype=np.float64).reshape(-1, 2).T
    return counts, noise


def kernel_texts(config: Mapping[str, Any]) -> dict[str, tuple[str, str]]:
    """Return the kernel that a test needs: what it is in words, its text, and the function that is compiled last."""
    simulator = simulator_of(config)
    names = ", ".join(effect.name for effect in simulator.composition.effects) or "no effect"
    words = f"{simulator.composition.plant.name} under controller {simulator.law.name} with {names}"
    return {words: (simulator.source, "run_loop")}


def run_test(config: Mapping[str, Any], seed: int) -> tuple[dict[str, Array], dict[str, str]]:
    """Simulate one test; return the columns of its log, in the units of the plant's fields, and notes for its metadata.

    The same configuration and seed give the same columns bit for bit. Raises ``HjcampError`` where the simulation leaves the
    finite numbers.
    """
    prepared = prepare(config, seed)
    recorded = prepared.simulator.run_loop(prepared.start, prepared.p, prepared.test)
    return log_columns(config, prepared, recorded), {}


def log_columns(config: Mapping[str, Any], prepared: Prepared, recorded: Mapping[str, Array]) -> dict[str, Array]:
    """Return what was recorded under the names and in the units of the plant's fields."""
    test, place = prepared.test, np.arange(len(prepared.test.inputs))
    known = {**recorded, "phase": prepared.phases}
    known["reference"] = test.reference[:, 0]
    found = {"time_s": (place - test.first) * prepared.simulator.composition.plant.period}
    found |= {name: known[source] * scale for name, (source, scale) in log_sources(config, prepared.simulator).items()}
    return {name: np.asarray(values, dtype=np.float64) for name, values in found.items()}


def log_sources(config: Mapping[str, Any], simulator: LoopSimulator) -> dict[str, tuple[str, float]]:
    """Return each field of a log but its time, in order: what is recorded for it, and that one's number for one SI unit.

    Recorded are ``phase``, ``reference``, the answers ``answer.NAME`` of the law, inputs and readings ``reading.NAME``.
    """
    plant = simulator.composition.plant
    found: dict[str, tuple[str, float]] = {"phase": ("phase", 1.0)}
    field, unit = followed_unit(config, plant)
    table = fields_of(plant)
    wanted = next((name for name in (f"reference_{field}", f"reference_{unit.suffix}") if name in table.names), None)
    if wanted is not None:
        found[wanted] = ("reference", unit.scale)
    shown, shown_fields = simulator.composition.measured, measured_fields(plant)
    for name, signal in zip(shown_fields, shown, strict=True):
        found[name] = (f"reading.{signal}", unit_of_field(name, plant.name).scale)
    for name in (one for one in simulator.composition.inputs if one not in ALWAYS):
        given = input_field(plant, name)
        found.setdefault(given, (name, unit_of_field(given, plant.name).scale))
    for name in table.names:
        # what the law asks for stands before what arrives after a delay
        if "_" in name and (answer := quantity(name)) in simulator.law.results and name not in shown_fields:
            found[name] = (f"answer.{answer}", unit_of_field(name, plant.name).scale)
    return {name: found[name] for name in table.names if name in found}
