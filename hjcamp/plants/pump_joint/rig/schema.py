"""What the groups ``rig`` and ``backend`` may hold.

A limit that guards people or glass must be a number within the bounds given here; no configuration can pass them.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, field_validator, model_validator

from hjcamp.schema import Group, between, needs

COUNTS = (4, 10_000_000)  # one pulse read four times; beyond the finest ring encoders
RANGE_V = (-10.0, 10.0)  # of the analog outputs
LEAST_SCALE = 1e-5  # with less, 10 V of a card of 16 bits are nothing that can be measured or moved


def _is_sign(value: int) -> int:
    if value not in (-1, 1):
        raise needs("-1 or 1")
    return value


def _names_a_file(value: str) -> str:
    if not value or set(value) & set("/\\\0"):
        raise needs("a name without / and \\")
    return value


Sign = Annotated[int, AfterValidator(_is_sign)]
FileName = Annotated[str, AfterValidator(_names_a_file)]


def channel() -> Any:
    """Declare the name of a terminal."""
    return Field(min_length=1)


class Backend(Group):
    """What makes the tests; ``paths`` belong to replay."""

    name: Literal["simulation", "nidaqmx", "replay"]
    paths: list[str] = Field(default=[])

    @field_validator("name")
    @classmethod
    def _makes_tests(cls, name: str) -> str:
        if name == "replay":
            raise needs("simulation or nidaqmx (hjcamp compare PATH --model MODEL drives a model along logs)")
        return name


class Sensors(Group):
    """Resolution and noise; the simulated rig has them, a real one is checked against them."""

    encoder_counts_per_turn: int = between(*COUNTS)
    pump_counts_per_turn: int = between(*COUNTS)
    pressure_noise_mpa: float = between(0.0, 1.0)
    pressure_range_mpa: float = between(0.01, 100.0, default=0.689)


class ScatterSettings(Group):
    """Standard deviations between and within simulated tests."""

    friction_between: float = between(0.0, 1.0)
    friction_within: float = between(0.0, 1.0)
    friction_correlation_s: float = between(1e-3, 1000.0, default=0.2)
    initial_pressure_mpa: float = between(0.0, 0.1)


class ConnectionSettings(Group):
    """The way to the device."""

    kind: Literal["in_process", "address", "driver"]
    address: str | None = None
    virtual: bool = True

    @model_validator(mode="after")
    def _has_an_address(self) -> ConnectionSettings:
        if self.kind == "address" and not self.address:
            raise needs("kind=address needs an address, such as localhost:31763")
        return self


class PressureSettings(Group):
    """A pressure sensor: p = ``mpa_per_v`` V + ``mpa_at_0v``, lost outside its voltages."""

    channel: str = channel()
    mpa_per_v: float = between(-100.0, 100.0)
    mpa_at_0v: float = between(-100.0, 100.0)
    lowest_v: float = between(-100.0, 100.0)
    highest_v: float = between(-100.0, 100.0)
    terminal: Literal["diff", "rse", "nrse", "default"] = "diff"

    @model_validator(mode="after")
    def _has_a_slope(self) -> PressureSettings:
        if abs(self.mpa_per_v) < LEAST_SCALE:
            raise needs(f"a slope other than 0, of {LEAST_SCALE:g} or more up or down,", "mpa_per_v")
        if self.lowest_v >= self.highest_v:
            raise needs("lowest_v must be below highest_v")
        return self


class EncoderSettings(Group):
    """An incremental encoder on a counter."""

    channel: str = channel()
    pulses_per_turn: int = between(1, COUNTS[1])
    decoding: Literal["x1", "x2", "x4"] = "x4"
    sign: Sign = 1


class Inputs(Group):
    """All sensors."""

    pressure1: PressureSettings
    pressure2: PressureSettings
    arm: EncoderSettings
    pump: EncoderSettings


class OutputSettings(Group):
    """An analog output; the safe voltage is the one at which its drive stands still."""

    channel: str = channel()
    lowest_v: float = between(*RANGE_V)
    highest_v: float = between(*RANGE_V)
    safe_v: float | Literal["hold"]

    @model_validator(mode="after")
    def _is_safe(self) -> OutputSettings:
        if not self.lowest_v < self.highest_v:
            raise needs("lowest_v must be below highest_v")
        safe = self.allowed_safe()
        if self.safe_v != safe:
            raise needs(f"{safe if safe == 'hold' else 0}, at which its drive stands still,", "safe_v")
        if safe == 0.0 and not self.lowest_v <= 0.0 <= self.highest_v:
            raise needs("lowest_v <= safe_v <= highest_v is needed")
        if abs(getattr(self, self.scale())) < LEAST_SCALE:
            raise needs(f"a scale other than 0, of {LEAST_SCALE:g} or more either way (with less nothing moves),", self.scale())
        return self

    def allowed_safe(self) -> float | str:
        """Return the one safe value."""
        return 0.0

    def scale(self) -> str:
        """Return the name of what turns a unit into volts."""
        raise NotImplementedError


class PumpOutput(OutputSettings):
    """The pump drive: it takes a position, or a voltage with which we close its loop."""

    quantity: Literal["position", "voltage"]
    v_per_deg: float | None = between(-10.0, 10.0, default=None)
    loop_v_per_deg: float = between(LEAST_SCALE, 10.0, default=1 / 36)
    sign: Sign = 1

    def allowed_safe(self) -> float | str:
        return "hold" if self.quantity == "position" else 0.0

    def scale(self) -> str:
        if self.quantity == "position" and self.v_per_deg is None:
            raise needs("a number (volts for one degree of the motor)", "v_per_deg")
        return "v_per_deg" if self.quantity == "position" else "sign"


class PreloadOutput(OutputSettings):
    """The speed of the preload drive."""

    v_per_mm_per_s: float = between(-100.0, 100.0)

    def scale(self) -> str:
        return "v_per_mm_per_s"


class DitherOutput(OutputSettings):
    """An auxiliary voltage input of a position drive."""

    v_per_v: float = between(-100.0, 100.0)

    def scale(self) -> str:
        return "v_per_v"


class Outputs(Group):
    """All drives."""

    pump: PumpOutput
    preload: PreloadOutput
    dither: DitherOutput | None = None


class WatchdogSettings(Group):
    """The device's own timer: at least two samples, at most what moves a pump at 60 mm/s by 6 mm."""

    enabled: bool
    timeout_ms: float = between(2.0, 100.0)


