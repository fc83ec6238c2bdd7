"""Pictures of the campaign ``pid_design``: Figures 5.2.2 to 5.2.6 in one view, and 5.2.4 a to c from one test's error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.plants.pump_joint.controllers.pid import LONGEST_DERIVATIVE, Pid
from hjcamp.plants.pump_joint.figures.design import DesignStep, draw_filters, draw_steps
from hjcamp.plants.pump_joint.simulation import control_values, reference_of
from hjcamp.records.log import TestLog

Array = NDArray[np.float64]
DESIGN = "pid_design"
COLUMNS = ("time_s", "reference_deg", "arm_deg", "pressure1_mpa", "pressure2_mpa", "pid_deg")
#: Samples over which 5.2.4 a to c difference the error.
FILTERS = {"a": 1, "b": 5, "c": 10}
#: The figure of the thesis that a condition repeats, where it is one.
FIGURES = {"plain": "5.2.2", "dither": "5.2.3, 5.2.5", "pressure_adjustment": "5.2.6"}


def design_pictures(logs: Sequence[TestLog], configurations: Mapping[str, Mapping[str, Any]]) -> dict[str, tuple[str, str]]:
    """Return both pictures from the first repetition of each condition; none for the logs of other campaigns."""
    found: dict[str, TestLog] = {}
    for log in logs:
        if log.metadata.get("campaign") == DESIGN and set(COLUMNS) <= set(log.command_phase):
            found.setdefault(log.condition_key, log)
    if not found:
        return {}
    steps = [_step(log, _title(name, configurations[name])) for name, log in found.items()]
    pictures = {
        "The steps of the design, as Figures 5.2.2 to 5.2.6": (
            draw_steps(steps),
            f"{_which(list(found.values()))} of each step; 5.2.5 is the pressures of the test of 5.2.3",
        )
    }
    raw = next((name for name in found if _samples(configurations[name]) == 1 and _dithered(configurations[name])), None)
    if raw is not None:
        signals = filtered(found[raw], configurations[raw])
        titles = [
            (f"({letter}) n = {count}, {'no filtering' if count == 1 else 'the same error'}", signals[count])
            for letter, count in FILTERS.items()
        ]
        pictures["Control signal of one test's error under three filters, as Figure 5.2.4"] = (
            draw_filters(found[raw].command_phase["time_s"], titles),
            f"PID of the error of '{raw}', differenced over n samples; roughness (rms of the change in a sample): "
            + ", ".join(f"n = {count}: {roughness(signal):.1f} deg" for count, signal in signals.items()),
        )
    return pictures


def filtered(log: TestLog, config: Mapping[str, Any]) -> dict[int, Array]:
    """Return the PID part (deg of the pump) that the log's error would have given with each of `FILTERS`.

    The controller's own law runs over the recorded error; the arm would have moved otherwise (thesis 5.2.3 says so).
    """
    command = log.command_phase
    wanted, direction = reference_of(config)
    arm = np.radians(command["arm_deg"])
    rows = wanted[np.minimum(np.arange(len(arm)), len(wanted) - 1)]
    given = {name: item.default for name, item in Pid.parameters.items()} | control_values(config, Pid, direction)
    return {
        count: np.degrees(_over(rows, arm, SimpleNamespace(**{**given, "derivative_samples": float(count)})))
        for count in FILTERS.values()
    }


def roughness(signal: Array) -> float:
    """Return the root mean square of the change from sample to sample."""
    return float(np.sqrt(np.mean(np.diff(signal) ** 2)))


def _over(rows: Array, arm: Array, parameter: SimpleNamespace) -> Array:
    memory = SimpleNamespace(direction=0.0, integral=0.0, errors=[0.0] * LONGEST_DERIVATIVE)
    sample = SimpleNamespace(period=1e-3, feedforward=0.0)
    found = np.empty(len(arm))
    for index, ((sample.reference, sample.velocity, _), sample.arm) in enumerate(zip(rows, arm, strict=True)):
        sample.index = index
        found[index] = Pid.step(sample, parameter, memory)[0]
    return found


def _which(logs: Sequence[TestLog]) -> str:
    """Return which repetition the tests are, in words: a report of one repetition alone has no first one."""
    numbers = {log.metadata.get("repetition", "1") for log in logs}
    return "first repetition" if numbers == {"1"} or len(numbers) > 1 else f"repetition {numbers.pop()}"


def _step(log: TestLog, title: str) -> DesignStep:
    command = log.command_phase
    return DesignStep(title, *(command[name] for name in COLUMNS))


def _title(name: str, config: Mapping[str, Any]) -> str:
    """Return what a step has, in words, and the figure that it repeats."""
    step = name.rpartition("__")[2]
    lines = [f"{step.replace('_', ' ')}{f' ({FIGURES[step]})' if step in FIGURES else ''}"]
    dither = config["controller"]["dither"]
    lines.append(f"{dither['amplitude_v']:g} V, {dither['frequency_hz']:g} Hz" if _dithered(config) else "no dither")
    adjusted = "adjusted" if config["procedure"]["adjustment"]["enabled"] else "not adjusted"
    lines.append(f"n = {_samples(config)}, {adjusted}")
    return "\n".join(lines)


def _samples(config: Mapping[str, Any]) -> int:
    return int(config["controller"]["derivative_samples"])


def _dithered(config: Mapping[str, Any]) -> bool:
    return float(config["controller"]["dither"]["amplitude_v"]) > 0.0
