"""Find which entries of a composition's propagators can differ from zero, so that the kernel multiplies only those."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.compose import GATES, Composition, names_in
from hjcamp.model.source_lines import outside_range


def _draws(composition: Composition, generator: np.random.Generator) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    z = np.array([state.typical * generator.uniform(-1, 1) for state in composition.states.values()])
    known = composition.plant.inputs
    u = np.array([known[name].default if name in known else 0.0 for name in composition.inputs])
    u = u + generator.uniform(-1, 1, len(u)) * 1e-6
    p = []
    for name, parameter in composition.parameters.items():
        if name == GATES:
            p.append(float((1 << len(composition.effects)) - 1))
            continue
        value = 1.0 if name.startswith("gate.") else parameter.default
        p.append(value * generator.uniform(0.95, 1.05) if np.isfinite(value) and value > 0 else value)
    return z, u, np.array(p)


def couplings(composition: Composition, rates: Callable[..., None], draws: int = 12) -> NDArray[np.bool_]:
    """Return (n, n) True where a state can influence another one, directly or through others, and on the diagonal.

    Found by moving each state at random points in every regime; an entry that stays hidden there costs accuracy only
    in the linear part of the step, which its second-order correction makes good.
    """
    generator = np.random.default_rng(20090401)
    n = len(composition.states)
    steps = [0.5 * state.typical for state in composition.states.values()]
    direct = np.eye(n, dtype=bool)
    with np.errstate(all="ignore"):
        for _ in range(draws):
            z, u, p = _draws(composition, generator)
            try:
                for direction in (-1.0, 0.0, 1.0):
                    base, moved = np.zeros(n), np.zeros(n)
                    rates(0.1, direction, z, u, p, base)
                    for j, step in enumerate(steps):
                        other = z.copy()
                        other[j] += step
                        rates(0.1, direction, other, u, p, moved)
                        direct[:, j] |= moved != base
            except (ArithmeticError, ValueError) as fault:
                raise outside_range(composition, fault) from fault
    reach = direct.copy()
    for _ in range(n):
        reach = reach | ((reach.astype(int) @ direct.astype(int)) > 0)
    return reach


def nonlinear_rates(composition: Composition, rates: Callable[..., None], draws: int = 60) -> NDArray[np.bool_]:
    """Return (n,) True where a state's rate is not linear in the states within a regime, apart from limiters.

    The points spread from a hundredth of the states' typical sizes to a thousand times, so that a threshold far from
    rest is seen; ``rates`` must be that of equations whose limiters do nothing.
    """
    generator = np.random.default_rng(20090402)
    n = len(composition.states)
    typical = np.array([state.typical for state in composition.states.values()])
    found = np.zeros(n, dtype=bool)
    values = [np.zeros(n) for _ in range(4)]
    with np.errstate(all="ignore"):
        for _ in range(draws):
            _, u, p = _draws(composition, generator)
            z = typical * 10.0 ** generator.uniform(-2, 3, n) * generator.choice((-1.0, 1.0), n)
            move = typical * 10.0 ** generator.uniform(-2, 3) * generator.uniform(-1, 1, n)
            for direction in (-1.0, 0.0, 1.0):
                for value, factor in zip(values, (-1.0, 0.0, 1.0), strict=False):
                    try:
                        rates(0.1, direction, z + factor * move, u, p, value)
                        rates(7.3, direction, z, u, p, values[3])
                    except (ArithmeticError, ValueError):
                        value[:] = np.nan
                scale = np.abs(values[0]) + np.abs(values[1]) + np.abs(values[2]) + 1e-300
                bend = np.abs(values[0] + values[2] - 2.0 * values[1]) / scale
                found |= ~(bend <= 1e-9) | (values[3] != values[1])
    return found


def influences(composition: Composition, outputs: Sequence[str]) -> frozenset[str]:
    """Return the names of the parameters that the named slots and signals of a composition can depend on."""
    given = {f"p_{name.replace('.', '_')}": name for name in composition.parameters}
    return frozenset(given[name] for name in names_in(reaching(composition, outputs)) if name in given)


def reaching(composition: Composition, outputs: Sequence[str]) -> str:
    """Return the text of all that the named slots and signals of a composition are computed from.

    Followed through the text: from an output to what it is computed from, from a state to its rate, start and update.
    """
    local = {f"s_{name.replace('.', '_')}": name for name in composition.states}
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
