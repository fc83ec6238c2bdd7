"""What a plant's file could say: that a state lies far from 0, that a body has no contact, and lines that are misspelt."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from hjcamp.commands.any_plant.plant_hints import early_inputs, far_states, without_contact, without_position
from hjcamp.errors import UsageError
from hjcamp.model.declare.parameter import Input, Measured, Parameter, State
from hjcamp.model.declare.plant import Plant
from hjcamp.plant import actuator, body, contact, outside, sensor


class Wheel(Plant):
    """A wheel on a motor that warms."""

    speed = State("rad/s", typical=8.0)
    warmth = State("K", typical=1.0)
    voltage = Input("V", typical=3.0)
    gain = Parameter("N*m/V", 0.02)
    inertia = Parameter("kg*m^2", 1e-3, (1e-6, 1.0), base=True)
    viscous = Parameter("N*m*s", 4e-3, (0.0, 1.0), base=True)
    pace = Parameter("1/s", 0.1)
    speed_rad_per_s = Measured("tacho", of="speed")

    @staticmethod
    def equations(state, parameter, drive, rate):  # type: ignore[no-untyped-def]
        command = actuator(drive.voltage)
        load = outside("N*m")
        push = parameter.gain * command + load - parameter.viscous * state.speed
        rate.warmth = -parameter.pace * state.warmth
        rate.speed = body(push, mass=parameter.inertia, load=load)
        tacho = sensor(state.speed)  # noqa: F841


class Braked(Wheel):
    """The same with a contact."""

    @staticmethod
    def equations(state, parameter, drive, rate):  # type: ignore[no-untyped-def]
        command = actuator(drive.voltage)
        load = outside("N*m")
        friction = contact(state.speed, viscous=parameter.viscous)
        rate.warmth = -parameter.pace * state.warmth
        rate.speed = body(parameter.gain * command + load - friction, mass=parameter.inertia, load=load)
        tacho = sensor(state.speed)  # noqa: F841


def test_a_body_without_a_contact_is_told_where_its_velocity_drives_what_is_missing() -> None:
    [said] = without_contact(Wheel, [{"signal": "speed"}, {"signal": "time"}])
    assert "brake = contact(state.speed)" in said
    assert not without_contact(Wheel, [{"signal": "command_demand"}])
    assert not without_contact(Braked, [{"signal": "speed"}])


class Turned(Wheel):
    """The same with an angle."""

    angle = State("rad", typical=8.0)

    @staticmethod
    def equations(state, parameter, drive, rate):  # type: ignore[no-untyped-def]
        command = actuator(drive.voltage)
        rate.angle = state.speed
        rate.warmth = -parameter.pace * state.warmth
        rate.speed = body(
            parameter.gain * command - parameter.viscous * state.speed, mass=parameter.inertia, position=state.angle
        )
        tacho = sensor(state.speed)  # noqa: F841


@pytest.mark.parametrize(
    ("ci95", "hold", "told"),
    [((-0.009, -0.007), "previous", True), ((-0.006, -0.004), "previous", True), ((-0.004, -0.002), "previous", False),
     ((-0.009, 0.001), "previous", False), ((None, None), "previous", False), ((-0.009, -0.007), "linear", False)],
)  # fmt: skip
def test_an_input_that_acts_before_its_log_is_told(ci95: tuple[float, float], hold: str, told: bool) -> None:
    made = type("Made", (Wheel,), {"__doc__": "x", "voltage": Input("V", typical=3.0, hold=hold)})
    said = early_inputs(made, {"delay.voltage": {"value": -0.0082, "ci95": ci95}}, 0.01)
    assert [one.startswith("voltage acts 0.82 samples earlier") for one in said] == ([True] if told else [])


def test_a_body_without_a_position_is_told() -> None:
    [said] = without_position(Wheel)
    assert "where the body of speed stands" in said and "rate.position = state.speed" in said
    assert without_position(Turned) == []


@pytest.mark.parametrize(("warm", "told"), [(9.0, False), (46.0, True)])
def test_states_that_lie_far_from_where_they_begin_are_told(warm: float, told: bool) -> None:
    windows = SimpleNamespace(
        layout=SimpleNamespace(measured=SimpleNamespace(plant=Wheel)),
        sizes=np.array([8.0, 1.0]),
        unseen=np.array([False, True]),
        starts=np.array([[800.0, warm], [800.0, -warm]]),
    )
    said = far_states(windows)  # type: ignore[arg-type]
    assert bool(said) == told
    assert not said or ("46 K" in said[0] and "speed" not in said[0])


@pytest.mark.parametrize(
    ("name", "value", "meant"), [("perod", 0.02, "period"), ("lop", "foreign", "loop"), ("contoled", "speed", "controlled")]
)
def test_a_misspelt_line_of_a_plant_is_refused_with_what_it_means(name: str, value: object, meant: str) -> None:
    with pytest.raises(UsageError, match=f"'{name}'; did you mean '{meant}'"):
        type("Odd", (Wheel,), {"__doc__": "A wheel.", "__module__": __name__, name: value})
    # what is like no line of a plant is the file's own
    type("Own", (Wheel,), {"__doc__": "A wheel.", "__module__": __name__, "TEETH": 12, "table": (1, 2)})
