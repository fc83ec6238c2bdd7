"""Write what was identified as configuration: a model for run, compare and diagnose, and its simulated rig."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from hjcamp.configuration.saved_model import paths_of
from hjcamp.errors import counted
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.calibrate.estimate import Estimate
from hjcamp.plants.pump_joint.calibrate.identify import Calibration
from hjcamp.plants.pump_joint.configuration import check_model
from hjcamp.schema import naming
from hjcamp.storage import whole_file

SCATTER = {"friction_between": 1.0, "friction_within": 1.0, "initial_pressure": 1e-6}
LEAK = "leakage."


def write_configuration(
    name: str, calibration: Calibration, reference: Mapping[str, Any], folder: Path, origin: Mapping[str, str]
) -> tuple[Path, Path]:
    """Write ``model/NAME.yaml`` and ``rig/NAME.yaml`` under ``folder``, each whole or not at all; return their paths.

    ``reference`` is the resolved configuration of the hardware, ``origin`` is what the provenance says besides. Raises
    ``UsageError``, and writes nothing, where a value is one that no command would take.
    """
    paths = paths_of(name, folder)
    texts = model_text(name, calibration, origin), rig_text(name, calibration, reference)
    with naming("what was identified is no model that could be used"):
        check_model(yaml.safe_load(texts[0]), "model")
    for path, text in zip(paths, texts, strict=True):
        with whole_file(path) as stream:
            stream.write(text.encode())
    return paths


def model_text(name: str, calibration: Calibration, origin: Mapping[str, str]) -> str:
    """Return the model's YAML: plant parameters and effects in SI, each with its interval in a comment."""
    found = calibration.estimates
    plant = [one for key, one in found.items() if key in PumpJoint.parameters]
    named = " ".join(f"{group}={choice}" for group, choice in calibration.hardware.items())
    lines = [
        f"# Calibrated from {calibration.tests} test logs ({named or 'hardware not named'}).",
        "# Values in SI units; 95 % intervals over repetitions.",
        f"name: {name}",
        "parameters:" if plant else "parameters: {}",
        *(_line(one.name, one) for one in plant),
    ]
    leak = leak_of(found)
    if leak:
        lines += ["effects:", "  leakage:", *(f"  {_line(key.removeprefix(LEAK), one)}" for key, one in leak.items())]
    else:
        lines.append("effects: {}")
    provenance: dict[str, Any] = dict(origin)
    provenance["tests"] = calibration.tests
    if "pump_delay" in found and "pump_delay" not in PumpJoint.parameters:
        provenance["pump_delay_ms"] = round(found["pump_delay"].value * 1e3, 4)
    facts = {f"{kind}: {key}": value for kind, one in calibration.findings.items() for key, value in one.facts.items()}
    provenance["facts"] = facts
    provenance["warnings"] = [f"{kind}: {text}" for kind, one in calibration.findings.items() for text in one.warnings]
    lines.append(yaml.safe_dump({"provenance": provenance}, sort_keys=False, allow_unicode=True, width=110).rstrip())
    return "\n".join(lines) + "\n"


def leak_of(found: Mapping[str, Estimate]) -> dict[str, Estimate]:
    """Return the parameters of effect leakage where the logs show a leak, else nothing."""
    leak = {key: one for key, one in found.items() if key.startswith(LEAK)}
    main = leak.get("leakage.conductance")
    if main is None or main.value <= 0 or (main.interval is not None and main.interval[0] <= 0):
        return {}
    if "leakage.conductance_above" not in leak:
        unseen = Estimate("leakage.conductance_above", 0.0, main.unit, None, main.tests, "not seen", main.shown_unit)
        leak["leakage.conductance_above"] = unseen
    return leak


def _line(key: str, one: Estimate) -> str:
    interval = "no interval" if one.interval is None else f"95 %: {one.interval[0]:.5g} to {one.interval[1]:.5g}"
    published = "" if one.published is None else f"; published {one.published:.5g}"
    # PyYAML takes a number for one only with a point and a signed exponent.
    value = repr(float(f"{one.value:.7g}"))
    value = value if "e" not in value or "." in value else value.replace("e", ".0e")
    return f"  {key}: {value}  # {one.unit}, {interval}, {counted(one.tests, 'test')}{published}"


def rig_text(name: str, calibration: Calibration, reference: Mapping[str, Any]) -> str:
    """Return the YAML of the simulated rig: delay of the pump, sensors, scatter of repetitions, in practical units."""
    found = calibration.estimates
    base = reference["rig"]
    sensors, scatter = dict(base["sensors"]), dict(base["scatter"])
    if "pressure_noise" in found:
        sensors["pressure_noise_mpa"] = float(f"{found['pressure_noise'].value * 1e-6:.4g}")
    for key, field in (("encoder_count", "encoder_counts_per_turn"), ("pump_count", "pump_counts_per_turn")):
        if key in found:
            sensors[field] = round(2 * 3.141592653589793 / found[key].value)
    for key, scale in SCATTER.items():
        if key in found:
            field = f"{key}_mpa" if key == "initial_pressure" else key
            scatter[field] = float(f"{found[key].value * scale:.4g}")
    content: dict[str, Any] = {"rig": {"name": name, "sensors": sensors, "scatter": scatter}}
    if "pump_delay" in found and calibration.hardware.get("amplifier"):
        delay = {"delay_ms": float(f"{found['pump_delay'].value * 1e3:.4g}")}
        content["pump"] = {"transfer_function": {calibration.hardware["amplifier"]: delay}}
    head = (
        "# @package _global_\n"
        f"# The simulated rig to model '{name}': run with  model={name} rig={name}\n"
        "# What was not identified is as in rig 'virtual'.\n"
    )
    return head + yaml.safe_dump(content, sort_keys=False, allow_unicode=True)