class LimitSettings(Group):
    """The limits of a test. Null (no limit) is for those that find a broken sensor or line, not for those that guard."""

    pressure_low_mpa: float = between(-0.2, 1.0)
    pressure_high_mpa: float = between(0.05, 2.0)
    pressure_sum_low_mpa: float | None = between(-0.4, 2.0)
    pump_travel_mm: float = between(0.1, 50.0)
    pump_speed_mm_per_s: float = between(0.1, 1200.0)
    pump_following_deg: float | None = between(1.0, 36000.0)
    pump_silent_deg: float | None = between(1.0, 36000.0)
    arm_silent_mm: float | None = between(0.01, 50.0)
    arm_silent_deg: float | None = between(0.1, 360.0, default=6.0)  # up to 1.7 in simulated tests with any effect
    arm_deg: float = between(1.0, 360.0)
    arm_speed_deg_per_s: float = between(1.0, 30000.0)
    tracking_deg: float | None = between(0.1, 720.0)
    missed_at_once: int = between(0, 100)
    missed_in_all: int = between(0, 1000)
    read_timeout_ms: float = between(2.0, 1000.0)
    output_clipped_ms: float | None = between(0.0, 100.0, default=0.0)  # not a single sample


class Rig(Group):
    """A rig; for a simulated test its sensors and scatter are enough."""

    name: FileName
    sensors: Sensors
    scatter: ScatterSettings
    connection: ConnectionSettings | None = None
    check_required: bool = True
    calibration: str | int | float | None = None
    output_timing: Literal["on_demand", "hardware_timed"] = "on_demand"
    return_speed_mm_per_s: float | None = between(0.1, 60.0, default=None)
    inputs: Inputs | None = None
    outputs: Outputs | None = None
    watchdog: WatchdogSettings | None = None
    interlock: str | None = None
    limits: LimitSettings | None = None


class WiredRig(Rig):
    """A rig for backend=nidaqmx describes its wiring and its limits (docs/rig.md)."""

    connection: ConnectionSettings
    inputs: Inputs
    outputs: Outputs
    limits: LimitSettings
