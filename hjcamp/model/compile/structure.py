"""Find which entries of a composition's propagators can differ from zero, and which rates are curved."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.compile.compose import Composition, local_name
from hjcamp.model.compile.source_lines import outside_range
from hjcamp.model.compile.source_text import GATES, names_in

Array = NDArray[np.float64]
Point = tuple[Array, Array, Array, Array, list[float]]
NO_LIMITS = 0
MOST_REGIMES = 13
# Bounds farther apart say nothing of how large a parameter is, in whatever unit.
WIDEST = 1e8


def _draws(
    composition: Composition, generator: np.random.Generator, gates: int
) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    z = np.array([state.usual(generator) for state in composition.states.values()])
    known = composition.plant.inputs
    u = np.array([known[name].default if name in known else 0.0 for name in composition.inputs])
    u = u + generator.uniform(-1, 1, len(u)) * 1e-6
    p = []
    for name, parameter in composition.parameters.items():
        if name == GATES:
            p.append(float(gates))
            continue
        value = 1.0 if name.startswith("gate.") else parameter.default
        low, high = parameter.bounds
        if value == 0.0 and math.isfinite(high - low):
            # what is linear at a default of 0 may be curved elsewhere
            p.append(generator.uniform(*((-1.0, 1.0) if high - low > WIDEST else (low, high))))
            continue
        p.append(value * generator.uniform(0.95, 1.05) if np.isfinite(value) and value > 0 else value)
    return z, u, np.array(p)


def regimes(composition: Composition, generator: np.random.Generator) -> list[float]:
    """Return every combination of the sides of the contacts, as ``direction`` says it; some of them where they are very many."""
    half = (3 ** len(composition.contacts) - 1) // 2
    if half > MOST_REGIMES:
        return [float(one) for one in generator.integers(-half, half, 2 * MOST_REGIMES, endpoint=True)]
    return [float(one) for one in range(-half, half + 1)]


def couplings(
    composition: Composition, rates: Callable[..., None], draws: int = 12
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return twice (n, n): True where a state can influence another one directly, and through others, and on the diagonal.

    Found by moving each state at random points in every regime; an entry that stays hidden there costs accuracy only
    in the linear part of the step, which its second-order correction makes good.
    """
    generator = np.random.default_rng(20090401)
    n = len(composition.states)
    steps = [0.5 * state.typical for state in composition.states.values()]
    direct = np.eye(n, dtype=bool)
    with np.errstate(all="ignore"):
        for _ in range(draws):
            z, u, p = _draws(composition, generator, -1)
            try:
                for direction in regimes(composition, generator):
                    base, moved = np.zeros(n), np.zeros(n)
                    rates(-1, 0.1, direction, z, u, p, base)
                    for j, step in enumerate(steps):
                        other = z.copy()
                        other[j] += step
                        rates(-1, 0.1, direction, other, u, p, moved)
                        direct[:, j] |= moved != base
            except (ArithmeticError, ValueError) as fault:
                raise outside_range(composition, fault) from fault
    reach = direct.copy()
    for _ in range(n):
        reach = reach | ((reach.astype(int) @ direct.astype(int)) > 0)
    return direct, reach


def nonlinear_rates(
    composition: Composition, rates: Callable[..., None], gates: int = -1, points: list[Point] | None = None
) -> NDArray[np.bool_]:
    """Return (n,) True where a state's rate is not linear in the states within a regime, at ``points_of`` the composition.

    ``gates``: the sum of 2^k over the open gates k of a composition that has them; all by default.
    """
    n = len(composition.states)
    found = np.zeros(n, dtype=bool)
    values = [np.zeros(n) for _ in range(6)]
    known = composition.plant.inputs
    with np.errstate(all="ignore"):
        gate = list(composition.parameters).index(GATES) if composition.gated else None
        for u, drawn, z, move, directions in points or points_of(composition):
            p = drawn.copy()
            if gate is not None:
                p[gate] = float(gates)
            usual = u.copy()
            for k, name in enumerate(composition.inputs):
                usual[k] = known[name].default if name in known else u[k]
            for direction in directions:
                places = (z - move, z, z + move, z, z, z + move)
                for k, (value, time, at) in enumerate(zip(values, (0.1, 0.1, 0.1, 7.3, 0.1, 0.1), places, strict=True)):
                    try:
                        rates(NO_LIMITS, time, direction, at, u if k < 4 else usual, p, value)
                    except (ArithmeticError, ValueError):
                        value[:] = np.nan
                scale = np.abs(values[0]) + np.abs(values[1]) + np.abs(values[2]) + 1e-300
                bend = np.abs(values[0] + values[2] - 2.0 * values[1]) / scale
                found |= ~(bend <= 1e-9) | (values[3] != values[1])
                # the propagators are of the usual inputs: an input that multiplies a state bends its rate, too
                scale += np.abs(values[4]) + np.abs(values[5])
                turn = np.abs(values[2] - values[1] - values[5] + values[4]) / scale
                found |= ~(turn <= 1e-9)
    return found


def points_of(composition: Composition, draws: int = 60) -> list[Point]:
    """Return inputs, parameters, states, moves of the states and regimes at which ``nonlinear_rates`` looks.

    The states spread from a hundredth of their typical sizes to a thousand times, so that a threshold far from rest is seen. Half of
    the points have their inputs at their defaults, half spread equally: what is linear without a current may be curved with one.
    """
    generator = np.random.default_rng(20090402)
    n = len(composition.states)
    typical = np.array([state.typical for state in composition.states.values()])
    found = []
    for draw in range(2 * draws):
        _, u, p = _draws(composition, generator, 0)
        if draw >= draws:
            u = _spread_inputs(composition, generator)
        z = typical * 10.0 ** generator.uniform(-2, 3, n) * generator.choice((-1.0, 1.0), n)
        move = typical * 10.0 ** generator.uniform(-2, 3) * generator.uniform(-1, 1, n)
        found.append((u, p, z, move, regimes(composition, generator)))
    return found


def _spread_inputs(composition: Composition, generator: np.random.Generator) -> Array:
    """Return inputs from a hundredth of their typical sizes to a thousand times; those with a default of their own are near it."""
    known, found = composition.plant.inputs, []
    for name in composition.inputs:
        size = 10.0 ** generator.uniform(-2, 3) * generator.choice((-1.0, 1.0))
        given = known.get(name)
        default = given.default if given is not None else 0.0
        found.append(
            default * generator.uniform(0.95, 1.05) if default else size * (given.typical if given is not None else 1.0)
        )
    return np.array(found)


def influences(composition: Composition, outputs: Sequence[str]) -> frozenset[str]:
    """Return the names of the parameters that the named slots and signals of a composition can depend on."""
    given = {f"p_{local_name(name)}": name for name in composition.parameters}
    return frozenset(given[name] for name in names_in(reaching(composition, outputs)) if name in given)


def reaching(composition: Composition, outputs: Sequence[str]) -> str:
    """Return the text of all that the named slots and signals of a composition are computed from.

    Followed through the text: from an output to what it is computed from, from a state to its rate, start and update.
    """
    local = {f"s_{local_name(name)}": name for name in composition.states}
    wanted = [f"x = {name}" for name in outputs]
    reached: set[str] = set()
    while True:
        text = "\n".join(composition.body(wanted))
        new = {local[name] for name in names_in(text) if name in local} - reached
        if not new:
            return text
        reached |= new
        for state in sorted(new):
            parts = (composition.rate(state), composition.start(state), composition.update(state))
            wanted += [f"x = {part}" for part in parts if part]
