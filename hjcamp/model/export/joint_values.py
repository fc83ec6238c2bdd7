r"""The values with which a joint and its actuators move as a body of a plant does, and what no such values express.

.. math:: M \dot v + d\,v + f\,\mathrm{sign}\,v + k\,q = c + \sum_i g_i\,a_i, \quad \tau_i \dot a_i = u_i - a_i

They are found from the composed model itself: its forces at random states and inputs are regressed on the terms of this law, which
leaves rounding alone where the model is such a joint. Source: MuJoCo, Computation, https://mujoco.readthedocs.io/en/stable/computation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import UsageError
from hjcamp.model.checks.place_checks import PlainModel
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.plant import Plant
from hjcamp.model.declare.port import Port
from hjcamp.model.export.python_file import Exported
from hjcamp.model.language.vocabulary import read_vocabulary

Array = NDArray[np.float64]
# Places at which forces are compared, how far each quantity goes (usual sizes), and the longest time (s).
PLACES, REACH, LONGEST = 160, 1.5, 100.0
# Of the largest force: what is less is rounding.
ROUNDING = 1e-8
KINDS = {"m/s": "slide", "rad/s": "hinge", "1/s": "hinge"}


@dataclass(frozen=True)
class Drive:
    """What one input does: ``gain`` is the force for one unit of it, behind a lag of ``lag`` s (0 without)."""

    given: str
    gain: float
    lag: float = 0.0


@dataclass(frozen=True)
class Joint:
    """The joint of a body, SI: ``inertia`` M, ``damping`` d, ``frictionloss`` f, ``stiffness`` k, ``offset`` c, and its drives."""

    name: str
    kind: str
    velocity: str
    position: str
    inertia: float
    damping: float
    frictionloss: float
    stiffness: float
    offset: float
    drives: tuple[Drive, ...]


@dataclass(frozen=True)
class Mapped:
    """The joints of a model, the sensors that read them (name -> joint, whether its speed), and sentences on what is ``lost``."""

    joints: tuple[Joint, ...]
    readings: dict[str, tuple[str, bool]]
    lost: tuple[str, ...]


@dataclass(frozen=True)
class Law:
    """A quantity regressed on columns: coefficients by column, and what they leave of it at each place."""

    terms: dict[str, float]
    left: Array
    size: float

    def of(self, name: str) -> float:
        """Return a coefficient, 0 where it is rounding."""
        return self.terms.get(name, 0.0)

    @property
    def exact(self) -> bool:
        """Whether it is no more than these columns."""
        return bool(np.abs(self.left).max() <= ROUNDING * self.size)


@dataclass
class Probe:
    """A composed model at random places of its usual range, a contact sliding at each."""

    exported: Exported
    effects: tuple[type[Effect], ...]
    columns: dict[str, Array] = field(init=False)

    def __post_init__(self) -> None:
        plant, chance = self.plant, np.random.default_rng(1)
        swung = {name: (plant.inputs[name].typical, plant.inputs[name].default) for name in self.inputs}
        sizes = {**{name: (one.typical, 0.0) for name, one in plant.states.items()}, **swung}
        self.columns = {
            name: middle + REACH * size * chance.uniform(-1.0, 1.0, PLACES) for name, (size, middle) in sizes.items()
        }
        for name, one in plant.states.items():
            self.columns[name] = np.maximum(self.columns[name], one.low)
        time = chance.uniform(0.0, LONGEST, PLACES)
        own = np.random.default_rng(2)
        for name in self.model.composition.states:
            if name not in self.columns:
                self.columns[name] = self.model.composition.states[name].typical * own.uniform(-1.0, 1.0, PLACES)
        sides = {port.names["direction"]: np.sign(self.columns[port.names["velocity"]]) for port in self.contacts}
        self.rows: list[dict[str, float]] = [
            {name: float(one[k]) for name, one in {**self.columns, **sides, "time": time}.items()} for k in range(PLACES)
        ]
        self.columns |= {**sides, "1": np.ones(PLACES)}

    @property
    def plant(self) -> type[Plant]:
        """The plant."""
        return self.exported.composition.plant

    @cached_property
    def model(self) -> PlainModel:
        """The model, each effect with the values that it is exported with."""
        return PlainModel(self.plant, self.effects, self.exported.values)

    @cached_property
    def contacts(self) -> list[Port]:
        """The contacts."""
        return [port for port in read_vocabulary(self.plant).ports.values() if port.kind == "contact"]

    @cached_property
    def inputs(self) -> list[str]:
        """What someone gives, and the rates of that."""
        given = {*self.plant.given_inputs(), *self.plant.rates_of_inputs()}
        return [name for name in self.plant.inputs if name in given]

    @cached_property
    def _seen(self) -> tuple[list[dict[str, float]], list[dict[str, float]]]:
        return [self.model.rates(row) for row in self.rows], [self.model.signals(row) for row in self.rows]

    def rate(self, state: str) -> Array:
        """Return the rate of a state at each place."""
        return np.array([row[state] for row in self._seen[0]])

    def signal(self, name: str) -> Array:
        """Return a signal, or a parameter, at each place."""
        known = self.exported.parameters
        return np.array([row[name] if name in row else known[name] for row in self._seen[1]])

    def law(self, values: Array, names: Sequence[str]) -> Law:
        """Regress values on columns, each in its own size."""
        sizes = np.array([np.abs(self.columns[name]).max() or 1.0 for name in names])
        matrix = np.stack([self.columns[name] for name in names], axis=1) / sizes
        found = np.linalg.lstsq(matrix, values, rcond=None)[0]
        size = max(float(np.abs(values).max()), float(np.abs(found).max()))
        found[np.abs(found) <= ROUNDING * size] = 0.0
        return Law(dict(zip(names, (found / sizes).tolist(), strict=True)), values - matrix @ found, size)


@dataclass(frozen=True)
class Body:
    """A body of a plant with its laws: ``force`` on states, inputs, and the side of its contact; ``friction`` of that alone."""

    port: Port
    position: str
    inertia: float
    force: Law
    friction: Law | None
    breakaway: float
    side: str
    left: Array

    @property
    def velocity(self) -> str:
        """The state that is its speed."""
        return self.port.names["velocity"]


def bodies_of(probe: Probe) -> list[Body]:
    """Return the bodies that move as slides or hinges do, with the laws of their forces."""
    states = probe.model.composition.states
    ports = [one for one in read_vocabulary(probe.plant).ports.values() if one.kind == "body" and "mass" in one.names]
    moved = [one for one in ports if one.names.get("velocity") in states and states[one.names["velocity"]].unit in KINDS]
    return [_body(probe, port) for port in moved]


def _body(probe: Probe, port: Port) -> Body:
    velocity = port.names["velocity"]
    position = next((name for name in probe.plant.states if np.array_equal(probe.rate(name), probe.columns[velocity])), "")
    mass = probe.signal(port.names["mass"])
    inertia = float(np.median(mass))
    contact = next((one for one in probe.contacts if one.names["velocity"] == velocity), None)
    side = contact.names["direction"] if contact else ""
    force = probe.law(
        mass * probe.rate(velocity), [*probe.inputs, *probe.model.composition.states, *([side] if side else []), "1"]
    )
    friction, breakaway = None, 0.0
    if contact:
        friction = probe.law(probe.signal(contact.names["friction"]), [velocity, side])
        still = probe.model.signals({**probe.rows[0], velocity: 0.0, side: 0.0})
        breakaway = still[contact.names["static"]]
    left = [force.left, mass - inertia, *([friction.left] if friction else [])]
    return Body(port, position, inertia, force, friction, breakaway, side, np.concatenate(left))


def mapped(exported: Exported) -> Mapped:
    """Return the joints of a model; effects that no joint has are left out, and said.

    Raises ``UsageError`` where the plant has no body, bodies push each other, or a state pushes one that is no lag of an input.
    """
    plant = exported.composition.plant
    probe, lost = Probe(exported, ()), []
    bodies = bodies_of(probe)
    if not bodies:
        raise UsageError(
            f"plant {plant.name}: no state in m/s or rad/s is a body(...) of its equations, and a joint of MuJoCo is one; "
            "--as python or fmu takes every plant along"
        )
    for effect in exported.composition.effects:
        tried = Probe(exported, (*probe.effects, effect))
        try:
            moved = bodies_of(tried)
            _joints(tried, moved)
        except UsageError:
            moved = []
        if moved and _is_of_a_joint(bodies, moved):
            probe, bodies = tried, moved
        else:
            lost.append(f"effect {effect.name}: no value of a joint is such a law{_size_of(probe, tried)}")
    joints = _joints(probe, bodies)
    for one, body in zip(joints, bodies, strict=True):
        lost += _own_losses(one, body)
    readings, unread = _readings(probe, bodies, joints)
    lost += [f"reading '{name}': it is no position or speed of a joint" for name in unread]
    lost += [f"a limit: {value} stays within {low} and {high}" for value, low, high in read_vocabulary(plant).limits]
    lost += [f"input '{name}' acts {late:.4g} s later than it is given" for name, late in exported.delays.items() if late]
    return Mapped(tuple(joints), readings, tuple(lost))


def _is_of_a_joint(before: Sequence[Body], after: Sequence[Body]) -> bool:
    """Whether an effect changes a value of a joint, and nothing else of the forces."""
    changed = False
    for one, other in zip(before, after, strict=True):
        size = max(one.force.size, other.force.size)
        if np.abs(one.left - other.left).max() > 10.0 * ROUNDING * size:
            return False
        ours, theirs = (np.array([x.inertia, *(x.force.of(name) for name in other.force.terms)]) for x in (one, other))
        changed |= not np.allclose(ours, theirs, rtol=1e-6, atol=0.0)
    return changed


def _size_of(probe: Probe, tried: Probe) -> str:
    """Return in words how much force an effect makes in the usual range."""
    most = []
    for one, other in zip(bodies_of(probe), bodies_of(tried), strict=False):
        unit = "N" if KINDS[probe.plant.states[one.velocity].unit] == "slide" else "N m"
        apart = np.abs(other.inertia * tried.rate(one.velocity) - one.inertia * probe.rate(one.velocity)).max()
        most += [f"up to {apart:.3g} {unit} on '{one.velocity}'"] if apart > ROUNDING * one.force.size else []
    return f" ({', '.join(most)} in the usual range)" if most else ""


def _joints(probe: Probe, bodies: Sequence[Body]) -> list[Joint]:
    found = []
    for one in bodies:
        own = {one.velocity, one.position}
        lags = {
            name: _lag(probe, name, one) for name in probe.model.composition.states if name not in own and one.force.of(name)
        }
        inputs = [name for name in probe.inputs if one.force.of(name)]
        found.append(
            Joint(
                one.position or one.velocity,
                KINDS[probe.plant.states[one.velocity].unit],
                one.velocity,
                one.position,
                one.inertia,
                0.0 - one.force.of(one.velocity),
                max(-one.force.of(one.side), 0.0),
                0.0 - one.force.of(one.position),
                one.force.of("1"),
                (*(Drive(name, one.force.of(name)) for name in inputs), *lags.values()),
            )
        )
    return found


def _lag(probe: Probe, state: str, body: Body) -> Drive:
    """Return the drive of a state that follows one input with a lag; raises ``UsageError`` for any other."""
    law = probe.law(probe.rate(state), [*probe.inputs, *probe.model.composition.states, "1"])
    terms = [name for name, value in law.terms.items() if value and name != state]
    if law.exact and law.of(state) < 0.0 and len(terms) == 1 and terms[0] in probe.inputs:
        lag = -1.0 / law.of(state)
        return Drive(terms[0], body.force.of(state) * law.of(terms[0]) * lag, lag)
    raise UsageError(
        f"plant {probe.plant.name}: state '{state}' pushes body '{body.velocity}' and is no lag of one input; "
        "the joints of MuJoCo have position and speed alone (--as python or fmu takes every state along)"
    )


def _own_losses(joint: Joint, body: Body) -> list[str]:
    """Return sentences on what the plant's own equations have beyond the joint."""
    unit, lost = "N" if joint.kind == "slide" else "N m", []
    if not body.force.exact:
        share = np.abs(body.force.left).max() / body.force.size
        lost.append(
            f"joint '{joint.name}': its equations are no straight law: forces are off by up to "
            f"{np.abs(body.force.left).max():.3g} {unit} ({100.0 * share:.2g} % of the largest)"
        )
    if body.friction and not (body.friction.exact and body.force.of(body.side) <= 0.0):
        lost.append(f"joint '{joint.name}': its friction depends on more than speed and its sign")
    if body.breakaway > joint.frictionloss * (1.0 + 1e-6):
        lost.append(
            f"joint '{joint.name}': it breaks away at {body.breakaway:.4g} {unit} and slides at {joint.frictionloss:.4g}: "
            "frictionloss is one level"
        )
    return lost


def _readings(probe: Probe, bodies: Sequence[Body], joints: Sequence[Joint]) -> tuple[dict[str, tuple[str, bool]], list[str]]:
    """Return the sensors that read a joint, and the names of the others."""
    composition, found = probe.exported.composition, {}
    for signal in composition.measured:
        seen = probe.signal(signal)
        for body, joint in zip(bodies, joints, strict=True):
            for state, speed in ((body.position, False), (body.velocity, True)):
                if state and np.array_equal(seen, probe.columns[state]):
                    found[signal] = joint.name, speed
    return found, [name for name in composition.measured if name not in found]
