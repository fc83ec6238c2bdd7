"""Plants with two dry contacts, and the same mechanics written a second time and solved by SciPy, events located."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]
Sides = tuple[int, int]

HEAD = '''"""A plant with two dry contacts."""
from hjcamp.plant import Input, Measured, Parameter, Plant, State, contact, cos, outside, body, sensor, signal, sin


'''
SPRING = (
    HEAD
    + '''class Spring(Plant):
    """Two blocks on a table, a spring between them."""

    x = State("m", typical=0.01)
    v = State("m/s", typical=0.05)
    y = State("m", typical=0.01)
    w = State("m/s", typical=0.05)
    pull = Input("N", typical=20.0)
    stiffness = Parameter("N/m", 1e3)
    mass1 = Parameter("kg", 2.0, base=True)
    mass2 = Parameter("kg", 1.0)
    dry1 = Parameter("N", 8.0, base=True)
    dry2 = Parameter("N", 5.0)
    stuck2 = Parameter("N", 7.0)
    viscous2 = Parameter("N*s/m", 3.0)
    x_m = Measured("gauge_x", of="x")
    y_m = Measured("gauge_y", of="y")

    @staticmethod
    def equations(state, parameter, drive, rate):
        spring = signal(parameter.stiffness * (state.x - state.y), "N", "force of the spring")
        load = outside("N")
        first = contact(state.v, push=drive.pull - spring + load, coulomb=parameter.dry1, travel=state.x)
        second = contact(state.w, push=spring, coulomb=parameter.dry2, static=parameter.stuck2,
                         viscous=parameter.viscous2, travel=state.y)
        rate.x = state.v
        rate.v = body(drive.pull - spring + load - first, mass=parameter.mass1, load=load, position=state.x)
        rate.y = state.w
        rate.w = (spring - second) / parameter.mass2
        gauge_x = sensor(state.x)
        gauge_y = sensor(state.y)
'''
)
PENDULUM = (
    HEAD
    + '''class Pendulum(Plant):
    """A cart on a dry rail carries a pendulum in a dry pivot; theta is 0 where it hangs."""

    x = State("m", typical=0.1)
    v = State("m/s", typical=0.2)
    theta = State("rad", typical=0.5)
    omega = State("rad/s", typical=2.0)
    force = Input("N", typical=5.0)
    cart = Parameter("kg", 1.0, base=True)
    bob = Parameter("kg", 0.5)
    length = Parameter("m", 0.3)
    gravity = Parameter("m/s^2", 9.81)
    dry_rail = Parameter("N", 1.5, base=True)
    dry_pivot = Parameter("N*m", 0.05, base=True)
    x_m = Measured("gauge", of="x")
    theta_deg = Measured("encoder", of="theta")

    @staticmethod
    def equations(state, parameter, drive, rate):
        whole = parameter.cart + parameter.bob
        inertia = parameter.bob * parameter.length * parameter.length
        between = parameter.bob * parameter.length * cos(state.theta)
        along = drive.force + parameter.bob * parameter.length * state.omega * state.omega * sin(state.theta)
        about = -parameter.bob * parameter.gravity * parameter.length * sin(state.theta)
        # what one contact feels of the other's motion: all that it does while that one moves, nothing while it is held
        swinging = 1.0 if drive.direction_pivot != 0.0 else 0.0
        driving = 1.0 if drive.direction_rail != 0.0 else 0.0
        swung = about - drive.direction_pivot * parameter.dry_pivot
        driven = along - drive.direction_rail * parameter.dry_rail
        rail = contact(state.v, push=along - swinging * between / inertia * swung, coulomb=parameter.dry_rail)
        pivot = contact(state.omega, push=about - driving * between / whole * driven, coulomb=parameter.dry_pivot)
        both = whole * inertia - swinging * driving * between * between
        rate.x = state.v
        rate.v = (inertia * (along - rail) - swinging * between * (about - pivot)) / both
        rate.theta = state.omega
        rate.omega = (whole * (about - pivot) - driving * between * (along - rail)) / both
        gauge = sensor(state.x)
        encoder = sensor(state.theta)
'''
)
STACK = (
    HEAD
    + '''class Stack(Plant):
    """A block lies on a sledge that lies on a table; slip is the block's speed on the sledge."""

    v = State("m/s", typical=0.2)
    slip = State("m/s", typical=0.2)
    x = State("m", typical=0.1)
    pull = Input("N", typical=5.0)
    sledge = Parameter("kg", 2.0, base=True)
    block = Parameter("kg", 1.0)
    dry_table = Parameter("N", 3.0, base=True)
    dry_block = Parameter("N", 5.0, base=True)
    x_m = Measured("gauge", of="x")

    @staticmethod
    def equations(state, parameter, drive, rate):
        moving = 1.0 if drive.direction_table != 0.0 else 0.0
        slipping = 1.0 if drive.direction_block != 0.0 else 0.0
        # the force between the two that keeps them together, with the sledge held or dragged
        together = (drive.pull * parameter.sledge + moving * drive.direction_table * parameter.dry_table * parameter.block) / (
            parameter.sledge + parameter.block)
        needed = drive.pull if moving == 0.0 else together
        block = contact(state.slip, push=needed, coulomb=parameter.dry_block)
        passed = block if slipping > 0.0 else needed
        table = contact(state.v, push=passed, coulomb=parameter.dry_table)
        speeding = (passed - table) / parameter.sledge if moving > 0.0 else 0.0
        rate.v = speeding
        rate.slip = (drive.pull - passed) / parameter.block - speeding
        rate.x = state.v
        gauge = sensor(state.x)
