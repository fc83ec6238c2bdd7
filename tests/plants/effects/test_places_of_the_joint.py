"""What the pump joint needs and every plant may use, against limits that can be solved by hand; no kernel is compiled."""

from __future__ import annotations

from math import sin
from pathlib import Path

import numpy as np
import pytest
from test_generic_physics import model, seen

from hjcamp.effects import find_effect, library_of, load_effects
from hjcamp.errors import UsageError
from hjcamp.known_plants import find_plant
from hjcamp.model.checks.place_checks import PlainModel
from hjcamp.model.checks.plant_checks import check_plant
from hjcamp.model.declare.parameter import Input
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.vocabulary import read_vocabulary
from hjcamp.model.run.inputs_along import inputs_along, with_rates

AREA, MASS, WEIGHT, RADIUS, COULOMB, VISCOUS, PERIOD = 1e-3, 8.0, 8.0 * 9.81, 0.1, 5.0, 30.0, 1e-3

pytestmark = pytest.mark.usefixtures("folder")


@pytest.mark.parametrize("speed", [0.1, -0.2])
def test_a_line_loses_with_its_flow_and_with_the_square_of_it(speed: float) -> None:
    made = model("press", "flow_resistance", resistance=2e7, turbulent=1e12)
    flow = AREA * speed
    lost = 2e7 * flow + 1e12 * flow * abs(flow)
    found = made.signals({"pressure": 1e5, "speed": speed})
    assert found["end"] == pytest.approx(1e5 - lost)
    assert found["rub_push"] == pytest.approx(AREA * (1e5 - lost) - WEIGHT)


def test_a_column_takes_its_inertance_times_the_rate_of_its_flow() -> None:
    rate, inertance = 3.0, 5e5
    course = [{"pressure": 1e5, "speed": rate * k * PERIOD} for k in range(60)]
    found = seen(model("press", "flow_inertance", inertance=inertance, rise=4e-3), course, "end")
    assert found[0] == 1e5 and found[-1] == pytest.approx(1e5 - inertance * AREA * rate, rel=1e-3)


def test_a_transmission_stays_behind_by_what_it_carries() -> None:
    made = model("press", "transmission_compliance", compliance=0.02)
    carried = (COULOMB + VISCOUS * 0.1) * RADIUS
    found = made.signals({"travel": 0.05, "speed": 0.1, "direction": 1.0})
    assert found["dial"] == pytest.approx(0.05 / RADIUS - 0.02 * carried)


def test_what_is_driven_by_a_velocity_waits_for_the_flank() -> None:
    turns = 50
    speeds = [0.1 if k < turns else -0.1 for k in range(3 * turns)]
    found = seen(model("press", "moving_backlash", play=2e-3), [{"pump_speed": speed} for speed in speeds], "driver")
    # half the play from its middle, the whole of it after the reversal; in the first sample nothing tells how long it lasts
    moved = np.cumsum(found) * PERIOD
    assert moved[turns] == pytest.approx(0.1 * turns * PERIOD - 1e-3, abs=2.1e-4)
    stood = sum(speed == pytest.approx(0.0, abs=1e-9) for speed in found[turns:])
    assert stood == pytest.approx(2e-3 / (0.1 * PERIOD), abs=1)
    assert found[-1] == pytest.approx(-0.1)


@pytest.mark.parametrize(
    ("volts", "static", "coulomb"), [(0.0, 1.0, 1.0), (2.0, 0.6, 0.6), (-2.0, 0.6, 0.6), (9.0, 0.05, 0.05)]
)
def test_dither_takes_its_share_of_friction(volts: float, static: float, coulomb: float) -> None:
    found = model("press", "dither_relief", static_relief=0.2, coulomb_relief=0.1).signals({"shaking": volts, "speed": 0.1})
    assert found["rub_static"] == pytest.approx(COULOMB * static)
    # without a static friction of its own the contact slides no harder than it holds
    assert found["rub_coulomb"] == pytest.approx(COULOMB * coulomb)


def test_a_weight_hangs_on_the_angle_that_a_travel_turns() -> None:
    made = model("press", "pendulum_weight", moment=40.0, rest_angle=0.3)
    assert made.signals({"travel": 0.05})["extra"] == pytest.approx(-40.0 * sin(0.5 - 0.3))
    assert "pendulum_weight" not in load_effects(plant="axis") and "pendulum_weight" in load_effects(plant="rotor")


