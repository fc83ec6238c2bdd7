"""Marks with which a plant's equations say where an effect may act; in plain Python each is an ordinary function."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any


def slot(value: float, unit: str, text: str) -> float:
    """Return ``value`` unchanged: a quantity that an effect may add to or transform."""
    return value


def signal(value: float, unit: str, text: str) -> float:
    """Return ``value`` unchanged: a quantity that an effect may read but not change."""
    return value


def limited(value: float, low: float, high: float) -> float:
    """Return ``value`` held between ``low`` and ``high``."""
    return min(max(value, low), high)


def outside(unit: str, text: str = "outside force") -> float:
    """Return 0: a force from outside, which only effects give."""
    return 0.0


def part(function: Callable[..., Any], *given: Any, **named: Any) -> Any:
    """Return what a function of lines gives; equations, laws and effects have its lines written out in this place.

    ``NAME = part(FUNCTION, ...)`` stands alone on its line. What the function returns is called NAME, each of its other lines
    ``NAME_line``: a function that is used twice gives two sets of lines. An argument is a value, a space (``parameter``,
    ``rate``, ``memory``), or a name: with ``position=state.travel``, ``rate[position]`` is ``rate.travel``; with
    ``total="total2"``, ``memory[total]`` is ``memory.total2``. Its one return is the last line of the function.
    """
    return function(*given, **named)


# The elements: `hjcamp.model.declare.element` writes each of them out as slots and signals and makes a place (a port) of it.


def contact(
    velocity: float,
    push: float | None = None,
    coulomb: float | tuple[float, float] = 0.0,
    viscous: float | tuple[float, float] = 0.0,
    static: float | tuple[float, float] | None = None,
    travel: float | None = None,
    load: float | None = None,
    mass: float | None = None,
    dither: float | None = None,
    name: str = "",
    group: str = "",
    subsystem: str = "",
) -> float:
    """Return the friction that holds a velocity (a state) at 0 while the ``push`` is within the static friction.

    The push is the force that would keep it at rest. Leave it out, of every contact: it is found from the rates then, with what
    the other contacts hold or rub.
    A pair is the value of the positive and of the negative direction; without ``static`` the static friction is the
    Coulomb friction. ``travel`` and ``load`` are what effects may let friction depend on, ``mass`` is what it brakes: where
    it is not given, the parameter over which the rate of the velocity is. Where no load is given and several forces act on what has
    this velocity, the load is what passes through it from one to the other (`hjcamp.model.language.completion.loads_in`). ``dither``
    is what shakes it. What brakes a body is a contact also where no friction
    is known, ``contact(velocity)``: effects of friction are looked for in contacts alone.
    """
    return math.copysign(1.0, velocity) * (coulomb[0] if isinstance(coulomb, tuple) else coulomb)


def body(
    force: float, mass: float, load: float = 0.0, position: float | None = None, angle: float | None = None,
    name: str = "", group: str = "", subsystem: str = "",
) -> float:  # fmt: skip
    """Return the rate of a velocity: the whole ``force`` over the ``mass``; effects add to the slot ``load`` and to the mass.

    Without a ``load`` it has one of its own, where no contact is given its push (which would have to have that in it);
    ``load=0.0``: nothing pushes it from outside. ``position`` is where it stands, the state whose rate is its velocity alone: give it
    though nothing measures it, since springs, weights and an unbalance are looked for over it. ``angle`` is how far it is turned,
    or what it turns, where its position is no angle.
    """
    return force / mass


def store(
    inflow: float,
    capacity: float = 1.0,
    stiffness: float | None = None,
    name: str = "",
    group: str = "",
    subsystem: str = "",
) -> float:
    """Return the rate of a level: what flows in over the ``capacity``, or times the ``stiffness``; effects take a loss."""
    return inflow / capacity if stiffness is None else inflow * stiffness


def path(
    flow: float,
    upstream: float | None = None,
    downstream: float | None = None,
    name: str = "",
    group: str = "",
    subsystem: str = "",
) -> float:
    """Return a flow from one place to another, which effects may change.

    What resists or loses is one, the drop over a winding's resistance among it: its gain may then be found to change with time or with
    a state. In a line without a mark only a base parameter may be found to vary.
    """
    return flow


def line(level: float, flow: float, name: str = "", group: str = "", subsystem: str = "") -> float:
    """Return the level of a store where it acts, at the far end of what leads there; effects let the ``flow`` to there cost some."""
    return level


def actuator(command: float, supply: float | None = None, name: str = "", group: str = "", subsystem: str = "") -> float:
    """Return what a command drives: a force, a flow, a speed; effects give it a dead band, a delay, a limit."""
    return command


def transmission(
    output: float,
    torque: float | None = None,
    driven: float | None = None,
    name: str = "",
    group: str = "",
    subsystem: str = "",
) -> float:
    """Return a motion that is passed on; effects give it play, stretch, eccentricity.

    ``driven`` is where that stands which a spring or a damper behind it moves: where it is not given, the state from which
    a later line takes it (``stiffness * (NAME - state.load_angle)``).
    """
    return output


def sensor(true: float, name: str = "", group: str = "", subsystem: str = "") -> float:
    """Return what is measured; effects give it an offset, a gain, a lag, a drift."""
    return true
