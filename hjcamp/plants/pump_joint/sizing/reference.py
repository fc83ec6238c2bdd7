"""The formulas of chapter 3 evaluated next to what the thesis prints."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hjcamp.plants.pump_joint.sizing import actuators, dynamics, linkage, muscle, pulley, tubing
from hjcamp.plants.pump_joint.sizing.units import SHOWN, in_si
from hjcamp.yaml_file import read_yaml

QUANTITIES = Path(__file__).with_name("chapter3.yaml")


@dataclass(frozen=True)
class Quantity:
    """One row: ``value`` in ``unit``, and the text of the print; ``relation`` is "=", ">" or "measured"."""

    part: str
    name: str
    value: float
    unit: str
    printed: str | None
    relation: str
    place: str
    inferred: str = ""

    def agrees(self) -> bool | None:
        """Return whether the value is the printed one to its digits; None where nothing is printed or it was measured."""
        if self.printed is None or self.relation == "measured":
            return None
        printed = float(self.printed)
        if self.relation == ">":
            return self.value > printed
        return abs(self.value - printed) <= 0.5 * 10.0 ** -decimals(self.printed) * (1.0 + 1e-9)


def decimals(printed: str) -> int:
    """Return the number of decimals of a printed number."""
    return len(printed.partition(".")[2])


def six_bar_rod(start: float, crank: float, offset: float) -> float:
    """Return the rod that closes the loop at rest, m. Source: thesis 3.5 (lengths)."""
    return math.hypot(start, crank - offset)


def six_bar_range(rod: float, crank: float, offset: float, start: float) -> float:
    """Return the short side of the range in which the pressure angle stays within 45 deg, rad."""
    return min(abs(end) for end in linkage.SixBar(rod, crank, offset, start).usable_range())


def six_bar_slope(rod: float, crank: float, offset: float, start: float) -> float:
    """Return dtheta/dx at rest, rad/m."""
    return 1.0 / float(linkage.SixBar(rod, crank, offset, start).lever(np.zeros(())))


def muscle_crossing(length: float, largest_diameter: float, membrane: float, bore: float, thread: float) -> float:
    """Return the contraction at which a muscle pulls as hard as a cylinder, m."""
    from scipy.optimize import brentq

    one = muscle.Muscle(length, thread, largest_diameter / math.sin(muscle.FREE_ANGLE), membrane)
    area = actuators.cylinder_area(bore)
    return float(brentq(lambda x: float(one.area(np.array(x))) - area, 0.0, one.longest_contraction()))


def bore_ratio(pump_bore: float, other_bore: float) -> float:
    """Return how many times the water of another pump a pump moves for the same angle. Source: thesis 3.8."""
    return (pump_bore / other_bore) ** 2


def pump_inertance_drop(acceleration: float, pump_bore: float, inner_diameter: float, length: float, density: float) -> float:
    """Return rho L a, Pa, of the water that a pump's acceleration drives through the tubing. Source: thesis 4.4.2."""
    return tubing.inertance_drop(tubing.tubing_speed(acceleration, pump_bore, inner_diameter), length, density)


FORMULAS: Mapping[str, Callable[..., float]] = {
    function.__name__: function
    for function in (
        actuators.cylinder_area, actuators.double_vane_area, actuators.area_ratio, actuators.cylinder_seal,
        actuators.double_vane_seal, actuators.seal_ratio, actuators.vane_torque, actuators.plate_torque,
        actuators.torque_per_pressure, actuators.cylinder_force, actuators.throttle_loss, muscle_crossing,
        linkage.mobility, six_bar_rod, six_bar_range, six_bar_slope,
        pulley.turn_angle, pulley.least_tension, pulley.arm_per_travel, pulley.arm_per_rack_travel, pulley.envelope,
        pulley.encoder_step, pulley.pump_volume, pulley.motor_per_arm, bore_ratio, dynamics.rise_time,
        tubing.tubing_speed, tubing.reynolds_number, tubing.resistance_drop, pump_inertance_drop, tubing.tubing_modulus,
    )
}  # fmt: skip


def quantities() -> list[Quantity]:
    """Return every quantity of chapter3.yaml, evaluated."""
    found = []
    for part, rows in read_yaml(QUANTITIES).items():
        for row in rows:
            value = FORMULAS[row["formula"]](**in_si(row["inputs"])) / SHOWN[row["unit"]]
            relation = next((sign for key, sign in RELATIONS.items() if key in row), "=")
            printed = next((str(row[key]) for key in ("printed", *RELATIONS) if key in row), None)
            more = str(row.get("inferred", ""))
            found.append(Quantity(part, row["quantity"], value, row["unit"], printed, relation, str(row["place"]), more))
    return found


RELATIONS = {"more_than": ">", "measured": "measured"}
