"""Where a hidden amplitude and a fitted parameter mean the same: how one is turned into the other, and what is left out."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from scipy.optimize import brentq

from hjcamp.effects.eccentricity import Eccentricity
from hjcamp.effects.leakage import Leakage
from hjcamp.effects.position_friction import PositionFriction

Values = Mapping[str, float]
JOINT_AREA = math.pi / 4 * 0.004**2
PULLEY_RADIUS = 0.00682 / 2
PUMP_AREA = math.pi / 4 * 0.00635**2
ARM_COUNT_DEG = 360 / 1024
GRAVITY = 9.81
SEAL_REFERENCE = 0.8e6
DITHER_VOLT = 1.2
CROSS_TURBULENT = 0.2e6
# Where the arm goes in the benchmark's campaigns, and what their lines hold.
VISITED = tuple(math.radians(angle) for angle in range(-80, 81, 2))
NUT = tuple(PULLEY_RADIUS * angle * JOINT_AREA / PUMP_AREA for angle in VISITED)
HELD, FLOW = 0.5e6, 0.14e-6
# Mean Coulomb friction as published, and the share of it that acts on the truth plant's arm.
FRICTION, ARM_SHARE = 4.12, 0.3


@dataclass(frozen=True)
class Amplitude:
    """One quantity, in the truth plant from its changed fields and base, in the model from fitted parameters.

    ``same`` is False where the laws differ, so that the number is nearly but not quite the same quantity. ``single``
    is the one parameter that it is proportional to, or empty: only then its interval can be judged.
    """

    text: str
    unit: str
    truth: Callable[[Values, Values], float]
    ours: Callable[[Values], float]
    same: bool = True
    single: str = ""


def _field(name: str) -> Callable[[Values, Values], float]:
    return lambda hidden, base: hidden[name]


def _one(text: str, unit: str, field: str, parameter: str, same: bool = True) -> Amplitude:
    return Amplitude(text, unit, _field(field), lambda fitted: fitted[parameter], same, parameter)


def _crossing(hidden: Values, base: Values) -> float:
    """Return the conductance at the pressure difference that friction asks for."""
    difference = 0.5 * (base["coulomb_positive"] + base["coulomb_negative"]) / JOINT_AREA
    return hidden["cross_conductance"] / math.sqrt(1 + difference / hidden.get("cross_turbulent_pressure", CROSS_TURBULENT))


def _leak(hidden: Values, base: Values) -> float:
    gap = 1 + hidden["leak_gap_growth"] * max(HELD - hidden["leak_opening_pressure"], 0.0)
    return hidden["leak_conductance"] * gap**3


def _our_leak(fitted: Values) -> float:
    return Leakage.loss(HELD, **fitted) / HELD


def _swing(curve: Callable[[float], float]) -> float:
    """Return half the change of a curve over the arm angles that are visited."""
    seen = [curve(angle) for angle in VISITED]
    return 0.5 * (max(seen) - min(seen))


def _share(level: Callable[[float], float]) -> float:
    """Return half the change of a level over the arm angles that are visited, over its middle."""
    seen = [level(angle) for angle in VISITED]
    return (max(seen) - min(seen)) / (max(seen) + min(seen))


def _friction(hidden: Values, base: Values) -> float:
    high, phase = hidden["angle_amplitude"], hidden["angle_phase"]
    if hidden.get("angle_form"):
        return _share(lambda at: 1 + 2 * high * math.exp(-0.5 * ((at - 0.15 * phase) / 0.2) ** 2))
    return _share(lambda at: 1 + high * (math.sin(at + phase) + 0.25 * math.sin(2 * at + 1.7 * phase)))


def _our_friction(fitted: Values) -> float:
    return _share(lambda at: PositionFriction.coulomb(1.0, at, **fitted))


def _play(hidden: Values, base: Values) -> float:
    worn = [1.3 / (1 + (nut / 0.6e-3) ** 2) if hidden.get("backlash_form") else 1.0 for nut in NUT]
    return hidden["backlash"] * sum(worn) / len(NUT)


def _our_play(fitted: Values) -> float:
    return fitted["play"] * sum(math.exp(-fitted["worn"] * nut * nut) for nut in NUT) / len(NUT)


def _stretch(hidden: Values, base: Values) -> float:
    load = ARM_SHARE * FRICTION / hidden["string_stiffness"]
    hard = hidden.get("string_hardening", 0.0)
    return brentq(lambda at: at * (0.5 + (at / hard) ** 2) - load, 0.0, 2.0 * load) if hard else load


def _our_stretch(fitted: Values) -> float:
    return fitted["compliance"] * fitted["friction_share"] * FRICTION


def _disc(hidden: Values, base: Values) -> float:
    share, phase = hidden["disc_eccentricity"], hidden["disc_phase"]
    oval = 0.4 * share * bool(hidden.get("disc_form"))
    return _swing(
        lambda at: (
            math.atan2(share * math.sin(at + phase), 1 + share * math.cos(at + phase)) + oval * math.sin(2 * (at + phase))
        )
    )


def _our_disc(fitted: Values) -> float:
    return _swing(lambda at: Eccentricity.reading(at, **fitted))


def _gain(hidden: Values, base: Values) -> float:
    return hidden.get("pressure1_gain", 1.0) / hidden.get("pressure2_gain", 1.0) - 1


def _offset(hidden: Values, base: Values) -> float:
    return hidden.get("pressure1_offset", 0.0) - hidden.get("pressure2_offset", 0.0)


def _counted(hidden: Values, base: Values) -> float:
    return math.radians(round(hidden["encoder_offset"] / ARM_COUNT_DEG) * ARM_COUNT_DEG)


AMPLITUDES = {
    "leakage": Amplitude(
        "outflow at 0.5 MPa over this pressure (above a threshold ours grows in a straight line, there as the cube of a gap)",
        "m^3/(s Pa)",
        _leak,
        _our_leak,
        False,
        "conductance",
    ),
    "cross_leakage": Amplitude(
        "conductance at the pressure difference of sliding",
        "m^3/(s Pa)",
        _crossing,
        lambda fitted: fitted["conductance"],
        False,
        "conductance",
    ),
    "entrained_air": _one("air of one line at atmosphere", "m^3", "air_volume", "air_volume"),
    "tubing_creep": _one(
        "delayed over immediate volume (ours: a part ten times as fast, there six)", "1", "creep_share", "share", False
    ),
    "line_resistance": Amplitude(
        "pressure drop along one line at 0.14 mL/s over this flow (ours: with its square, there with its power 1.75)",
        "Pa s/m^3",
        lambda hidden, base: hidden["tube_resistance"] + hidden.get("tube_turbulence", 0.0) * FLOW**0.75,
        lambda fitted: fitted["resistance"] + fitted["turbulent"] * FLOW,
        False,
        "resistance",
    ),
    "line_inertance": _one("inertance of one line", "kg/m^4", "tube_inertance", "inertance"),
    "payload_inertia": Amplitude(
        "mass at the pitch line",
        "kg",
        _field("load_mass"),
        lambda fitted: fitted["load_mass"] * (fitted["radius"] / PULLEY_RADIUS) ** 2,
    ),
    "pump_backlash": Amplitude(
        "mean play over the travel of the pump for the visited angles", "m", _play, _our_play, False, "play"
    ),
    "pressure_friction": _one("friction for each pascal of p1 + p2", "N/Pa", "seal_coefficient", "coefficient"),
    "position_friction": Amplitude(
        "half the change of friction over the visited angles, over its middle (ours has no second harmonic)",
        "1",
        _friction,
        _our_friction,
        False,
        "amplitude",
    ),
    "gravity_load": Amplitude(
        "weight at the pitch line",
        "N",
        _field("weight_force"),
        lambda fitted: fitted["load_mass"] * GRAVITY * fitted["radius"] / PULLEY_RADIUS,
    ),
    "string_elasticity": Amplitude(
        "stretch of the string under the arm's own friction (ours: linear)", "m", _stretch, _our_stretch, False, "compliance"
    ),
    "dither_relief": Amplitude(
        "share of static friction taken away by 1.2 V",
        "1",
        _field("dither_relief"),
        lambda fitted: fitted["static_relief"] * DITHER_VOLT,
        False,
        "static_relief",
    ),
    "encoder_eccentricity": Amplitude(
        "half the change of the error over the visited angles", "rad", _disc, _our_disc, False, "amplitude"
    ),
    "encoder_lag": _one("delay (ours: time constant)", "s", "encoder_delay", "lag"),
    "encoder_bias": Amplitude(
        "reading at true angle 0, in whole counts", "rad", _counted, lambda fitted: fitted["bias"], True, "bias"
    ),
    "pressure_offset": Amplitude(
        "difference of the sensors' offsets", "Pa", _offset, lambda fitted: fitted["offset1"] - fitted["offset2"]
    ),
    "pressure_gain": Amplitude(
        "ratio of the sensors' scales less one",
        "1",
        _gain,
        lambda fitted: (1 + fitted["error1"]) / (1 + fitted["error2"]) - 1,
    ),
}
LEFT_OUT = {
    "stribeck_friction": "rational fall of friction with memory there, exponential here",
    "presliding": "travel to full slip of four asperity groups there, mean compliance of three bristles here",
    "static_friction_ageing": "logarithm of the time at rest there, saturating growth here",
    "friction_drift": "goes with friction work there, with time and travel here",
}
# Base parameters that do not mean the same beside an effect of another law.
SHIFTED = {
    "static_friction_ageing": ("static_positive", "static_negative"),
    "tubing_creep": ("line_stiffness",),
}


def amplitude_of(line: Mapping[str, Any], effect: str) -> tuple[float, float, bool | None] | None:
    """Return (true, fitted, whether the 95 % interval covers it) of one hidden effect of a result; None where not comparable.

    The interval is None where the quantity is made of several parameters.
    """
    row = next((one for one in line["answer"]["candidates"] if one["effect"] == effect), None)
    entry = AMPLITUDES.get(effect)
    if row is None or entry is None:
        return None
    fitted = {name: one["value"] for name, one in row["parameters"].items()}
    if any(value is None for value in fitted.values()):
        return None
    true = entry.truth(line["truth"]["changes"][effect], line["truth"]["base"])
    ours = entry.ours(fitted)
    covered = None
    if entry.single:
        low, high = row["parameters"][entry.single]["ci95"]
        value = fitted[entry.single]
        if value and low is not None and high is not None:
            low, high = low * ours / value, high * ours / value
            covered = min(low, high) <= true <= max(low, high)
    return true, ours, covered


def true_base(line: Mapping[str, Any]) -> dict[str, float]:
    """Return the base parameters of the hidden rig by our names (SI), those that still mean the same beside its effects."""
    base, hidden = line["truth"]["base"], line["truth"]["changes"]
    found = {
        f"{kind}_{way}": base[f"{kind}_{way}"] for kind in ("static", "coulomb", "viscous") for way in ("positive", "negative")
    }
    mean = 0.5 * (base["stiffness1"] + base["stiffness2"])
    found["line_stiffness"] = mean
    found["stiffness_asymmetry"] = (base["stiffness1"] - base["stiffness2"]) / mean
    found["moving_mass"] = base["slider_mass"] + base["arm_mass"]
    if "pressure_friction" in hidden:
        # our friction is that at 0 Pa, theirs that at their reference
        shift = hidden["pressure_friction"]["seal_coefficient"] * SEAL_REFERENCE
        for kind in ("static", "coulomb"):
            for way in ("positive", "negative"):
                found[f"{kind}_{way}"] -= shift
    left_out = {name for effect in hidden for name in SHIFTED.get(effect, ())}
    return {name: value for name, value in found.items() if name not in left_out}