'''
)
# The same as a user would write them: what the contacts hold is found from the rates.
FREE_SPRING = SPRING.replace("class Spring", "class FreeSpring")
FREE_SPRING = FREE_SPRING.replace("push=drive.pull - spring + load, ", "").replace("push=spring, ", "")
FREE_PENDULUM = (
    PENDULUM.split("        # what one contact")[0].replace("class Pendulum", "class FreePendulum")
    + """        rail = contact(state.v, coulomb=parameter.dry_rail)
        pivot = contact(state.omega, coulomb=parameter.dry_pivot)
        both = whole * inertia - between * between
        rate.x = state.v
        rate.v = (inertia * (along - rail) - between * (about - pivot)) / both
        rate.theta = state.omega
        rate.omega = (whole * (about - pivot) - between * (along - rail)) / both
        gauge = sensor(state.x)
        encoder = sensor(state.theta)
"""
)
FREE_STACK = (
    STACK.split("        moving =")[0].replace("class Stack", "class FreeStack")
    + """        block = contact(state.slip, coulomb=parameter.dry_block)
        table = contact(state.v, coulomb=parameter.dry_table)
        rate.v = (block - table) / parameter.sledge
        rate.slip = (drive.pull - block) / parameter.block - (block - table) / parameter.sledge
        rate.x = state.v
        gauge = sensor(state.x)
"""
)


@dataclass
class Dry:
    """Two contacts of a mechanism: ``accelerations`` and ``pushes`` of (z, input, sides), limits at rest, places of both
    velocities in z.

    Steps from sample to sample and stops at each release, rest and reversal.
    """

    accelerations: Callable[[Array, float, Sides], Array]
    pushes: Callable[[Array, float, Sides], tuple[float, float]]
    limits: tuple[float, float]
    at: tuple[int, int]
    z: Array
    sides: Sides = (0, 0)
    events: list[tuple[float, Sides]] = field(default_factory=list)

    def settle(self, time: float, force: float) -> None:
        """Release whatever is pushed over its limit."""
        for _ in range(2):
            for k in (0, 1):
                push = self.pushes(self.z, force, self.sides)[k]
                if self.sides[k] == 0 and abs(push) > self.limits[k]:
                    self.turn(time, k, int(math.copysign(1, push)))

    def turn(self, time: float, k: int, side: int) -> None:
        """Set the side of one contact."""
        self.sides = (side, self.sides[1]) if k == 0 else (self.sides[0], side)
        self.events.append((time, self.sides))

    def step(self, time: float, span: float, force: float) -> None:
        """Go on by ``span`` under a constant input."""
        end = time + span
        self.settle(time, force)
        while time < end:
            sides = self.sides
            ends = []
            for k in (0, 1):
                if sides[k]:
                    ends.append(lambda _, z, k=k, side=sides[k]: z[self.at[k]] * side + 1e-13)
                else:
                    ends.append(lambda _, z, k=k, on=sides: self.limits[k] - abs(self.pushes(z, force, on)[k]) + 1e-10)
                ends[-1].terminal, ends[-1].direction = True, -1  # type: ignore[attr-defined]
            found = solve_ivp(
                lambda _, z, on=sides: self.accelerations(z, force, on), (time, end), self.z, "DOP853", events=ends,
                rtol=1e-10, atol=1e-12,
            )  # fmt: skip
            self.z, time = found.y[:, -1].copy(), float(found.t[-1])
            for k, crossed in enumerate(found.t_events):
                if len(crossed) and sides[k]:
                    self.z[self.at[k]] = 0.0
                    self.turn(time, k, 0)
            if found.status == 1:
                self.settle(time, force)


def spring(z: Array) -> Dry:
    """Return the two blocks: 2 and 1 kg, 1000 N/m, Coulomb friction 8 and 5 N, static friction 8 and 7 N."""

    def accelerations(z: Array, pull: float, sides: Sides) -> Array:
        force = 1e3 * (z[0] - z[2])
        first = (pull - force - 8.0 * sides[0]) / 2.0 if sides[0] else 0.0
        second = (force - 5.0 * sides[1] - 3.0 * z[3]) / 1.0 if sides[1] else 0.0
        return np.array([z[1], first, z[3], second])

    def pushes(z: Array, pull: float, sides: Sides) -> tuple[float, float]:
        force = 1e3 * (z[0] - z[2])
        return pull - force, force

    return Dry(accelerations, pushes, (8.0, 7.0), (1, 3), z)


def pendulum(z: Array) -> Dry:
    """Return the cart of 1 kg with a bob of 0.5 kg on 0.3 m; 1.5 N at the rail, 0.05 N m in the pivot."""
    matrix = np.array([[1.5, 0.0], [0.0, 0.5 * 0.09]])

    def torques(z: Array, force: float) -> Array:
        return np.array([force + 0.15 * z[3] ** 2 * math.sin(z[2]), -0.15 * 9.81 * math.sin(z[2])])

    def solved(z: Array, force: float, sides: Sides, moving: list[int]) -> Array:
        """Return both accelerations where only the contacts ``moving`` do."""
        full = matrix.copy()
        full[0, 1] = full[1, 0] = 0.15 * math.cos(z[2])
        rest = torques(z, force) - np.array([1.5, 0.05]) * sides
        found = np.zeros(2)
        if moving:
            found[moving] = np.linalg.solve(full[np.ix_(moving, moving)], rest[moving])
        return found

    def accelerations(z: Array, force: float, sides: Sides) -> Array:
        found = solved(z, force, sides, [k for k in (0, 1) if sides[k]])
        return np.array([z[1], found[0], z[3], found[1]])

    def pushes(z: Array, force: float, sides: Sides) -> tuple[float, float]:
        other = 0.15 * math.cos(z[2])
        values = []
        for k in (0, 1):
            moving = [1 - k] if sides[1 - k] else []
            still = (0, sides[1]) if k == 0 else (sides[0], 0)
            values.append(float(torques(z, force)[k] - other * solved(z, force, still, moving)[1 - k]))
        return values[0], values[1]

    return Dry(accelerations, pushes, (1.5, 0.05), (1, 3), z)
