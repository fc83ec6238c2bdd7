"""Whether wiring and limits of a rig reach what a test needs: known from its trajectory before anything moves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi
from typing import Any

from hjcamp.backends.rig.guard import interlock_of
from hjcamp.controllers import find_controller
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.rig.limits import Limits, read_limits
from hjcamp.plants.pump_joint.rig.silence import coupling_of
from hjcamp.plants.pump_joint.rig.wiring import Wiring, read_wiring
from hjcamp.plants.pump_joint.simulation import reference_of

DEGREE = pi / 180


@dataclass(frozen=True)
class Need:
    """What a test asks of arm and pump motor at the least, deg.

    The reference begins at ``first_arm`` and goes from ``lowest_arm`` to ``highest_arm``; each of its degrees needs
    ``per_arm`` of the motor, and the initial pressure adjustment needs ``offset``. ``tracked``: the law looks at the
    arm, so it commands whatever brings the arm to the reference (the bores decide); another one commands its ``scale``.
    """

    first_arm: float
    lowest_arm: float
    highest_arm: float
    per_arm: float
    offset: float
    tracked: bool

    @property
    def motor(self) -> tuple[float, float]:
        """Return the lowest and the highest angle of the motor."""
        return (
            self.per_arm * min(self.lowest_arm, 0.0) + min(self.offset, 0.0),
            self.per_arm * max(self.highest_arm, 0.0) + max(self.offset, 0.0),
        )


def need_of(config: Mapping[str, Any]) -> Need:
    """Return what the trajectory of a resolved configuration needs.

    Source: thesis 4.6.1 (motor angle of an arm angle), 4.4.3.15 and 5.2.4.1 (what the adjustment takes in two lines).
    """
    reference, direction = reference_of(config)
    coupling, procedure = coupling_of(config), config["procedure"]
    turn = 360.0 / config["pump"]["lead_mm_per_rev"]
    law, scale = find_controller(config["controller"]["name"]), config["controller"].get("scale")
    per_arm = turn / coupling.deg_per_mm if law.uses_arm or scale is None else float(scale)
    adjustment, offset = procedure["adjustment"], 0.0
    if adjustment["enabled"] and (procedure.get("initial") or {}).get("pressure1_mpa") is None:
        wanted = adjustment["positive_mpa" if direction > 0 else "negative_mpa"]
        offset = direction * 0.5 * wanted * coupling.mm_per_mpa * turn
    arm = reference[:, 0] / DEGREE
    return Need(float(arm[0]), float(arm.min()), float(arm.max()), per_arm, offset, law.uses_arm)


def check_reach(config: Mapping[str, Any], wiring: Wiring, limits: Limits) -> None:
    """Raise ``UsageError``, with the numbers, where a test would be clipped or stopped however well it went."""
    rig = f"rig '{config['rig'].get('name')}'"
    need, trajectory = need_of(config), f"{rig}: trajectory '{config['trajectory'].get('name')}'"
    if need.tracked:
        _check_arm(need, limits, trajectory)
    _check_pump(need, config["pump"]["lead_mm_per_rev"], wiring, limits, trajectory)
    _check_drives(config, wiring, limits, rig)


def _check_arm(need: Need, limits: Limits, where: str) -> None:
    farthest = max(need.lowest_arm, need.highest_arm, key=abs)
    if abs(farthest) > limits.arm_deg:
        raise UsageError(f"{where} turns the arm to {farthest:.4g} deg, limits.arm_deg stops it at {limits.arm_deg:g} deg")
    if abs(need.first_arm) > limits.tracking_deg:
        raise UsageError(
            f"{where} begins at {need.first_arm:.4g} deg, where the arm is not: "
            f"limits.tracking_deg stops it at {limits.tracking_deg:g} deg"
        )


def _check_pump(need: Need, lead: float, wiring: Wiring, limits: Limits, where: str) -> None:
    output = wiring.outputs["pump"]
    for motor, arm in zip(need.motor, (need.lowest_arm, need.highest_arm), strict=True):
        volts, travel = motor * DEGREE * output.volts_per_unit, motor / 360.0 * lead
        walls = []
        if wiring.quantity == "position" and output.within(volts) != volts:
            end = output.within(volts) / (DEGREE * output.volts_per_unit)
            walls.append((end, f"outputs.pump ends at {end:.0f} deg ({output.within(volts):g} V; {volts:.2f} V needed)"))
        if abs(travel) > limits.pump_travel_mm:
            end = limits.pump_travel_mm / lead * 360.0
            walls.append((end, f"limits.pump_travel_mm stops it at {end:.0f} deg ({limits.pump_travel_mm:g} mm)"))
        if walls:
            most = max(0.0, min(abs(end) for end, _ in walls) - abs(need.offset)) / need.per_arm
            adjusted = f" and {abs(need.offset):.0f} deg for the pressure adjustment" if need.offset else ""
            raise UsageError(
                f"{where} needs the pump motor at {motor:.0f} deg ({travel:.2f} mm): "
                f"{need.per_arm:.4g} deg for each of the {arm:.4g} deg of the reference{adjusted}. "
                f"{'; '.join(text for _, text in walls)}. "
                f"With this rig the reference may go to about {most:.0f} deg"
            )


def _check_drives(config: Mapping[str, Any], wiring: Wiring, limits: Limits, where: str) -> None:
    procedure = config["procedure"]
    speed, pressure = procedure["preload_speed_mm_per_s"], procedure["preload_mpa"]
    asked = {"preload": (speed * 1e-3, f"procedure.preload_speed_mm_per_s={speed:g}")}
    amplitude = float((config["controller"].get("dither") or {}).get("amplitude_v") or 0.0)
    if wiring.quantity == "voltage" or "dither" in wiring.outputs:
        shaken = "pump" if wiring.quantity == "voltage" else "dither"
        asked[shaken] = (amplitude, f"controller.dither.amplitude_v={amplitude:g}")
    for name, (value, said) in asked.items():
        output = wiring.outputs[name]
        volts = value * output.volts_per_unit
        if any(output.within(side) != side for side in (volts, -volts)):
            raise UsageError(
                f"{where}: {said} needs {-abs(volts):.4g} to {abs(volts):.4g} V, "
                f"outputs.{name} gives {output.lowest_v:g} to {output.highest_v:g} V"
            )
    if pressure > limits.pressure_high_mpa:
        raise UsageError(
            f"{where}: procedure.preload_mpa is {pressure:g}, "
            f"limits.pressure_high_mpa stops it at {limits.pressure_high_mpa:g} MPa"
        )
    back = config["rig"].get("return_speed_mm_per_s") or 0.0
    if back > limits.pump_speed_mm_per_s:
        raise UsageError(
            f"{where}: return_speed_mm_per_s is {back:g}, "
            f"limits.pump_speed_mm_per_s stops it at {limits.pump_speed_mm_per_s:g} mm/s"
        )


def check_test(config: Mapping[str, Any]) -> None:
    """Raise ``UsageError`` where wiring or limits are incomplete or out of reach of the test; nothing is touched."""
    interlock_of(config)
    check_reach(config, read_wiring(config), read_limits(config))
