"""From the configuration's hardware (practical units) to the parameters of the pump-driven joint (SI units)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from hjcamp.errors import unknown


def transfer_function(config: Mapping[str, Any]) -> Mapping[str, float]:
    """Return the pump's transfer function for the chosen amplifier; refuse a pump that was never run with it."""
    pump, amplifier = config["pump"], config["amplifier"]["name"]
    known = pump["transfer_function"]
    if amplifier not in known:
        raise unknown("amplifier", amplifier, known, f"pump '{pump['name']}'")
    return known[amplifier]


def plant_parameters(config: Mapping[str, Any]) -> dict[str, float]:
    """Return the plant's parameters by name, in SI units."""
    pump, joint, friction, sensors = config["pump"], config["joint"], config["friction"], config["rig"]["sensors"]
    function = transfer_function(config)
    degree = math.pi / 180
    stop = joint.get("travel_stop_deg")
    limit = pump.get("acceleration_limit_mm_per_s2")
    values = {
        "pump_gain": function["numerator_mm_per_deg"] * 1e-3 / degree,
        "pump_a2": function["a2"],
        "pump_a1": function["a1"],
        "pump_a0": function["a0"],
        "pump_delay": function["delay_ms"] * 1e-3,
        "pump_speed_limit": pump["speed_limit_mm_per_s"] * 1e-3,
        "pump_acceleration_limit": math.inf if limit is None else limit * 1e-3,
        "pump_lead": pump["lead_mm_per_rev"] * 1e-3 / (2 * math.pi),
        "pump_area": math.pi / 4 * (pump["bore_mm"] * 1e-3) ** 2,
        "joint_area": math.pi / 4 * (joint["bore_mm"] * 1e-3) ** 2,
        "line_stiffness": config["tubing"]["stiffness_mpa_per_mm3"] * 1e15,
        "vapour_pressure": joint["vapour_pressure_mpa"] * 1e6,
        "pulley_radius": joint["pulley_pitch_diameter_mm"] * 0.5e-3,
        "travel_stop": math.inf if stop is None else stop * degree * joint["pulley_pitch_diameter_mm"] * 0.5e-3,
        "moving_mass": joint["moving_mass_g"] * 1e-3,
        "encoder_count": 2 * math.pi / sensors["encoder_counts_per_turn"],
        "pump_count": 2 * math.pi / sensors["pump_counts_per_turn"],
        "pressure_noise": sensors["pressure_noise_mpa"] * 1e6,
        "dither_gain": config["amplifier"].get("command_deg_per_v", 36.0) * degree,
    }
    for direction in ("positive", "negative"):
        values[f"static_{direction}"] = friction[direction]["static_n"]
        values[f"coulomb_{direction}"] = friction[direction]["coulomb_n"]
        values[f"viscous_{direction}"] = friction[direction]["viscous_ns_per_mm"] * 1e3
    return {name: float(value) for name, value in values.items()}