def test_an_added_mass_slows_what_it_is_added_to_and_is_no_other_name_of_a_base_parameter() -> None:
    made = model("press", "added_mass", added=2.0)
    here = {"pressure": 2e5, "speed": 0.1, "direction": 1.0}
    net = AREA * 2e5 - WEIGHT - COULOMB - VISCOUS * 0.1
    assert made.rates(here)["speed"] == pytest.approx(net / (MASS + 2.0))
    with pytest.raises(UsageError, match="a base parameter of plant axis is the mass"):
        find_effect("added_mass", "axis")


# --- The load that a contact carries where none is declared


@pytest.mark.parametrize(
    ("pressure", "load"),
    [(1e5, 1e5 * AREA), (0.5e5, WEIGHT), (-0.2e5, WEIGHT + 0.2e5 * AREA), (0.0, WEIGHT)],
)
def test_a_contact_carries_the_greater_of_what_acts_in_either_direction(pressure: float, load: float) -> None:
    made = model("press", "load_friction", coefficient=0.1)
    found = made.signals({"pressure": pressure, "speed": 0.1, "direction": 1.0})
    assert found["rub_coulomb"] == pytest.approx(COULOMB + 0.1 * load)
    assert found["rub_static"] == pytest.approx(COULOMB + 0.1 * load)


SERVO = """
from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, contact, outside, sensor, sin

class Servo(Plant):
    '''A motor lifts a pendulum.'''

    angle = State("rad")
    speed = State("rad/s")
    given = Input("V")
    gain = Parameter("N*m/V", 0.5, base=True)
    back = Parameter("N*m*s", 0.1, base=True)
    inertia = Parameter("kg*m^2", 0.01, base=True)
    moment = Parameter("N*m", 0.4)
    viscous = Parameter("N*m*s", 0.02, base=True)
    angle_rad = Measured("encoder", of="angle")

    @staticmethod
    def equations(state, parameter, drive, rate):
        volts = actuator(drive.given)
        torque = (parameter.gain * volts - parameter.back * state.speed) / 1.0
        weight = parameter.moment * sin(state.angle)
        extra = outside("N*m")
        {before}friction = contact(state.speed, viscous=parameter.viscous{given})
        {after}rate.angle = state.speed
        rate.speed = body({force} - friction, parameter.inertia, load=extra)
        encoder = sensor(state.angle)
"""
LOADS = [
    # forces, lines before and after the contact, what the contact is given, its load at torque 0.5 and weight 0.4 sin 1
    ("torque - weight", "", "", "", max(0.5, 0.4 * sin(1.0))),
    ("-weight + torque", "", "", "", max(0.5, 0.4 * sin(1.0))),
    ("torque - weight + extra", "", "", "", max(0.5, 0.4 * sin(1.0))),
    ("net", "net = torque - weight\n        ", "", "", max(0.5, 0.4 * sin(1.0))),
    ("torque + weight", "", "", "", 0.5 + 0.4 * sin(1.0)),
    ("torque - weight - parameter.viscous * state.speed", "", "", "", max(0.5, 0.4 * sin(1.0))),
    ("torque - weight", "", "", ", load=weight", 0.4 * sin(1.0)),
    ("torque", "", "", "", None),
    ("torque + extra", "", "", "", None),
    ("torque - late", "", "late = 0.1 * weight\n        ", "", None),
    ("torque - weight", "friction_load = 2.0 * weight\n        ", "", "", None),
]


@pytest.mark.parametrize(("force", "before", "after", "given", "load"), LOADS)
def test_which_forces_load_a_contact(folder: Path, force: str, before: str, after: str, given: str, load: float | None) -> None:
    (folder / "plants" / "servo.py").write_text(SERVO.format(force=force, before=before, after=after, given=given))
    plant = find_plant("servo")
    check_plant(plant)
    assert ("load_friction" in load_effects(plant="servo")) == (load is not None)
    if load is not None:
        here = {"angle": 1.0, "given": 1.0, "speed": 0.0, "direction": 1.0}
        found = model("servo", "load_friction", coefficient=0.1).signals(here)
        assert found["friction_coulomb"] == pytest.approx(0.1 * load)


