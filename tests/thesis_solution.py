"""Chapter 4 written a second time, from the text and not from the plant, and solved by SciPy with its events located.

It shares no code with the package: other states (volumes instead of pressures), other solver, other event search.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import exp, pi, sin, sqrt

import numpy as np
from scipy.integrate import solve_ivp

DEGREE = pi / 180
ATMOSPHERE = 101325.0
X, V, A, Q1, Q2, Y, W, LAG = range(8)


@dataclass(frozen=True)
class Physics:
    """Constants of chapter 4 in SI units, and those of the effects (0: absent)."""

    numerator: float = 6125e-3 / DEGREE  # m/rad/s^3 (4.3.4)
    a2: float = 245.0
    a1: float = 35700.0
    a0: float = 2205000.0
    speed_limit: float = 0.060  # (4.3.5)
    area1: float = pi * 6.35e-3**2 / 4
    area2: float = pi * 4e-3**2 / 4
    stiffness: float = 0.0257e15  # Pa/m^3 (4.4.3)
    noise_floor: float = -0.099e6
    radius: float = 6.82e-3 / 2
    mass: float = 0.0185
    static: tuple[float, float] = (7.20, 4.03)  # positive, negative (4.5.1.3, 4.5.1.4)
    coulomb: tuple[float, float] = (5.27, 2.97)
    viscous: tuple[float, float] = (23.5, 17.2)
    air: float = 0.0  # m^3 at one atmosphere in each line
    leak: float = 0.0
    leak_above: float = 0.0
    threshold: float = 0.59e6
    stribeck: float = 0.0  # m/s
    inertance: float = 0.0  # kg/m^4
    payload: float = 0.0  # kg at `arm`, moves with the arm
    weight: float = 0.0  # kg at `arm`, vertical joint
    arm: float = 0.02
    lag: float = 0.0  # s

    @property
    def effective_mass(self) -> float:
        """Everything that moves, at the sliders (4.5.2.1)."""
        return self.mass + self.payload * (self.arm / self.radius) ** 2 + 2 * self.inertance * self.area2**2

    def pressure(self, volume: float) -> float:
        """Return the gauge pressure of a line that holds ``volume`` more than at zero gauge, never below the floor."""
        if self.air == 0.0:
            return max(volume * self.stiffness, self.noise_floor)
        # volume = p / K + V_a p / (p + p_atm): a quadratic in the absolute pressure
        b = self.stiffness * (volume - self.air) + ATMOSPHERE
        absolute = 0.5 * (b + sqrt(b * b + 4 * self.stiffness * self.air * ATMOSPHERE))
        return max(absolute - ATMOSPHERE, self.noise_floor)

    def volume(self, pressure: float) -> float:
        """Return what a line holds more than at zero gauge, at the gauge ``pressure``."""
        return pressure / self.stiffness + self.air * pressure / (pressure + ATMOSPHERE)

    def push(self, z: np.ndarray) -> float:
        """Return the force on the sliders without friction (4.4.3.16)."""
        force = (self.pressure(z[Q1]) - self.pressure(z[Q2])) * self.area2
        return force - self.weight * 9.81 * self.arm / self.radius * sin(z[Y] / self.radius)

    def holds(self, push: float) -> float:
        """Return the static friction against ``push``."""
        return self.static[0] if push > 0 else self.static[1]

    def friction(self, speed: float, direction: int) -> float:
        """Return the sliding friction (4.5.1.2)."""
        side = 0 if direction > 0 else 1
        dry = self.coulomb[side]
        if self.stribeck > 0:
            dry += (self.static[side] - dry) * exp(-((speed / self.stribeck) ** 2))
        return direction * dry + self.viscous[side] * speed

    def loss(self, pressure: float) -> float:
        """Return the flow out of a line."""
        return self.leak * pressure + self.leak_above * max(pressure - self.threshold, 0.0)

    def rate(self, z: np.ndarray, command: float, direction: int) -> list[float]:
        """Return the rate of all states; ``direction`` 0 is the held arm."""
        speed = min(max(z[V], -self.speed_limit), self.speed_limit)
        net = self.area1 * speed - self.area2 * z[W]
        acceleration = 0.0
        if direction:
            acceleration = (self.push(z) - self.friction(z[W], direction)) / self.effective_mass
        return [
            speed,
            z[A],
            self.numerator * command - self.a2 * z[A] - self.a1 * z[V] - self.a0 * z[X],
            net - self.loss(self.pressure(z[Q1])),
            -net - self.loss(self.pressure(z[Q2])),
            z[W],
            acceleration,
            (z[Y] / self.radius - z[LAG]) / self.lag if self.lag else 0.0,
        ]


@dataclass
class Arm:
    """The moving solution: its state, its regime, and the instants at which stick or slip began."""

    physics: Physics
    state: np.ndarray
    direction: int = 0
    events: list[float] = field(default_factory=list)
    method: str = "LSODA"
    rtol: float = 1e-10
    max_step: float = np.inf
    sides: list[float] = field(default_factory=list)

    @classmethod
    def at_rest(cls, physics: Physics, pressure1: float, pressure2: float, **options: object) -> Arm:
        """Start with the arm at 0 deg and the lines at the given gauge pressures, Pa."""
        state = np.zeros(8)
        state[Q1], state[Q2] = physics.volume(pressure1), physics.volume(pressure2)
        return cls(physics, state, **options)  # type: ignore[arg-type]

    def _boundaries(self) -> list[Callable[..., float]]:
        physics, direction = self.physics, self.direction
        crossings: list[Callable[..., float]] = [
            lambda _t, z: z[V] - physics.speed_limit,
            lambda _t, z: z[V] + physics.speed_limit,
            lambda _t, z: (z[Q1] - physics.volume(physics.noise_floor)) * 1e9,
            lambda _t, z: (z[Q2] - physics.volume(physics.noise_floor)) * 1e9,
        ]
        if physics.leak_above:
            opens = physics.volume(physics.threshold)
            crossings += [lambda _t, z: (z[Q1] - opens) * 1e9, lambda _t, z: (z[Q2] - opens) * 1e9]
        if not self.sides:
            self.sides = [-1.0 if crossing(0.0, self.state) < 0 else 1.0 for crossing in crossings]
        for crossing, side in zip(crossings, self.sides, strict=True):
            crossing.direction = -side  # type: ignore[attr-defined]
        if direction == 0:
            ends: list[Callable[..., float]] = [
                lambda _t, z: physics.push(z) - physics.static[0],
                lambda _t, z: -physics.push(z) - physics.static[1],
            ]
            for end in ends:
                end.direction = 1  # type: ignore[attr-defined]
        else:
            ends = [lambda _t, z: direction * z[W]]
            ends[0].direction = -1  # type: ignore[attr-defined]
        for event in (*ends, *crossings):
            event.terminal = True  # type: ignore[attr-defined]
        return [*ends, *crossings]

    def advance(
        self, start: float, end: float, command: Callable[[float], float], samples: np.ndarray | None = None
    ) -> np.ndarray:
        """Move the solution from ``start`` to ``end``; return the states at ``samples`` (n, 8)."""
        physics, now = self.physics, start
        # one nm, um/s, ... for the scale of each state
        scale = np.array([1e-9, 1e-7, 1e-5, 1e-15, 1e-15, 1e-9, 1e-7, 1e-7]) * (self.rtol / 1e-6)
        seen: list[np.ndarray] = []
        while now < end:
            direction = self.direction
            wanted = None if samples is None else samples[(samples >= now) & (samples < end)]
            found = solve_ivp(
                lambda t, z: physics.rate(z, command(t), direction),  # noqa: B023
                (now, end),
                self.state,
                method=self.method,
                rtol=self.rtol,
                atol=scale,
                t_eval=None if wanted is None else np.append(wanted, end),
                events=self._boundaries(),
                max_step=self.max_step,
            )
            if found.status < 0:
                raise RuntimeError(found.message)
            hits = [(times[0], i) for i, times in enumerate(found.t_events) if len(times)]
            stop = min(hits)[0] if hits else end
            if wanted is not None:
                seen.append(found.y.T[found.t < min(stop, end)])
            if not hits:
                self.state = found.y[:, -1].copy()
                break
            _, which = min(hits)
            self.state = found.y_events[which][0].copy()
            now = stop
            ends = 2 if direction == 0 else 1
            if which < ends:
                self._switch(now)
            else:
                self.sides[which - ends] *= -1.0
        return np.concatenate(seen) if seen else np.empty((0, 8))

    def _switch(self, time: float) -> None:
        push = self.physics.push(self.state)
        if self.direction != 0:
            self.state[W] = 0.0
            moving = abs(push) > self.physics.holds(push)
        else:
            moving = True
        self.direction = (1 if push > 0 else -1) if moving else 0
        self.events.append(time)


@dataclass(frozen=True)
class Gains:
    """PID gains of one direction (Table 5.2.1)."""

    kp: float
    ki: float
    kd: float


def closed_loop(
    arm: Arm,
    reference: np.ndarray,
    velocity: np.ndarray,
    gains: tuple[Gains, Gains],
    dither_volts: float = 1.2,
    count: float = 0.0,
    delay: int = 2,
    scale: float = 8.5,
    feedforward: np.ndarray | None = None,
) -> np.ndarray:
    """Return the arm angle (n,) rad at each sample of a digital PID at 1 kHz (5.2.1.2, 5.2.3.1).

    ``reference`` (n,) rad, ``velocity`` (n,) rad/s; the first gain set is that of the positive direction.
    """
    n, h = len(reference), 1e-3
    ahead = np.zeros(n) if feedforward is None else feedforward
    angle, error, commands = np.zeros(n), np.zeros(n), np.zeros(n)
    total = 0.0
    first = velocity[np.argmax(velocity != 0.0)]
    chosen = gains[0] if first > 0 else gains[1]
    for k in range(n):
        angle[k] = arm.state[LAG] if arm.physics.lag else arm.state[Y] / arm.physics.radius
        measured = np.floor(angle[k] / count + 0.5) * count if count else angle[k]
        error[k] = reference[k] - measured
        if velocity[k] != 0.0:
            chosen = gains[0] if velocity[k] > 0 else gains[1]
        total += error[k] * h
        slope = (error[k] - error[max(k - 5, 0)]) / (5 * h)
        commands[k] = scale * (chosen.kp * error[k] + chosen.ki * total + chosen.kd * slope) + ahead[k]
        late = commands[k - delay] if k >= delay else 0.0
        shake = dither_volts * (1 if (k // 2) % 2 == 0 else -1) * 36 * DEGREE
        _hold(arm, k * h, (k + 1) * h, late + shake)
    return angle


def open_loop(arm: Arm, commands: np.ndarray, delay: int = 2) -> np.ndarray:
    """Return the states (n, 8) at each sample where the pump is given ``commands`` (n,) rad, held over each sample."""
    states = np.zeros((len(commands), 8))
    for k in range(len(commands)):
        states[k] = arm.state
        _hold(arm, k * 1e-3, (k + 1) * 1e-3, commands[k - delay] if k >= delay else 0.0)
    return states


def _hold(arm: Arm, start: float, end: float, command: float) -> None:
    arm.advance(start, end, lambda _t: command)
