"""The five plants of the study, their campaigns, and what is hidden in them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from hjcamp.commands.shared.plant_template import TEMPLATE

HEAD = """from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, contact, outside, path, sensor, sqrt, store

"""
AXIS = TEMPLATE.format(title="Axis").replace(
    'Measured("encoder", of="position")', 'Measured("encoder", of="position", noise=2e-6)'
)
SPINDLE = '''"""A motor turns a spindle in a bearing."""
{head}
class Spindle(Plant):
    """A motor turns a spindle against the friction of its bearing."""
    speed = State("rad/s", typical=200.0)
    voltage = Input("V", typical=5.0)
    gain = Parameter("N*m/V", 0.02)
    inertia = Parameter("kg*m^2", 4e-4, (1e-5, 1e-2), base=True)
    coulomb = Parameter("N*m", 0.01, (1e-4, 0.1), base=True)
    viscous = Parameter("N*m*s", 3e-4, (0.0, 1e-2), base=True)
    speed_rpm = Measured("tachometer", of="speed", noise=0.2)
    period = 0.01

    @staticmethod
    def equations(state, parameter, drive, rate):
        """Give the rate of every state."""
        torque = actuator(parameter.gain * drive.voltage)
        load = outside("N*m")
        friction = contact(state.speed, coulomb=parameter.coulomb, viscous=parameter.viscous)
        rate.speed = body(torque + load - friction, mass=parameter.inertia, load=load)
        tachometer = sensor(state.speed)
'''
TANKS = '''"""Two tanks, one above the other."""
{head}
class Tanks(Plant):
    """A pump fills the upper one of two tanks, which runs out into the lower one."""
    upper = State("V", typical=5.0, low=0.0, start=2.0)
    lower = State("V", typical=5.0, low=0.0, start=2.0)
    pump = Input("V", typical=3.0)
    k1 = Parameter("V**0.5/s", 0.05, (1e-4, 1.0), "log-uniform", base=True)
    k3 = Parameter("V**0.5/s", 0.05, (1e-4, 1.0), "log-uniform", base=True)
    k4 = Parameter("1/s", 0.05, (1e-4, 1.0), "log-uniform", base=True)
    upper_v = Measured("gauge_above", of="upper", noise=5e-3)
    lower_v = Measured("gauge", of="lower", noise=5e-3)
    period = 1.0

    @staticmethod
    def equations(state, parameter, drive, rate):
        inflow = actuator(parameter.k4 * drive.pump)
        between = path(parameter.k1 * sqrt(state.upper), upstream=state.upper, downstream=state.lower)
        outflow = path(parameter.k3 * sqrt(state.lower), upstream=state.lower)
        rate.upper = store(inflow - between)
        rate.lower = store(between - outflow)
        gauge_above = sensor(state.upper)
        gauge = sensor(state.lower)
'''
OSCILLATOR = '''"""A mass on a spring that a coil pulls."""
{head}
class Oscillator(Plant):
    """A coil pulls a mass on a spring with a damper."""
    position = State("m", typical=0.02)
    velocity = State("m/s", typical=0.2)
    current = Input("A", typical=1.0)
    pull = Parameter("N/A", 10.0)
    mass = Parameter("kg", 1.0, (0.1, 10.0), base=True)
    stiffness = Parameter("N/m", 400.0, (40.0, 4e3), base=True)
    damping = Parameter("N*s/m", 4.0, (0.1, 40.0), base=True)
    position_mm = Measured("gauge", of="position", noise=5e-6)
    period = 0.005

    @staticmethod
    def equations(state, parameter, drive, rate):
        force = actuator(parameter.pull * drive.current)
        load = outside("N")
        held = parameter.stiffness * state.position + parameter.damping * state.velocity
        rate.position = state.velocity
        rate.velocity = body(force + load - held, mass=parameter.mass, load=load, position=state.position)
        gauge = sensor(state.position)
'''
OVEN = '''"""An oven whose air heats its wall."""
{head}
class Oven(Plant):
    """A heater warms the air of an oven, which warms the wall, which loses to the room."""
    air = State("K", typical=50.0)
    wall = State("K", typical=30.0)
    power = Input("W", typical=200.0)
    to_air = Parameter("K/J", 2e-3, (1e-4, 1e-1), "log-uniform", base=True)
    to_wall = Parameter("1/s", 0.01, (1e-4, 1.0), "log-uniform", base=True)
    to_room = Parameter("1/s", 0.005, (1e-5, 1.0), "log-uniform", base=True)
    air_k = Measured("probe_air", of="air", noise=0.02)
    wall_k = Measured("probe_wall", of="wall", noise=0.02)
    period = 2.0

    @staticmethod
    def equations(state, parameter, drive, rate):
        heat = actuator(parameter.to_air * drive.power)
        inner = path(parameter.to_wall * (state.air - state.wall), upstream=state.air, downstream=state.wall)
        outer = path(parameter.to_room * state.wall, upstream=state.wall)
        rate.air = store(heat - inner)
        rate.wall = store(inner - outer)
        probe_air = sensor(state.air)
        probe_wall = sensor(state.wall)
'''


@dataclass(frozen=True)
class Rig:
    """A plant: its file, what it needs to be run, the conditions of a full campaign (the first one begins a hunt), what is hidden."""

    name: str
    text: str
    lines: tuple[str, ...]
    conditions: tuple[tuple[str, ...], ...]
    hidden: tuple[str, ...]
    outside: str


def _loop(kp: float, kd: float) -> tuple[str, ...]:
    return ("controller=plain_pid", f"controller.kp={kp:g}", f"controller.kd={kd:g}")


def _levels(unit: str, seconds: float, *values: float) -> tuple[str, ...]:
    parts = ",".join(f"{{to_{unit}: {value:g}, in: {0.02 * seconds:g}, law: linear}},{{rest: {seconds:g}}}" for value in values)
    return ("trajectory=segments", f"trajectory.segments=[{parts}]")


def _sine(unit: str, size: float, hz: float, seconds: float) -> tuple[str, ...]:
    return (
        "trajectory=sine",
        f"trajectory.amplitude_{unit}={size:g}",
        f"trajectory.frequency_hz={hz:g}",
        f"trajectory.duration={seconds:g}",
    )


def _triangle(unit: str, size: float, hz: float, seconds: float) -> tuple[str, ...]:
    return ("trajectory=triangle", *_sine(unit, size, hz, seconds)[1:])


GIVEN = ("controller=given",)
RIGS = (
    Rig(
        "axis",
        AXIS,
        _loop(2000, 40),
        (
            _sine("m", 0.1, 0.5, 4),
            _triangle("m", 0.08, 0.25, 8),
            _sine("m", 0.02, 1.5, 4),
            _triangle("m", 0.03, 0.1, 10),
            _sine("m", 0.15, 0.25, 8),
        ),
        ("spring", "constant_force", "quadratic_drag", "viscous_asymmetry"),
        "position_friction",
    ),
    Rig(
        "spindle",
        SPINDLE,
        GIVEN,
        (
            _levels("v", 3, 4, -4, 2),
            _sine("v", 5, 0.2, 10),
            _levels("v", 2, 1, 2, 3, 4, 5),
            _triangle("v", 5, 0.1, 10),
            _sine("v", 3, 1, 10),
        ),
        ("quadratic_drag", "coulomb_asymmetry", "constant_force", "viscous_asymmetry"),
        "dead_band",
    ),
    Rig(
        "tanks",
        TANKS,
        GIVEN,
        (
            _levels("v", 150, 3, 1),
            _levels("v", 100, 4, 2, 0),
            _levels("v", 60, 1, 2, 3, 4, 2),
            _levels("v", 200, 5, 1),
            _levels("v", 40, 3, 0, 3, 0),
        ),
        ("leakage_at_lower", "cross_leakage", "flow_exponent_at_outflow", "sensor_gain_at_gauge"),
        "second_store_at_lower",
    ),
    Rig(
        "oscillator",
        OSCILLATOR,
        GIVEN,
        (
            _levels("a", 1, 1, -1, 0.5),
            _sine("a", 1, 1, 5),
            _levels("a", 1, 0.5, 1, 1.5, 0),
            _sine("a", 0.5, 3, 5),
            _triangle("a", 1.5, 0.5, 6),
        ),
        ("cubic_spring", "hard_stop", "constant_force", "soft_stop"),
        "maxwell_element",
    ),
    Rig(
        "oven",
        OVEN,
        GIVEN,
        (
            _levels("w", 200, 300, 0),
            _levels("w", 150, 100, 300, 200),
            _levels("w", 300, 200, 400),
            _levels("w", 60, 300, 0, 300, 0),
            _levels("w", 400, 300),
        ),
        ("leakage_at_wall", "flow_exponent_at_outer", "sensor_drift_at_probe_air", "cross_leakage"),
        "second_store_at_wall",
    ),
)
REPETITIONS_OF_A_HUNT, REPETITIONS = 2, 3


@dataclass(frozen=True)
class Case:
    """One rig with something hidden: an effect by name, or nothing; ``outside``: the diagnosis does not know that effect."""

    rig: Rig
    hidden: str
    outside: bool

    @property
    def name(self) -> str:
        """How the ledger calls it."""
        return f"{self.rig.name}/{self.hidden or 'nothing'}{'/outside' if self.outside else ''}"

    @property
    def right(self) -> tuple[str, list[str]]:
        """The verdict that is right, and its names."""
        if not self.hidden:
            return "nothing_missing", []
        return ("outside_library", []) if self.outside else ("effect", [self.hidden])


def cases() -> Iterator[Case]:
    """Yield the thirty cases, one of each plant after the other, so that a part of them is a fair one."""
    for k in range(6):
        for one in RIGS:
            yield Case(one, (*one.hidden, one.outside, "")[k], k == 4)


def write_plant(rig: Rig, folder: Path) -> None:
    """Write the plant's file."""
    (folder / "plants").mkdir(parents=True, exist_ok=True)
    (folder / "plants" / f"{rig.name}.py").write_text(rig.text.replace("{head}", HEAD), encoding="utf-8")