def test_a_load_that_is_found_changes_nothing_that_does_not_ask_for_it(folder: Path) -> None:
    (folder / "plants" / "servo.py").write_text(SERVO.format(force="torque - weight", before="", after="", given=""))
    plant = find_plant("servo")
    body = PlainModel(plant).composition.body(["d = d_speed"])
    assert "friction_load" in read_vocabulary(plant).signals and not any("friction_load" in line for line in body)


# --- Places of one make


def test_gauges_of_one_make_err_together_each_by_its_own_amount() -> None:
    names = set(load_effects(plant="two_pumps"))
    assert {"sensor_gain_at_gauges", "sensor_offset_at_gauges", "sensor_drift_at_gauges", "second_store"} <= names
    made = model("two_pumps", "sensor_gain_at_gauges", gain_error_gauge1=0.1, gain_error_gauge2=-0.2)
    found = made.signals({"pressure1": 2e5, "pressure2": 3e5})
    assert (found["gauge1"], found["gauge2"]) == pytest.approx((2.2e5, 2.4e5))


def test_lines_of_one_make_creep_alike() -> None:
    made = model("two_pumps", "second_store", conductance=1e-12, delay=0.1)
    found = made.signals(
        {"pressure1": 2e5, "pressure2": 3e5, "second_store.beside_line1": 0.0, "second_store.beside_line2": 0.0}
    )
    assert (found["line1_loss"], found["line2_loss"]) == pytest.approx((2e-7, 3e-7))


def test_each_names_parameters() -> None:
    from hjcamp.model.declare.effect import Effect
    from hjcamp.model.declare.parameter import Parameter

    with pytest.raises(UsageError, match="unknown parameter 'gains' in effect Wrong, each"):

        class Wrong(Effect):
            """Nothing."""

            acts_on, together, each = "sensor", True, ("gains",)
            gain = Parameter("1", 0.1, off=0.0)

            @staticmethod
            def reading(gain):  # type: ignore[no-untyped-def]
                return gain


# --- Rates of inputs


def test_the_rate_of_an_input_is_how_it_goes_on() -> None:
    plant = find_plant("press")
    given = inputs_along(plant, 4, pump=np.array([0.0, 0.01, 0.03, 0.02]), shaking=1.0)
    found = with_rates(plant, given, 1e-3)
    names = plant.sampled_inputs()
    assert found[:, names.index("pump_speed")] == pytest.approx([10.0, 20.0, -10.0, 0.0])
    assert np.array_equal(np.delete(found, names.index("pump_speed"), 1), np.delete(given, names.index("pump_speed"), 1))
    assert with_rates(find_plant("axis"), given, 1e-3) is given
    assert "pump_speed" not in plant.given_inputs() and "pump_speed" in plant.sampled_inputs()


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ('Input("m/s", rate_of="pomp")', r"input that runs on \(hold='linear'\) 'pomp'.*did you mean 'pump'"),
        ('Input("m/s", rate_of="shaking")', r"input that runs on \(hold='linear'\) 'shaking'"),
        ('Input("m/s", rate_of="pump", field="pump_m_s")', "neither a field nor a hold"),
        ('Input("1/s", rate_of="pump")', r"'pump_speed' is in 1/s, but the rate of 'pump' is in m/s"),
    ],
)
def test_what_is_no_rate_is_refused(folder: Path, given: str, said: str) -> None:
    path = folder / "plants" / "press.py"
    text = path.read_text().replace('Input("m/s", typical=0.1, rate_of="pump")', given)
    path.write_text(text.replace("drive.pump_speed", "parameter.radius * drive.pump_speed") if "1/s" in given else text)
    with pytest.raises(UsageError, match=said):
        check_plant(find_plant("press"))


def test_a_sound_press_and_none_that_is_simulated(folder: Path) -> None:
    from hjcamp.backends.plant_simulation import simulator_of
    from hjcamp.configuration.composer import Composer

    check_plant(find_plant("press"))
    assert "load" in read_vocabulary(find_plant("press")).ports["rub"].names
    assert issubclass(find_plant("press"), Plant) and Input("m").rate_of == ""
    assert "flow_resistance" in library_of(find_plant("press")).effects
    with pytest.raises(UsageError, match="'pump_speed' is the rate of 'pump'"):
        simulator_of(Composer().compose(["plant=press"]).config)
