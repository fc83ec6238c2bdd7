"""Can this joint do it, and which limit stops it: pressure, sensor range, friction, stroke or envelope."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from hjcamp.errors import UsageError, shown, unknown
from hjcamp.plants.pump_joint.sizing.actuators import cylinder_area
from hjcamp.plants.pump_joint.sizing.pulley import arm_per_travel, envelope, least_tension
from hjcamp.plants.pump_joint.sizing.units import in_si

#: What a question may ask, with the unit in the name; at least one of the first three.
KEYS = ("torque_mnm", "range_deg", "diameter_mm", "pressure_mpa")
NEEDED = KEYS[:3]
UNITS = {"mnm": "mNm", "deg": "deg", "mm": "mm", "mpa": "MPa"}
LARGEST = 1e6
#: Width and height of the two joints that were built, m (thesis 3.6; both 80 mm long).
BUILT = {"first joint": (12.5e-3, 13e-3), "second joint": (16e-3, 18e-3)}


@dataclass(frozen=True)
class Question:
    """What is wanted, SI; None is not asked. ``pressure`` is the largest difference between the lines that there is."""

    torque: float | None = None
    range: float | None = None
    diameter: float | None = None
    pressure: float | None = None


@dataclass(frozen=True)
class Joint:
    """What the joint is made of, SI; string: turns, friction coefficient and tension."""

    bore: float
    stroke: float
    pitch_diameter: float
    sensor_range: float
    turns: float
    string_friction: float

    @classmethod
    def of(cls, config: Mapping[str, Mapping]) -> Joint:
        """Return the joint of a resolved configuration."""
        joint, string = config["joint"], config["joint"]["string"]
        return cls(
            bore=joint["bore_mm"] * 1e-3,
            stroke=joint["stroke_mm"] * 1e-3,
            pitch_diameter=joint["pulley_pitch_diameter_mm"] * 1e-3,
            sensor_range=config["rig"]["sensors"]["pressure_range_mpa"] * 1e6,
            turns=string["turns"],
            string_friction=string["friction_coefficient"],
        )


@dataclass(frozen=True)
class Friction:
    """Friction at the sliders in one direction, N."""

    name: str
    static: float
    coulomb: float


@dataclass(frozen=True)
class Limit:
    """One limit: what is needed and what there is, SI, and whether it stops the joint."""

    name: str
    what: str
    needed: float
    there: float
    unit: str
    stops: bool


def read_question(lines: Sequence[str]) -> Question:
    """Return the question of lines ``torque_mnm=20``.

    `UsageError` for an unknown key, a value that is no number above 0, a key given twice and a question without a limit.
    """
    values: dict[str, float] = {}
    for line in lines:
        key, equals, text = line.partition("=")
        if not equals:
            raise UsageError(f"{shown(line)}: KEY=NUMBER is needed, for example torque_mnm=20")
        if key not in KEYS:
            raise unknown("quantity", key, KEYS)
        if key in values:
            raise UsageError(f"{key} is given twice")
        values[key] = _positive(key, text)
    if not set(values) & set(NEEDED):
        raise UsageError(f"a capability needs a limit: give at least one of {', '.join(NEEDED)}, such as torque_mnm=20")
    return Question(**in_si(values))


def _positive(key: str, text: str) -> float:
    unit = UNITS[key.rpartition("_")[2]]
    try:
        value = float(text)
    except ValueError:
        raise UsageError(f"{key}={text}: a number is needed, without a unit; {unit} is in the name") from None
    if not 0.0 < value <= LARGEST:
        raise UsageError(f"{key}={text}: a number above 0 and up to {LARGEST:g} is needed")
    return value


def needed_pressure(torque: float, force: float, joint: Joint) -> float:
    """Return the pressure difference p1 - p2 = (M/r_p + F)/A_2 in Pa for a torque against a friction force."""
    return (torque / (0.5 * joint.pitch_diameter) + force) / cylinder_area(joint.bore)


def largest_torque(difference: float, force: float, joint: Joint) -> float:
    """Return the torque (p A_2 - F) r_p in N*m that a pressure difference gives; negative where friction takes more."""
    return (difference * cylinder_area(joint.bore) - force) * 0.5 * joint.pitch_diameter


def limits(question: Question, joint: Joint, friction: Friction) -> list[Limit]:
    """Return every limit that the question touches, for one friction.

    Where the pressure would do without friction, friction is what stops the joint; ``moving`` is against Coulomb friction
    (viscous left out: at rest and slow), ``from rest`` against static friction.
    """
    found = []
    if question.torque is not None:
        there, name = joint.sensor_range, "sensor range"
        if question.pressure is not None and question.pressure < there:
            there, name = question.pressure, "pressure"
        name = "friction" if needed_pressure(question.torque, 0.0, joint) <= there else name
        for what, force in (("moving", friction.coulomb), ("from rest", friction.static)):
            needed = needed_pressure(question.torque, force, joint)
            found.append(Limit(name, f"p1 - p2, {what}", needed, there, "MPa", needed > there))
    if question.range is not None:
        travel = question.range / arm_per_travel(joint.pitch_diameter)
        found.append(Limit("stroke", "travel of the sliders", travel, joint.stroke, "mm", travel > joint.stroke))
    if question.diameter is not None:
        for built, size in BUILT.items():
            tube = envelope(*size)
            found.append(Limit("envelope", f"tube around the {built}", tube, question.diameter, "mm", tube > question.diameter))
    return found


def verdict(found: Sequence[Limit]) -> str:
    """Return "yes", "only while it moves" or "no: LIMIT, LIMIT"; the smaller of the built joints decides the envelope."""
    envelopes = [one for one in found if one.name == "envelope"]
    stops = [one for one in found if one.stops and one.name != "envelope"]
    if envelopes and all(one.stops for one in envelopes):
        stops.append(envelopes[0])
    if not stops:
        return "yes"
    if all(one.what.endswith("from rest") for one in stops):
        return f"only while it moves: {stops[0].name}"
    return "no: " + ", ".join(dict.fromkeys(one.name for one in stops))


def string_tension(question: Question, joint: Joint) -> float | None:
    """Return the tension in N below which the torque asked for slips the string; None where none is asked for."""
    if question.torque is None:
        return None
    return least_tension(question.torque, joint.turns, joint.string_friction, 0.5 * joint.pitch_diameter)


def frictions_of(name: str, group: Mapping[str, Mapping[str, float]]) -> list[Friction]:
    """Return the friction of both directions of one choice of the group ``friction``; one where they are equal."""
    found = [
        Friction(f"{name}, {side}", float(group[side]["static_n"]), float(group[side]["coulomb_n"]))
        for side in ("positive", "negative")
    ]
    one, other = found
    if (one.static, one.coulomb) == (other.static, other.coulomb):
        return [Friction(name, one.static, one.coulomb)]
    return found
