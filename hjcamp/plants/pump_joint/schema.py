"""What the hardware groups and the procedure of the pump joint may hold, in the practical units of their names.

The ranges are generous: a joint of any size that still is one. A line of glass or thin plastic is what ends them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from pydantic import Field, model_validator

from hjcamp.plants.pump_joint.hardware import transfer_function
from hjcamp.schema import Group, between, checked, needs

HIGHEST_MPA = 2.0  # half of what bursts the thinnest line, LDPE of 2.69 x 3.99 mm
LOWEST_MPA = -0.1  # gauge: vacuum


class TransferFunction(Group):
    """Piston travel over command: numerator e^(-delay s) / (s^3 + a2 s^2 + a1 s + a0)."""

    numerator_mm_per_deg: float = between(1e-6, 1e12)
    a2: float = between(1e-3, 1e6)
    a1: float = between(1e-3, 1e9)
    a0: float = between(1e-3, 1e12)
    delay_ms: float = between(0.0, 1000.0)


class GainSet(Group):
    """Gains of one direction: arm in, arm out, then scaled."""

    kp: float = between(0.0, 1e4)
    ki: float = between(0.0, 1e6)
    kd: float = between(0.0, 1e3)


class Gains(Group):
    """Gains that were tuned for one pump."""

    positive: GainSet
    negative: GainSet


class Bench(Group):
    """What the drive and the limits of the virtual rig are with this pump."""

    v_per_deg: float = between(1e-5, 1.0)
    travel_mm: float = between(0.1, 50.0)
    following_deg: float = between(1.0, 36000.0)
    silent_deg: float = between(1.0, 36000.0)
    arm_silent_mm: float = between(0.01, 50.0)


class Pump(Group):
    """The motor-cylinder pump."""

    name: str
    bore_mm: float = between(0.1, 100.0)
    moving_mass_g: float = between(0.1, 1e6)
    lead_mm_per_rev: float = between(0.01, 100.0)
    speed_limit_mm_per_s: float = between(0.1, 1e4)
    acceleration_limit_mm_per_s2: float | None = between(1.0, 1e7)
    arm_scale: float | None = between(0.1, 1000.0, default=None)
    gains: Gains | None = None
    bench: Bench | None = None
    transfer_function: dict[str, TransferFunction] = Field(min_length=1)


class Amplifier(Group):
    """The amplifier of the pump motor."""

    name: str
    full_scale_v: float = between(0.1, 1000.0)
    command_deg_per_v: float = between(0.01, 36000.0, default=36.0)


class Water(Group):
    """What is in the lines."""

    density_kg_per_m3: float = between(100.0, 2e4)
    viscosity_pa_s: float = between(1e-6, 100.0)
    bulk_modulus_mpa: float = between(1.0, 1e5)


class Tubing(Group):
    """One line from the pump to the joint."""

    name: str
    stiffness_mpa_per_mm3: float = between(1e-5, 1e3)
    inner_diameter_mm: float = between(0.01, 100.0)
    outer_diameter_mm: float = between(0.01, 200.0)
    length_mm: float = between(1.0, 1e5)
    youngs_modulus_mpa: float = between(0.1, 1e6)
    poisson_ratio: float = between(0.0, 0.5)
    air_fraction: float | None = between(0.0, 0.5)
    water: Water

    @model_validator(mode="after")
    def _has_a_wall(self) -> Tubing:
        if self.inner_diameter_mm >= self.outer_diameter_mm:
            raise needs("inner_diameter_mm must be below outer_diameter_mm")
        return self


class String(Group):
    """The string round the pulley."""

    turns: float = between(0.0, 100.0)
    friction_coefficient: float = between(0.0, 10.0)
    minimum_tension_n: float = between(0.0, 1000.0)


class Joint(Group):
    """The slider-pulley joint; a bore of 0.001 mm blocks it."""

    name: str
    bore_mm: float = between(1e-3, 100.0)
    stroke_mm: float = between(0.1, 1000.0)
    pulley_pitch_diameter_mm: float = between(0.1, 1000.0)
    moving_mass_g: float = between(0.01, 1e5)
    vapour_pressure_mpa: float = between(-0.2, 0.0)
    travel_stop_deg: float | None = between(1.0, 3600.0)
    string: String


class Side(Group):
    """Friction at the sliders in one direction."""

    static_n: float = between(0.0, 1000.0)
    coulomb_n: float = between(0.0, 1000.0)
    viscous_ns_per_mm: float = between(0.0, 100.0)


class Friction(Group):
    """Friction of both directions."""

    name: str
    positive: Side
    negative: Side


class Payload(Group):
    """A mass on the arm."""

    name: str
    mass_g: float = between(0.0, 1e4)
    radius_mm: float = between(0.1, 1000.0)


class Orientation(Group):
    """How the plane of the arm stands."""

    name: str


class Initial(Group):
    """Pressures that the lines are set to directly; null: preload and adjustment make them."""

    pressure1_mpa: float | None = between(LOWEST_MPA, HIGHEST_MPA, default=None)
    pressure2_mpa: float | None = between(LOWEST_MPA, HIGHEST_MPA, default=None)


class Adjustment(Group):
    """The initial pressure difference in the direction in which the trajectory starts."""

    enabled: bool
    positive_mpa: float = between(0.0, HIGHEST_MPA)
    negative_mpa: float = between(0.0, HIGHEST_MPA)
    speed_mm_per_s: float = between(1e-3, 60.0)


class ProcedureSettings(Group):
    """The phases of a test; a test log has 1000 samples a second."""

    name: str
    sampling_hz: Literal[1000]
    start_preload_mpa: float = between(LOWEST_MPA, HIGHEST_MPA)
    preload_mpa: float = between(0.0, HIGHEST_MPA)
    preload_speed_mm_per_s: float = between(1e-3, 60.0)
    initial: Initial = Initial()
    adjustment: Adjustment
    rest_ms: float = between(0.0, 600_000.0)
    release_mpa: float = between(0.0, HIGHEST_MPA)
    phase_limit_s: float = between(0.1, 600.0)
    warn_below_mpa: float = between(-1.0, HIGHEST_MPA)


GROUPS: dict[str, type[Group]] = {
    "pump": Pump,
    "amplifier": Amplifier,
    "tubing": Tubing,
    "joint": Joint,
    "friction": Friction,
    "payload": Payload,
    "orientation": Orientation,
    "procedure": ProcedureSettings,
}


def check_hardware(config: Mapping[str, Any]) -> None:
    """Raise ``UsageError`` for a value of the hardware or the procedure that this plant cannot have."""
    for name, schema in GROUPS.items():
        checked(schema, config[name], name)
    transfer_function(config)
