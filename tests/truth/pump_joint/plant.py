"""The physical parameters of one hidden rig, all SI, and the geometry of the joint (thesis chapters 3 and 4)."""

import math
from typing import NamedTuple

import numpy as np

PUMP_AREA = math.pi / 4 * 0.00635**2
JOINT_AREA = math.pi / 4 * 0.004**2
PULLEY_RADIUS = 0.00682 / 2
PISTON_PER_PUMP_RADIAN = 0.001 / (2 * math.pi)
COMMAND_PER_ARM_ANGLE = 8.5
TUBE_INERTANCE = 1000 * 0.3 / (math.pi / 4 * 0.00269**2)
ATMOSPHERE = 101.3e3
VAPOUR = -99e3


class Plant(NamedTuple):
    """One rig: what a bench would measure with infinite patience. Every field is a float in SI units."""

    # pump servo: amplifier lag, motor drag, motor gain (m/s^2/V), position and speed gains, dead time
    amplifier_rate: float = 150.0
    motor_drag: float = 95.0
    motor_gain: float = 0.684
    position_gain: float = 21490.0
    speed_gain: float = 209.0
    dead_time: float = 0.002
    # lines: Pa/m^3 each, then what hides in them
    stiffness1: float = 2.57e13
    stiffness2: float = 2.57e13
    air_volume: float = 0.0
    air_exponent: float = 1.0
    creep_share: float = 0.0
    creep_time: float = 0.6
    creep_fast_share: float = 0.2
    creep_fast_ratio: float = 6.0
    leak_conductance: float = 0.0
    leak_opening_pressure: float = 0.45e6
    leak_gap_growth: float = 1.0 / 0.12e6
    cross_conductance: float = 0.0
    cross_turbulent_pressure: float = 0.2e6
    tube_resistance: float = 0.0
    tube_turbulence: float = 0.0
    tube_inertance: float = 0.0
    kink_resistance: float = 0.0
    kink_angle: float = 0.35
    stiffness_decay: float = 0.0
    # what holds the contact: 0 asperities, 1 bristles, 2 a force smooth in speed, 3 a sharp sign (friction.py)
    contact_law: float = 0.0
    # friction: positive then negative direction
    static_positive: float = 7.20
    coulomb_positive: float = 5.27
    viscous_positive: float = 23.5
    static_negative: float = 4.03
    coulomb_negative: float = 2.97
    viscous_negative: float = 17.2
    weakening_speed: float = 0.12e-3
    weakening_form: float = 0.0
    bristle_travel: float = 2e-6
    angle_amplitude: float = 0.0
    angle_phase: float = 0.0
    angle_form: float = 0.0
    seal_coefficient: float = 0.0
    seal_reference_pressure: float = 0.8e6
    seal_form: float = 0.0
    ageing_per_decade: float = 0.0
    ageing_form: float = 0.0
    warming_share: float = 0.0
    warming_form: float = 0.0
    warming_energy: float = 0.08
    dither_relief: float = 0.0
    detent_force: float = 0.0
    detent_angle: float = 0.0
    # moving parts and what hangs on them
    slider_mass: float = 0.0132
    arm_mass: float = 0.0053
    load_mass: float = 0.0
    string_stiffness: float = 0.0
    string_hardening: float = 0.0
    string_friction_share: float = 0.3
    weight_force: float = 0.0
    weight_phase: float = 0.0
    spring_stiffness: float = 0.0
    spring_centre: float = 0.0
    spring_form: float = 0.0
    stop_stiffness: float = 0.0
    stop_angle: float = 0.6
    vibration_force: float = 0.0
    vibration_frequency: float = 7.3
    vibration_phase: float = 0.0
    # pump carriage
    backlash: float = 0.0
    backlash_form: float = 0.0
    carriage_friction: float = 16.0
    forward_gain_error: float = 0.0
    # sensors
    disc_eccentricity: float = 0.0
    disc_phase: float = 0.0
    disc_form: float = 0.0
    encoder_delay: float = 0.0
    encoder_form: float = 0.0
    encoder_offset: float = 0.0
    pressure1_offset: float = 0.0
    pressure2_offset: float = 0.0
    offset_fading: float = 0.0
    pressure1_gain: float = 1.0
    pressure2_gain: float = 1.0
    gain_form: float = 0.0


BASE_FIELDS = (
    "static_positive",
    "coulomb_positive",
    "viscous_positive",
    "static_negative",
    "coulomb_negative",
    "viscous_negative",
    "stiffness1",
    "stiffness2",
    "slider_mass",
    "arm_mass",
)


def draw_rig(seed: int) -> Plant:
    """Draw another rig's own base parameters: friction +-30 %, stiffness +-15 %, mass +-10 %, servo a few percent."""
    random = np.random.default_rng([seed, 101])
    published = Plant()

    def spread(value: float, share: float) -> float:
        return float(value * (1 + random.uniform(-share, share)))

    level = random.uniform(-0.2, 0.2)
    changes: dict[str, float] = {}
    for direction in ("positive", "negative"):
        coulomb = spread(getattr(published, f"coulomb_{direction}") * (1 + level), 0.08)
        ratio = getattr(published, f"static_{direction}") / getattr(published, f"coulomb_{direction}")
        changes[f"coulomb_{direction}"] = coulomb
        changes[f"static_{direction}"] = coulomb * (1 + (ratio - 1) * (1 + random.uniform(-0.3, 0.3)))
        changes[f"viscous_{direction}"] = spread(getattr(published, f"viscous_{direction}"), 0.3)
    stiffness = spread(published.stiffness1, 0.15)
    changes["stiffness1"] = spread(stiffness, 0.004)
    changes["stiffness2"] = spread(stiffness, 0.004)
    mass = 1 + random.uniform(-0.1, 0.1)
    changes["slider_mass"] = published.slider_mass * mass
    changes["arm_mass"] = published.arm_mass * mass
    for name, share in (("motor_gain", 0.04), ("motor_drag", 0.05), ("amplifier_rate", 0.04), ("dead_time", 0.12)):
        changes[name] = spread(getattr(published, name), share)
    changes["weakening_speed"] = spread(published.weakening_speed, 0.3)
    changes["carriage_friction"] = spread(published.carriage_friction, 0.25)
    return published._replace(**changes)
