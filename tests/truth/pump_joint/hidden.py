"""What can be hidden in a rig: one entry for each effect, its strengths and what it changes in the plant."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from truth.pump_joint.plant import PULLEY_RADIUS, TUBE_INERTANCE

STRENGTHS = ("weak", "medium", "strong")
Changes = dict[str, float]


@dataclass(frozen=True)
class HiddenEffect:
    """One hidden effect: the quantity that sets its strength (SI), three levels, and the plant fields it sets.

    `drivers` is empty for an effect of the library; else it lists what a diagnosis may name, in the contract's words.
    """

    name: str
    quantity: str
    unit: str
    levels: tuple[float, float, float]
    build: Callable[[float, np.random.Generator], Changes]
    drivers: tuple[str, ...] = ()

    def level(self, strength: str | float) -> float:
        """Return the amplitude for a strength's name or a number (SI)."""
        if isinstance(strength, str):
            if strength not in STRENGTHS:
                raise ValueError(f"strength {strength!r}: give one of {', '.join(STRENGTHS)}, or a number in SI")
            return self.levels[STRENGTHS.index(strength)]
        return float(strength)


def _plain(field: str, **more: float) -> Callable[[float, np.random.Generator], Changes]:
    return lambda amplitude, random: {field: amplitude, **more}


def _phase(field: str, phase: str, low: float, high: float) -> Callable[[float, np.random.Generator], Changes]:
    return lambda amplitude, random: {field: amplitude, phase: float(random.uniform(low, high))}


def _signed(field: str, positive_share: float = 0.5) -> Callable[[float, np.random.Generator], Changes]:
    return lambda amplitude, random: {field: amplitude if random.random() < positive_share else -amplitude}


def _leakage(amplitude: float, random: np.random.Generator) -> Changes:
    return {
        "leak_conductance": amplitude,
        "leak_opening_pressure": float(random.uniform(0.40e6, 0.52e6)),
        "leak_gap_growth": 1.0 / float(random.uniform(0.2e6, 0.35e6)),
    }


def _pressure_offset(amplitude: float, random: np.random.Generator) -> Changes:
    line = 1 + int(random.integers(2))
    return {f"pressure{line}_offset": amplitude * float(random.choice([-1.0, 1.0]))}


def _pressure_gain(amplitude: float, random: np.random.Generator) -> Changes:
    line = 1 + int(random.integers(2))
    return {f"pressure{line}_gain": 1 + amplitude * float(random.choice([-1.0, 1.0]))}


def _stray_spring(amplitude: float, random: np.random.Generator) -> Changes:
    return {"spring_stiffness": amplitude, "spring_centre": float(random.uniform(-0.35, 0.35)) * PULLEY_RADIUS}


def _weight(amplitude: float, random: np.random.Generator) -> Changes:
    return {"weight_force": amplitude, "weight_phase": float(random.choice([0.0, np.pi / 2]) + random.normal(0, 0.15))}


def _vibration(amplitude: float, random: np.random.Generator) -> Changes:
    return {
        "vibration_force": amplitude,
        "vibration_frequency": float(random.uniform(5.0, 11.0)),
        "vibration_phase": float(random.uniform(0, 2 * np.pi)),
    }


