"""The published model in SciPy's event-driven LSODA, written to be fast: what the kernel is measured against."""

from __future__ import annotations

from collections.abc import Callable
from math import pi, sin

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]
DEGREE = pi / 180
GAIN, A2, A1, A0, DELAY = 6.125 / DEGREE, 245.0, 35700.0, 2205000.0, 2e-3
AREA1, AREA2, STIFFNESS, MASS, RADIUS = pi / 4 * 6.35e-3**2, pi / 4 * 4e-3**2, 0.0257e15, 0.0185, 3.41e-3
PRESSURES = (0.32e6, 0.14e6)
STATIC, COULOMB, VISCOUS = {1: 7.20, -1: 4.03}, {1: 5.27, -1: 2.97}, {1: 23.5, -1: 17.2}
SCALES = np.array([1e-6, 1e-4, 1e-2, 1e-6, 1e-4])


def command(time: float) -> float:
    """Return the open-loop sine of 4.6.2 behind the pump's delay, rad."""
    late = time - DELAY
    return 8.5 * 120 * DEGREE * sin(4 * pi * late) if late > 0 else 0.0


def held_commands(samples: int) -> Callable[[float], float]:
    """Return the same command as a digital controller gives it: held for each millisecond."""
    values = [command(k * 1e-3) for k in range(samples + 1)]
    return lambda time: values[min(int(time * 1e3 + 1e-9), samples)]


def solve(duration: float, tolerance: float, held: bool = False) -> Array:
    """Return the arm angle (n,) rad at 1 kHz; ``tolerance`` relative, of each state's size absolute.

    Five states are enough, as both pressures follow from pump and slider travel. With ``held`` the solver starts anew at
    each sample, as a command that jumps demands.
    """
    push0, spring = (PRESSURES[0] - PRESSURES[1]) * AREA2, 2 * STIFFNESS * AREA2
    samples = round(duration * 1000)
    given = held_commands(samples) if held else command
    times = np.arange(samples) * 1e-3
    out = np.zeros(samples)
    state, now, direction = np.zeros(5), 0.0, 0
    while now < duration - 1e-12:
        end = min(duration, (round(now * 1e3 - 0.499999) + 1) * 1e-3) if held else duration
        side = direction

        def rate(time: float, z: Array) -> list[float]:
            x, v, a, y, w = z.tolist()
            jolt = GAIN * given(time) - A2 * a - A1 * v - A0 * x
            if side == 0:  # noqa: B023
                return [v, a, jolt, 0.0, 0.0]
            push = push0 + spring * (AREA1 * x - AREA2 * y)
            friction = side * COULOMB[side] + VISCOUS[side] * w  # noqa: B023
            return [v, a, jolt, w, (push - friction) / MASS]

        def ends(_time: float, z: Array) -> float:
            if side:  # noqa: B023
                return float(z[4]) * side  # noqa: B023
            push = push0 + spring * (AREA1 * z[0] - AREA2 * z[3])
            return float(min(STATIC[1] - push, STATIC[-1] + push))

        ends.terminal, ends.direction = True, -1  # type: ignore[attr-defined]
        wanted = times[(times >= now - 1e-12) & (times < end - 1e-12)]
        found = solve_ivp(
            rate,
            (now, end),
            state,
            "LSODA",
            np.append(wanted, end),
            events=ends,
            rtol=tolerance,
            atol=tolerance * SCALES,
        )
        before = found.t < end - 1e-12
        first = round(now * 1e3 + 0.499999) if len(wanted) else 0
        out[first : first + before.sum()] = found.y[3][before]
        if found.status == 1:
            now, state = float(found.t_events[0][0]), found.y_events[0][0].copy()
            push = push0 + spring * (AREA1 * state[0] - AREA2 * state[3])
            if side:
                state[4] = 0.0
            side_now = 1 if push > 0 else -1
            moving = not side or abs(push) > STATIC[side_now]
            direction = side_now if moving else 0
        else:
            now, state = end, found.y[:, -1].copy()
    return out / RADIUS
