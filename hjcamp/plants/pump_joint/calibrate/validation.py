"""Model against measurement for open-loop tests: arm angle and line pressures (thesis 4.6, Figures 4.6.3 and 4.6.4)."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import UsageError, counted
from hjcamp.plants.pump_joint.calibrate.constants import Configure, attached_configuration, hardware_of
from hjcamp.plants.pump_joint.calibrate.estimate import Chart, Finding, Series
from hjcamp.records.log import TestLog

Array = NDArray[np.float64]
CHOSEN = ("payload", "orientation", "controller", "trajectory")
MOTION = ("controller", "trajectory", "procedure")
FIRST = 5
SIGNALS = (("arm_deg", "Arm angle (deg)", "4.6.3"), ("pressure", "Pressure (MPa gauge)", "4.6.4"))


def model_test(log: TestLog, configure: Configure, model: str = "published") -> dict[str, Array]:
    """Return the columns that ``model`` gives for the test in ``log``, from its first pressures, free of scatter.

    Raises UsageError where the log does not say which trajectory was run.
    """
    from hjcamp.plants.pump_joint.simulation import run_test

    attached = attached_configuration(log)
    if attached is None and not log.metadata.get("trajectory"):
        raise UsageError(f"{log.path}: names no trajectory and holds no configuration; the model cannot repeat the test")
    chosen = tuple((group, log.metadata[group]) for group in CHOSEN if log.metadata.get(group) and attached is None)
    config: dict[str, Any] = copy.deepcopy(dict(configure((*hardware_of(log), *chosen, ("model", model)))))
    if attached is not None:
        config.update({group: copy.deepcopy(attached[group]) for group in MOTION})
    config["rig"]["scatter"] = dict.fromkeys(config["rig"]["scatter"], 0.0)
    config["rig"]["scatter"]["friction_correlation_s"] = 0.2
    config["rig"]["sensors"]["pressure_noise_mpa"] = 0.0
    first = {name: float(np.mean(log.command_phase[name][:FIRST])) for name in ("pressure1_mpa", "pressure2_mpa")}
    config["procedure"]["initial"] = first
    config["procedure"]["adjustment"] = {**config["procedure"]["adjustment"], "enabled": False}
    return TestLog(run_test(config, 0)[0]).command_phase


def validate(logs: Sequence[TestLog], configure: Configure, model: str = "published") -> Finding:
    """Return the charts of measured and modelled angle and pressures, with the root mean square difference of each."""
    log = logs[0]
    modelled = model_test(log, configure, model)
    charts, facts = [], {}
    for signal, label, figure in SIGNALS:
        names = [signal] if signal == "arm_deg" else ["pressure1_mpa", "pressure2_mpa"]
        series = []
        for number, name in enumerate(names):
            length = min(len(modelled[name]), *(len(one.command_phase[name]) for one in logs))
            measured = np.mean([one.command_phase[name][:length] for one in logs], axis=0)
            time = log.command_phase["time_s"][:length]
            line = f"line {number + 1}, " if signal == "pressure" else ""
            series += [
                Series(time, measured, f"{line}measured", "line", number),
                Series(time, modelled[name][:length], f"{line}model {model}", "dashed", number + 2),
            ]
            difference = float(np.sqrt(np.mean((measured - modelled[name][:length]) ** 2)))
            facts[f"rms difference of {name}"] = f"{difference:.3g}"
        caption = f"{label.split(' (')[0]} in the open-loop test, {counted(len(logs), 'test')} against model {model}"
        charts.append(Chart(f"validation_{signal}", figure, caption, "Time (s)", label, tuple(series)))
    return Finding("open_loop_validation", (), tuple(charts), (), facts)
