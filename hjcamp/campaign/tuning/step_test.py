r"""PID gains of any plant by a step test on its simulation: two lags with a delay are fitted to the response, and SIMC's rules applied.

.. math:: g(s) = \frac{k'\,e^{-\theta s}}{(s + 1/\tau_1)(\tau_2 s + 1)}, \quad
          K_c = \frac{1}{k' (\tau_c + \theta)}, \quad \tau_I = \min(\tau_1, 4 (\tau_c + \theta)), \quad \tau_D = \tau_2

in series form; without a leak (tau_1 infinite) the plant integrates, and where tau_2 is beyond 4 (tau_c + theta) it does so twice:
K_c = tau_2 / (4 k' (tau_c + theta)^2), tau_I = tau_D = 4 (tau_c + theta). A tau_2 below theta is halved between lag and delay, and
the law is a PI. Source: Skogestad 2003, doi:10.1016/S0959-1524(02)00062-8.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.backends import plant_simulation
from hjcamp.controllers.fit import commanded, controlled_field, measured_fields
from hjcamp.errors import HjcampError, UsageError
from hjcamp.model.run.closed_loop import LoopTest

Array = NDArray[np.float64]
# Samples of the first step response, how often it is made twice as long, and how often the step is made twice as large.
SAMPLES, LONGER, LARGER = 64, 13, 6
# So many of them are fitted.
MOST = 1024
# 1/s: in the place of none, where one is divided by it.
NO_LEAK = 1e-12
# How often a loop that does not settle to so much of the step is asked to be half as fast.
SLOWER, FOLLOWED = 8, 0.1
# A response that two lags with a delay leave more of (rms over range) has another form.
UNLIKE = 0.05
# The response is long enough at so many times its lags, or where it has gone on so many times as long as the second one.
SETTLED = 4.0
# Between reading and command: a sample of the loop, and half a one for the command that is held.
LOOP = 1.5
# Where the shape of a fit begins, as shares of the response's length.
BEGUN = [(a, b, late) for a in (1e-3, 1.0, 5.0) for b in (5.0, 50.0) for late in (0.0, 0.1)]


@dataclass(frozen=True)
class Lags:
    """A response: ``slope`` k' (unit of the channel for one of the input, per s), ``leak`` 1/tau_1 (1/s), ``lag`` tau_2, ``delay`` (s).

    ``left`` is the rms that it leaves of the response, as a share of that one's range.
    """

    slope: float
    leak: float
    lag: float
    delay: float
    left: float


@dataclass(frozen=True)
class StepTest:
    """What a step test on the simulation gave, SI: the ``step``, its ``seconds``, the response, and gains for a time ``closed`` tau_c.

    ``overshoot`` is a share of the reference's step in the simulated closed loop.
    """

    step: float
    seconds: float
    response: Lags
    closed: float
    gains: dict[str, float]
    overshoot: float


def step_test(config: Mapping[str, Any], law: str, step: float = 0.0, closed: float = 0.0) -> StepTest:
    """Return gains for the controller ``law`` (a PID) of a plant; ``config`` has its model under the controller 'given'.

    The input goes to ``step`` (half its usual size where none is said, made larger while nothing moves), then to twice that: the
    difference has no dry friction in it. ``closed`` is the time constant that the loop is to have, s; where none is said the delay, or
    longer where the simulated loop does not settle with that. Raises ``UsageError`` where nothing moves or settles, or the response has
    another form.
    """
    plant = plant_simulation.plant_in(config)
    where = f"plant {plant.name}"
    [name] = commanded(*_given(config, plant))
    sizes = [step] if step else [0.5 * plant.inputs[name].typical * 2.0**k for k in range(LARGER)]
    size = next((one for one in sizes if np.ptp(_moved(config, one)) > 0.0), 0.0)
    if not size:
        raise UsageError(
            f"{where}: a step of '{name}' to {sizes[-1]:g} ({plant.inputs[name].unit}) moves nothing; give a larger --step"
        )
    found, count = _whole_response(config, size, f"{where}: the response to a step of '{name}' of {size:g}")
    samples = plant_simulation.law_values({"controller": {"name": law}}, _named(law))["derivative_samples"]
    for _ in range(1 if closed else SLOWER):
        closed, gains = simc(found, plant.period, samples, closed)
        asked = {**config, "controller": {"name": law, "input": config["controller"].get("input"), **gains}}
        overshoot, left = _followed(asked, found, size, count)
        if left <= FOLLOWED:
            return StepTest(size, count * plant.period, found, closed, gains, overshoot)
        closed *= 2.0
    raise UsageError(
        f"{where}: with gains of this test the simulated loop does not settle, {100.0 * left:.2g} % of the step are left at its end; "
        "give a longer --time-ms or another --step, or tune over a campaign (hjcamp tune campaign=NAME)"
    )


def simc(found: Lags, period: float, samples: float, closed: float = 0.0) -> tuple[float, dict[str, float]]:
    """Return tau_c (s), and gains of the PID in parallel form, SI; the delay is that of the response and of the loop.

    ``samples`` are those over which the derivative is taken: half of them is how late it is.
    """
    slope, leak, lag, delay = found.slope, found.leak, found.lag, found.delay + LOOP * period
    if lag <= delay:
        delay += 0.5 * lag
        leak = 1.0 / (1.0 / leak + 0.5 * lag) if leak else 0.0
        slope, lag = slope * (leak / found.leak if leak else 1.0), 0.0
    else:
        delay += 0.5 * samples * period
    time = closed or delay
    both = time + delay
    integral = min(1.0 / leak, 4.0 * both) if leak else 4.0 * both
    gain, derivative = 1.0 / (slope * both), lag
    if lag > 4.0 * both:
        gain, integral, derivative = lag / (4.0 * slope * both**2), 4.0 * both, 4.0 * both
    parallel = 1.0 + derivative / integral
    found_gains = {"kp": gain * parallel, "ki": gain / integral, "kd": gain * derivative}
    return time, {key: float(f"{value:.4g}") for key, value in found_gains.items()}


def fitted_lags(response: Array, period: float) -> Lags | None:
    """Return the lags whose unit step response is closest to a sampled one (n,); None where that is not finite or stays."""
    from scipy.optimize import least_squares

    if not np.isfinite(response).all() or not np.ptp(response) > 0.0:
        return None
    time, size = np.arange(len(response)) * period, float(np.ptp(response))
    length = time[-1]

    def shape(x: Array) -> Array:
        return _unit_response(time / length, math.exp(x[0]), math.exp(x[1]), x[2])

    def left(x: Array) -> Array:
        one = shape(x)
        return np.asarray((response - one * (one @ response) / max(float(one @ one), 1e-300)) / size)

    starts = [np.array([math.log(a), math.log(b), late]) for a, b, late in BEGUN]
    bounds = (np.array([math.log(1e-4), math.log(0.5), 0.0]), np.array([math.log(1e3), math.log(1e4), 0.9]))
    fits = [least_squares(left, one, bounds=bounds, x_scale=(1.0, 1.0, 0.1)) for one in starts]
    best = min(fits, key=lambda one: one.cost).x
    one = shape(best)
    gain = float(one @ response) / float(one @ one)
    leak, fast = sorted((math.exp(best[0]), math.exp(best[1])))
    # a leak and a delay that the response does not show are none
    leak, late = 0.0 if leak < 1e-2 else leak, 0.0 if best[2] < 1e-6 else best[2]
    rest = float(np.sqrt(np.mean(left(best) ** 2)))
    return Lags(float(gain / length), float(leak / length), float(length / fast), float(late * length), rest)


def _unit_response(time: Array, leak: float, fast: float, late: float) -> Array:
    """Return the response at times to a unit step of an integrator with a leak behind a lag 1 / fast, both behind a delay."""
    t = np.maximum(time - late, 0.0)
    if abs(fast - leak) < 1e-6 * fast:
        fast *= 1.0 + 1e-6
    slow, quick = (-np.expm1(-rate * t) / rate for rate in (leak, fast))
    return np.asarray(fast / (fast - leak) * (slow - quick), dtype=np.float64)


def _whole_response(config: Mapping[str, Any], size: float, where: str) -> tuple[Lags, int]:
    """Return the lags of the first response that is long enough to show them, and its samples: what the half of it has predicts it."""
    period = plant_simulation.plant_in(config).period
    count, before, found = SAMPLES, None, None
    for _ in range(LONGER):
        response = _difference(config, size, count) / size
        if not np.isfinite(response).all():
            break
        step = max(count // MOST, 1)
        before, found = found, fitted_lags(response[::step], step * period)
        if before and found and found.left <= UNLIKE:
            slowest = max(1.0 / found.leak if found.leak else 0.0, found.lag) + found.delay
            time: Array = np.arange(float(count)) * period
            ahead = before.slope * _unit_response(time, before.leak or NO_LEAK, 1.0 / before.lag, before.delay)
            if time[-1] >= SETTLED * slowest and np.sqrt(np.mean((ahead - response) ** 2)) <= UNLIKE * np.ptp(response):
                return found, count
        count *= 2
    left = f" (two lags with a delay leave {100.0 * found.left:.0f} % of it)" if found and found.left > UNLIKE else ""
    raise UsageError(
        f"{where} neither settles without swinging nor rises steadily within {count // 2 * period:.3g} s{left}; "
        "tune over a campaign instead (hjcamp tune campaign=NAME), or give another --step"
    )


def _named(law: str) -> Any:
    return plant_simulation.law_of({"controller": {"name": law}})[0]


def _given(config: Mapping[str, Any], plant: Any) -> tuple[Any, Any, str]:
    law, chosen = plant_simulation.law_of(config)
    return law, plant, chosen


def _moved(config: Mapping[str, Any], size: float) -> Array:
    """Return what is controlled (n,) under a constant input less what it is without."""
    count = SAMPLES * 2 ** (LONGER - 4)
    return _run(config, np.full(count, size)) - _run(config, np.zeros(count))


def _difference(config: Mapping[str, Any], size: float, count: int) -> Array:
    """Return by how much what is controlled (count,) differs after a step from ``size`` to twice that."""
    before, after = np.full(2 * count, size), np.full(2 * count, size)
    after[count:] *= 2.0
    return (_run(config, after) - _run(config, before))[count:]


def _followed(config: Mapping[str, Any], found: Lags, size: float, count: int) -> tuple[float, float]:
    """Return the overshoot of the simulated loop, and what is left of the error at its end, as shares of the step of the reference.

    That is as far as the step of the input moves what is controlled; infinite where the loop diverges.
    """
    period = plant_simulation.plant_in(config).period
    far = size * found.slope * float(_unit_response(np.full(1, count * period), found.leak or NO_LEAK, 1.0 / found.lag, 0.0)[0])
    begun = _run(config, np.zeros(count))[0]
    share = (_run(config, np.full(count, begun + far)) - begun) / far
    if not np.isfinite(share).all():
        return math.inf, math.inf
    return max(float(share.max()) - 1.0, 0.0), float(np.abs(share[-max(count // 10, 1) :] - 1.0).max())


def _run(config: Mapping[str, Any], reference: Array) -> Array:
    """Return what is controlled (n,) without noise, counts and scatter, under a reference (n,)."""
    simulator = plant_simulation.simulator_of(config)
    plant, (law, _) = simulator.composition.plant, plant_simulation.law_of(config)
    values, delays = plant_simulation.apart(plant_simulation.model_of(config, plant)[1])
    p, gains, count = simulator.vector(values), plant_simulation.law_values(config, law), len(reference)
    readings = len(simulator.composition.measured)
    late = np.array([max(delays.get(name, 0.0), 0.0) for name in simulator.composition.inputs]) / plant.period
    test = LoopTest(
        control=law.vector(gains),
        first=0,
        last=count,
        reference=np.column_stack([reference, np.zeros((count, 2))]),
        inputs=np.tile(simulator.inputs(), (count, 1)),
        late=late,
        counts=np.zeros(readings),
        phases=np.zeros(readings),
        noise=np.zeros((count, readings)),
    )
    start = plant_simulation.start_of(config, plant, {})
    try:
        recorded = simulator.run_loop(start, p, test)
    except HjcampError:
        return np.full(count, np.nan)
    shown = simulator.composition.measured[measured_fields(plant).index(controlled_field(plant))]
    return np.asarray(recorded[f"reading.{shown}"], dtype=np.float64)
