"""Dry contact between two bodies, in four kinds, for the machines of this package (the pump joint has its own).

`sharp`: force set-valued at rest; `smooth`: F tanh(v/v_0), which never sticks; `lugre`: one bristle; `maxwell`: several
spring-slider elements. Each takes its strength in both directions from outside, so that laws of speed or place are shared.
"""

import math

import numpy as np
from numba import njit

CONTACTS = ("sharp", "smooth", "lugre", "maxwell")
# Elements of equal strength that yield at growing travel, in multiples of the `bend`.
YIELD = np.array([0.2, 0.5, 0.8, 1.2, 1.6, 2.4])
BRISTLE_DAMPING = 0.2


@njit
def smooth_speed(
    speed: float, force: float, upper: float, lower: float, viscous: float, mass: float, grain: float, step: float
) -> float:
    """Return the speed after a step under a friction F tanh(v/v_0), which never sticks; `grain` is v_0 (m/s).

    Backward Euler; what it solves grows with the speed: Newton's steps, and half the interval where one leaves it.
    """
    share = step / mass
    low = (speed + share * (force - upper)) / (1 + share * viscous)
    high = (speed + share * (force + lower)) / (1 + share * viscous)
    found = min(max(speed, low), high)
    for _ in range(100):
        strength, bend = upper if found > 0 else lower, math.tanh(found / grain)
        error = found * (1 + share * viscous) - speed - share * (force - strength * bend)
        if error > 0:
            high = found
        else:
            low = found
        then = found - error / (1 + share * (viscous + strength / grain * (1 - bend * bend)))
        if not low < then < high:
            then = 0.5 * (low + high)
        if abs(then - found) <= 1e-15 * (abs(then) + grain):
            return then
        found = then
    return found


@njit
def contact_step(
    law: int,
    speed: float,
    force: float,
    mass: float,
    upper: float,
    lower: float,
    viscous: float,
    grain: float,
    stretch: np.ndarray,
    step: float,
) -> tuple[float, float]:
    """Return the speed after a step and the dry friction in it; `stretch` (6,) holds the contact's own state.

    `upper` and `lower` are the strengths (N or N m, both positive) against motion in either direction at this speed,
    `grain` is the speed of `smooth` (m/s) or the travel to full slip of `lugre` and `maxwell` (m). `sharp`: implicit
    in the friction's impulse, so that rest is exact (Moreau 1988, Unilateral contact and dry friction). `lugre`:
    z' = v - k |v| z / F with damping on z', doi:10.1109/9.376053. `maxwell`: Iwan 1966, doi:10.1115/1.3625199.
    """
    share = step / mass
    if law == 1:
        found = smooth_speed(speed, force, upper, lower, viscous, mass, grain, step)
        return found, (upper if found > 0 else lower) * math.tanh(found / grain)
    if law == 2:
        strength = upper if speed > 0 else lower
        stiffness = 0.5 * (upper + lower) / grain
        before = stretch[0]
        stretch[0] = (before + step * speed) / (1 + step * stiffness * abs(speed) / strength)
        damping = 2 * BRISTLE_DAMPING * math.sqrt(stiffness * mass)
        friction = stiffness * stretch[0] + damping * (stretch[0] - before) / step
        return (speed + share * (force - friction)) / (1 + share * viscous), friction
    if law == 3:
        friction, held = 0.0, 0.0
        count = YIELD.shape[0]
        for index in range(count):
            stiffness = 0.5 * (upper + lower) / count / (grain * YIELD[index])
            before = stretch[index]
            top, bottom = upper / count / stiffness, -lower / count / stiffness
            stretch[index] = min(max(before + step * speed, bottom), top)
            friction += stiffness * stretch[index]
            if bottom < stretch[index] < top:
                held += stiffness
        damping = viscous + 2 * BRISTLE_DAMPING * math.sqrt(held * mass)
        return (speed + share * (force - friction)) / (1 + share * damping), friction
    free = (speed + share * force) / (1 + share * viscous)
    top, bottom = share * upper / (1 + share * viscous), -share * lower / (1 + share * viscous)
    impulse = min(max(free, bottom), top)
    return free - impulse, impulse * (1 + share * viscous) / share


@njit
def falling(excess: float, fall_speed: float, speed: float, form: float) -> float:
    """Return the friction above Coulomb friction at a speed: form 0 e exp(-(v/v_s)^2), form 1 e / (1 + (v/v_s)^2).

    Form 1: Hess and Soom 1990, doi:10.1115/1.2920239.
    """
    if excess == 0.0:
        return 0.0
    square = (speed / fall_speed) ** 2
    return excess * math.exp(-square) if form == 0.0 else excess / (1 + square)
