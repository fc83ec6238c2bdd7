"""What a diagnosis of the joint leaves over a driver, as the beginning of an effect file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.errors import UsageError

if TYPE_CHECKING:
    from hjcamp.effects._begun import Begun

KNOTS = 24
# What the drivers are in its own names: expression, arguments, unit, the velocity by which a rest is known.
DRIVERS = {
    "arm_angle": ("slider_position / pulley_radius", ("slider_position", "pulley_radius"), "rad", ""),
    "arm_velocity": ("abs(slider_velocity)", ("slider_velocity",), "m/s", ""),
    "direction": ("direction", ("direction",), "1", ""),
    "pressure_sum": ("(pressure1 + pressure2)", ("pressure1", "pressure2"), "Pa", ""),
    "pressure_difference": ("(pressure1 - pressure2)", ("pressure1", "pressure2"), "Pa", ""),
    "pump_position": ("pump_position", ("pump_position",), "m", ""),
    "pump_velocity": ("pump_velocity", ("pump_velocity",), "m/s", ""),
    "time": ("time", ("time",), "s", ""),
    "time_at_rest": ("max(time - rest_began, 0.0)", ("time", "rest_began"), "s", "slider_velocity"),
}
# Its quantities: subsystem, slots of what is alike in both directions, share of it, slots of what turns with the motion.
QUANTITIES = {
    "sliding": ("joint", ("load_force",), 1.0, ("friction_static", "friction_coulomb")),
    "line_sum": ("lines", ("leak1", "leak2"), 0.5, ()),
    "line_difference": ("lines", ("cross_flow",), 0.5, ()),
}


def begun(row: Mapping[str, Any], file: Path) -> Begun:
    """Return what an effect file begins with from a row of the unknowns of a diagnosis."""
    from hjcamp.effects._begun import Begun, Table
    from hjcamp.effects._curve_template import even_steps
    from hjcamp.effects._written import plain_origin

    driver, curve = str(row["driver"]), row["curve"]
    if driver not in DRIVERS:
        raise UsageError(
            f"{file}: what is missing differs from {driver.replace('_', ' ')} to {driver.replace('_', ' ')}, which no law of the "
            "joint knows; look at what changed between the tests"
        )
    expression, arguments, unit, rests = DRIVERS[driver]
    subsystem, slots, share, turning = QUANTITIES[row["port"]]
    forward, backward = curve["forward"], curve["backward"]
    both = [
        None if a is None and b is None else share * (_mean(a, b, 1.0) if a is not None and b is not None else _one(a, b))
        for a, b in zip(forward, backward, strict=True)
    ]
    values, first, last = even_steps(curve["x"], both, KNOTS)
    said = str(row["quantity"])
    tables: list[Table] = [Table("even", slots, values, curve["y_unit"], f"{said}, the same both ways")]
    odd = [None if a is None or b is None else share * _mean(a, b, -1.0) for a, b in zip(forward, backward, strict=True)]
    if sum(value is not None for value in odd) >= 2:
        known = {"x": curve["x"], "y": odd}
        turned, _, _ = even_steps(known["x"], known["y"], KNOTS)
        # friction is counted against the motion, a missing force along it
        tables.append(
            Table("odd", turning, tuple(-value for value in turned), curve["y_unit"], f"{said}, against the motion")
            if turning
            else Table("odd", slots, turned, curve["y_unit"], f"{said}, that turns with the motion", "direction * ")
        )
    return Begun(
        "pump_joint", subsystem, driver.replace("_", " "), expression, arguments, unit, first, last, tuple(tables),
        f"the diagnosis {plain_origin(file)}", rests,
    )  # fmt: skip


def _mean(a: float, b: float, sign: float) -> float:
    return 0.5 * (a + sign * b)


def _one(a: float | None, b: float | None) -> float:
    return float(a if a is not None else b or 0.0)