_LIBRARY = [
    HiddenEffect("pump_backlash", "play of the piston carriage", "m", (14e-6, 40e-6, 95e-6), _plain("backlash")),
    HiddenEffect("leakage", "conductance of each line", "m^3/(s Pa)", (0.9e-16, 2.2e-16, 5.5e-16), _leakage),
    HiddenEffect(
        "cross_leakage",
        "conductance between the lines",
        "m^3/(s Pa)",
        (1e-15, 2.8e-15, 6.5e-15),
        _plain("cross_conductance"),
    ),
    HiddenEffect("entrained_air", "air per line at atmosphere", "m^3", (2.5e-9, 7e-9, 18e-9), _plain("air_volume")),
    HiddenEffect(
        "tubing_creep",
        "creep share of the wall's compliance",
        "1",
        (0.1, 0.28, 0.6),
        _phase("creep_share", "creep_time", 0.3, 1.2),
    ),
    HiddenEffect("line_resistance", "resistance of each line", "Pa s/m^3", (2.3e10, 6.5e10, 1.4e11), _plain("tube_resistance")),
    HiddenEffect(
        "line_inertance",
        "inertance of each line",
        "kg/m^4",
        (2 * TUBE_INERTANCE, 8 * TUBE_INERTANCE, 30 * TUBE_INERTANCE),
        _plain("tube_inertance"),
    ),
    HiddenEffect("stribeck_friction", "weakening speed", "m/s", (0.25e-3, 0.5e-3, 3e-3), _plain("weakening_speed")),
    HiddenEffect("presliding", "travel to full slip", "m", (30e-6, 110e-6, 260e-6), _plain("bristle_travel")),
    HiddenEffect(
        "position_friction",
        "amplitude over the arm angle",
        "1",
        (0.045, 0.11, 0.25),
        _phase("angle_amplitude", "angle_phase", -np.pi, np.pi),
    ),
    HiddenEffect("pressure_friction", "friction per pressure sum", "N/Pa", (0.8e-6, 2e-6, 4.3e-6), _plain("seal_coefficient")),
    HiddenEffect(
        "static_friction_ageing",
        "share of static friction per decade of rest",
        "1",
        (0.12, 0.27, 0.42),
        _plain("ageing_per_decade"),
    ),
    HiddenEffect("friction_drift", "share of all dry friction", "1", (0.07, 0.19, 0.42), _signed("warming_share", 0.3)),
    HiddenEffect("gravity_load", "weight at the pitch line", "N", (0.27, 0.55, 1.2), _weight),
    HiddenEffect("payload_inertia", "effective mass at the pitch line", "kg", (0.045, 0.16, 0.4), _plain("load_mass")),
    HiddenEffect("string_elasticity", "stiffness of the string", "N/m", (7e4, 1.8e4, 8e3), _plain("string_stiffness")),
    HiddenEffect("dither_relief", "share of static friction", "1", (0.1, 0.25, 0.5), _plain("dither_relief")),
    HiddenEffect(
        "encoder_eccentricity",
        "eccentricity over track radius",
        "1",
        (0.016, 0.038, 0.085),
        _phase("disc_eccentricity", "disc_phase", -np.pi, np.pi),
    ),
    HiddenEffect("encoder_lag", "delay", "s", (1.3e-3, 3.2e-3, 7e-3), _plain("encoder_delay")),
    HiddenEffect("encoder_bias", "offset", "deg", (0.36, 1.05, 2.46), _signed("encoder_offset")),
    HiddenEffect("pressure_offset", "offset of one sensor", "Pa", (14e3, 32e3, 70e3), _pressure_offset),
    HiddenEffect("pressure_gain", "gain error of one sensor", "1", (0.03, 0.07, 0.15), _pressure_gain),
]

_OUTSIDE = [
    HiddenEffect("stray_spring", "stiffness at the pitch line", "N/m", (75.0, 170.0, 400.0), _stray_spring, ("arm_angle",)),
    HiddenEffect(
        "soft_stop",
        "stiffness at the pitch line",
        "N/m",
        (150.0, 400.0, 950.0),
        _phase("stop_stiffness", "stop_angle", 0.45, 0.6),
        ("arm_angle",),
    ),
    HiddenEffect("outside_vibration", "force", "N", (0.12, 0.33, 1.2), _vibration, ("time",)),
    HiddenEffect(
        "sticking_spot",
        "added friction at one angle",
        "N",
        (0.9, 2.1, 3.2),
        _phase("detent_force", "detent_angle", -0.45, 0.45),
        ("arm_angle",),
    ),
    HiddenEffect(
        "stiffness_drift",
        "loss of stiffness per second",
        "1/s",
        (0.006, 0.015, 0.032),
        _plain("stiffness_decay"),
        ("time", "repetition"),
    ),
    HiddenEffect(
        "pump_gain_error",
        "gain error, forward against backward",
        "1",
        (0.0009, 0.0022, 0.005),
        _signed("forward_gain_error"),
        ("pump_velocity", "direction", "time", "pump_position"),
    ),
    HiddenEffect(
        "hose_kink",
        "resistance of line 1 per squared radian beyond 20 deg",
        "Pa s/m^3",
        (2.5e11, 8e11, 2e12),
        _phase("kink_resistance", "kink_angle", 0.2, 0.4),
        ("arm_angle", "arm_velocity"),
    ),
]

EFFECTS: dict[str, HiddenEffect] = {effect.name: effect for effect in (*_LIBRARY, *_OUTSIDE)}
LIBRARY_NAMES = tuple(effect.name for effect in _LIBRARY)
OUTSIDE_NAMES = tuple(effect.name for effect in _OUTSIDE)
