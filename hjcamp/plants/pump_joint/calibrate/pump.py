"""The pump's transfer function and delay from step responses, its order by Akaike's final prediction error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import UsageError, counted
from hjcamp.plants.pump_joint.calibrate.constants import Constants
from hjcamp.plants.pump_joint.calibrate.estimate import Chart, Estimate, Finding, Series, mean_interval
from hjcamp.plants.pump_joint.calibrate.step_response import TransferFunction, fit, rise_time, telling_rows
from hjcamp.records.log import TestLog

Array = NDArray[np.float64]
ORDERS = (1, 2, 3, 4, 5, 6)
PLANT_ORDER = 3
PAYS = 0.75  # a further order pays where it brings the final prediction error below this share
SPEED_SHARE = 0.98
FLAT_SHARE = 0.55
SHORTEST_STEP = 50


def step_of(log: TestLog) -> tuple[Array, float]:
    """Return the response (n,) to a unit step at its first sample, and the size of the step in deg.

    Without a command the step is taken to be at the first sample and as large as the pump's travel.
    """
    columns = log.columns
    first = int(np.argmax(columns["phase"] == 3.0)) if "phase" in columns else 0
    phase = log.command_phase
    if "pump_deg" not in phase:
        raise UsageError(f"{log.path}: a step response needs 'pump_deg'; this log has the command alone")
    pump = phase["pump_deg"]
    start = 0
    if "command_deg" in phase:
        command = phase["command_deg"]
        start = int(np.argmax(np.abs(command - command[-1]) <= 0.02 * abs(command[-1] - pump[0])))
        before = columns["command_deg"][first - 1] if first > 0 else pump[0]
        size = float(command[-1] - before)
    else:
        before = pump[0]
        size = float(np.median(pump[-20:]) - before)
    if abs(size) < 20.0 or len(pump) - start < SHORTEST_STEP:
        raise UsageError(f"{log.path}: no step of the pump: it is asked to move {size:.3g} deg")
    return (pump[start:] - pump[start]) / size, size


def refuse_saturated(response: Array, size: float, speed_limit_deg: float, where: str) -> None:
    """Raise UsageError where a step runs into the pump's speed limit: no transfer function describes it.

    Seen by the limit itself, or by a speed within 5 % of its largest for more than 55 % of the rise (25 % for Gaussian,
    100 % for a ramp).
    """
    smooth = np.convolve(response, np.ones(3) / 3.0, mode="valid")
    speed = np.diff(smooth) / 1e-3
    fastest = float(speed.max())
    rising = (smooth[1:] > 0.1 * response[-1]) & (smooth[1:] < 0.9 * response[-1])
    flat = float(np.count_nonzero(speed >= 0.95 * fastest)) / max(int(np.count_nonzero(rising)), 1)
    if abs(size) * fastest >= SPEED_SHARE * speed_limit_deg or flat > FLAT_SHARE:
        raise UsageError(
            f"{where}: the step saturates: the pump runs at {abs(size) * fastest / 360:.3g} rev/s for "
            f"{flat * 100:.0f} % of its rise (limit {speed_limit_deg / 360:.3g} rev/s); use a smaller step, "
            f"for example trajectory.angle_deg={abs(size) / 2:.3g}"
        )


def final_prediction_error(mean_square: float, parameters: int, samples: int) -> float:
    """Return V (1 + d/N) / (1 - d/N). Source: Akaike (1969), Ann. Inst. Stat. Math. 21, 243; Ljung (1999) 16.4."""
    return mean_square * (1.0 + parameters / samples) / (1.0 - parameters / samples)


def fit_orders(responses: Array) -> dict[int, tuple[TransferFunction, float]]:
    """Return for each order from 1 to 6 its transfer function and final prediction error, for responses (tests, n)."""
    mean = responses.mean(axis=0)
    within = float(np.mean((responses - mean) ** 2))
    final = float(np.median(mean[-20:]))
    low, high = (int(np.argmax(mean > share * final)) for share in (0.1, 0.9))
    # What comes long after the rise is one level, and tells the gain alone.
    responses = responses[:, : high + max(10 * (high - low), 100)]
    mean = responses.mean(axis=0)
    delay = max(int(np.argmax(mean > 0.02 * final)) - 1, 0) * 1e-3
    rate = 2.2 / max((high - low) * 1e-3, 1e-3)
    found: dict[int, tuple[TransferFunction, float]] = {}
    for order in ORDERS:
        starts = [_plain_start(final, delay * share, rate, order) for share in (0.9, 0.4)] if order <= PLANT_ORDER else []
        if order > 1:
            starts += _grown(found[order - 1][0], order)
        if order > 2:
            starts += _grown(found[order - 2][0], order)
        function = fit(mean, order, starts, telling_rows(mean))
        error = float(np.mean((function.step(len(mean)) - mean) ** 2)) + within
        found[order] = function, final_prediction_error(error, order + 2, responses.size)
    return found


def _plain_start(gain: float, delay: float, rate: float, order: int) -> TransferFunction:
    pole = rate * order**0.5
    return TransferFunction(gain, delay, ((1.3 * pole, 0.7),) * (order // 2), pole if order % 2 else None)


def _grown(smaller: TransferFunction, order: int) -> list[TransferFunction]:
    """Return starts that hold the smaller solution and fast further poles."""
    fast = 8.0 * max([frequency for frequency, _ in smaller.sections] + [smaller.real_pole or 0.0])
    sections = smaller.sections
    if smaller.order == order - 2:
        return [TransferFunction(smaller.gain, smaller.delay, (*sections, (fast, 0.7)), smaller.real_pole)]
    if smaller.real_pole is None:
        return [TransferFunction(smaller.gain, smaller.delay, sections, fast)]
    frequency = (smaller.real_pole * fast) ** 0.5
    pair = (frequency, 0.5 * (smaller.real_pole + fast) / frequency)
    return [TransferFunction(smaller.gain, smaller.delay, (*sections, pair), None)]


def chosen_order(errors: Mapping[int, float]) -> int:
    """Return the order beyond which more no longer pays: no higher one brings the error below 75 % (Figure 4.3.2)."""
    for order in sorted(errors):
        if all(errors[higher] >= PAYS * errors[order] for higher in errors if higher > order):
            return order
    return max(errors)


def identify_pump(logs: Sequence[TestLog], constants: Constants) -> Finding:
    """Return the third-order transfer function of one pump and amplifier with its delay, and the order that pays."""
    steps = [step_of(log) for log in logs]
    limit = constants.pump_speed_limit / constants.pump_lead * 180.0 / np.pi
    for log, (response, size) in zip(logs, steps, strict=True):
        refuse_saturated(response, size, limit, str(log.path or "a step"))
    shortest = min(len(response) for response, _ in steps)
    responses = np.array([response[:shortest] for response, _ in steps])
    orders = fit_orders(responses)
    errors = {order: error for order, (_, error) in orders.items()}
    order = chosen_order(errors)
    joint = orders[PLANT_ORDER][0]
    rows = np.arange(shortest)
    single = [fit(response, PLANT_ORDER, [joint], rows) for response in responses]
    count = float(np.min(np.abs(np.diff(np.unique(logs[0].command_phase["pump_deg"]))), initial=360.0))
    estimates = _estimates(single, constants, count / abs(steps[0][1]))
    warnings = []
    if order != PLANT_ORDER:
        warnings.append(f"the data ask for order {order}; the plant takes order {PLANT_ORDER}, which is what is saved")
    if any("command_deg" not in log.columns for log in logs):
        warnings.append("no command in the logs: the step is taken to be at time 0, and the gain to be 1")
    settled = responses[:, -20:].mean(axis=0)
    if float(np.ptp(settled)) > 0.01:
        warnings.append("the pump has not settled at the end of the step; log it for longer")
    name = f"{constants.pump}_{constants.amplifier}"
    facts = {f"final prediction error, order {one}": f"{error:.3g}" for one, error in errors.items()}
    facts["order chosen"] = str(order)
    return Finding("pump", estimates, _charts(name, responses, joint, errors), tuple(warnings), facts)


def _estimates(single: Sequence[TransferFunction], constants: Constants, count: float) -> tuple[Estimate, ...]:
    known, tests = constants.published, len(single)
    polynomials = np.array([function.denominator for function in single])
    gains = np.array([function.gain for function in single])
    columns = {
        "pump_gain": ("m/(rad*s^3)", gains * polynomials[:, 3] * constants.pump_lead, "numerator"),
        "pump_a2": ("1/s", polynomials[:, 1], "coefficient of s^2"),
        "pump_a1": ("1/s^2", polynomials[:, 2], "coefficient of s"),
        "pump_a0": ("1/s^3", polynomials[:, 3], "constant coefficient"),
    }
    found = []
    for name, (unit, values, text) in columns.items():
        mean, interval = mean_interval(values, count * float(np.mean(values)))
        found.append(Estimate(name, mean, unit, interval, tests, text, unit, 1.0, known.get(name)))
    delays = np.array([function.delay for function in single])
    mean, interval = mean_interval(delays, count * rise_time(single[0]))
    found.append(Estimate("pump_delay", mean, "s", interval, tests, "delay", "ms", 1e3, constants.published_delay))
    rises = np.array([rise_time(function) for function in single])
    mean, interval = mean_interval(rises, count * float(rises.mean()))
    found.append(Estimate("rise_time", mean, "s", interval, tests, "rise time, 10 to 90 %", "ms", 1e3))
    return tuple(found)


def _charts(name: str, responses: Array, model: TransferFunction, errors: Mapping[int, float]) -> tuple[Chart, ...]:
    order = np.array(sorted(errors), dtype=np.float64)
    values = np.array([errors[int(one)] for one in order])
    samples = min(responses.shape[1], round((model.delay + 8.0 * rise_time(model)) / 1e-3))
    time = np.arange(samples) * 1.0
    mean = responses.mean(axis=0)[:samples]
    model_curve = model.step(samples)
    return (
        Chart(f"{name}_order", "4.3.2", "Final prediction error against order", "Order", "Final prediction error",
              (Series(order, values, "final prediction error", "points"), Series(order, values, "", "faint")), True),
        Chart(f"{name}_step", "4.3.3 to 4.3.5", f"Response to a step, {counted(len(responses), 'test')} and order 3", "Time (ms)",
              "Travel / step (1)",
              (Series(time, mean, "measured, mean"), Series(time, model_curve, "transfer function", "dashed", 1))),
    )  # fmt: skip
