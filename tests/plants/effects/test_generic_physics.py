"""Each generic effect against a limit that can be solved by hand, on plants of a user's; no kernel is compiled."""

from __future__ import annotations

from itertools import pairwise
from math import exp, log, pi, sin, sqrt, tanh
from pathlib import Path

import pytest

from hjcamp.effects import find_effect, load_effects
from hjcamp.known_plants import find_plant
from hjcamp.model.checks.place_checks import PlainModel

COULOMB, VISCOUS, MASS, GAIN = 20.0, 200.0, 95.0, 35.0
MOVING = {"velocity": 0.1, "direction": 1.0, "voltage": 2.0}
BACK = {"velocity": -0.1, "direction": -1.0, "voltage": -2.0}
REST = {"velocity": 0.0, "direction": 0.0, "voltage": 2.0}
MILLI = 1e-3

pytestmark = pytest.mark.usefixtures("folder")


def model(plant: str, name: str, **values: float) -> PlainModel:
    """Return a plant with one effect at these values."""
    effect = find_effect(name, plant)
    assert set(values) <= set(effect.parameters)
    return PlainModel(find_plant(plant), (effect,), {f"{name}.{key}": value for key, value in values.items()})


def seen(made: PlainModel, course: list[dict[str, float]], signal: str) -> list[float]:
    """Return a signal along a course of places, one each sample; what is not given is 0."""
    zero = dict.fromkeys([*made.plant.states, "direction"], 0.0)
    timed = [zero | {"time": k * made.plant.period} | place for k, place in enumerate(course)]
    return [float(x) for x in made.along(timed)[:, list(made.composition.vocabulary.signals).index(signal)]]


def lateness(made: PlainModel, rising: str, signal: str, scale: float = 1.0) -> float:
    """Return by how many seconds a signal is behind what rises by one each second."""
    ramp = [k * made.plant.period for k in range(200)]
    return ramp[-1] - seen(made, [{rising: value} for value in ramp], signal)[-1] / scale


# --- Actuators


@pytest.mark.parametrize(("voltage", "force"), [(2.0, 60.0), (-2.0, -60.0), (0.1, 0.0), (-0.1, 0.0)])
def test_a_dead_band_takes_its_width_from_both_directions(voltage: float, force: float) -> None:
    assert model("axis", "dead_band", width=10.0).signals({"voltage": voltage})["force"] == pytest.approx(force)


@pytest.mark.parametrize(("voltage", "force"), [(10.0, 50.0), (-10.0, -50.0), (1.0, 35.0)])
def test_saturation_holds_what_is_delivered(voltage: float, force: float) -> None:
    assert model("axis", "saturation", limit=50.0).signals({"voltage": voltage})["force"] == pytest.approx(force)


def test_a_soft_limit_is_the_sharp_one_far_away_and_less_where_it_bends() -> None:
    def delivered(force: float) -> float:
        return model("axis", "saturation", limit=50.0, softness=0.5).signals({"voltage": force / GAIN})["force"]

    assert delivered(5e4) == pytest.approx(50.0, rel=1e-4) and delivered(-50.0) == pytest.approx(-50.0 / sqrt(2.0))
    # of small commands the series of u / sqrt(1 + u^2)
    assert delivered(5.0) == pytest.approx(5.0 * (1.0 - 0.5 * 0.1**2), rel=1e-4)


@pytest.mark.parametrize("dead_share", [0.0, 0.25, 0.5])
def test_a_late_actuator_and_a_late_sensor_are_late_by_their_time(dead_share: float) -> None:
    command = model("axis", "command_delay", delay=10 * MILLI, dead_share=dead_share)
    assert lateness(command, "voltage", "force", GAIN) == pytest.approx(10 * MILLI, rel=2e-3)
    sensor = model("axis", "sensor_lag", lag=10 * MILLI, dead_share=dead_share)
    assert lateness(sensor, "position", "encoder") == pytest.approx(10 * MILLI, rel=2e-3)


def test_a_lag_answers_a_step_by_its_time_constant() -> None:
    steps = [{"voltage": 0.0}] + [{"voltage": 1.0}] * 30
    found = seen(model("axis", "command_delay", delay=10 * MILLI, dead_share=0.0), steps, "force")
    # the step itself is a ramp of one sample here
    assert 1.0 - found[21] / GAIN == pytest.approx(exp(-2.0) * (1.0 - exp(-0.1)) / 0.1, rel=5e-3)


@pytest.mark.parametrize("share", [0.0, 0.5])
def test_what_builds_up_late_does_so_behind_all_that_bends_a_command(share: float) -> None:
    steps = [{"voltage": 0.0}] + [{"voltage": 1.0}] * 40
    values = {"action_lag.lag": 10 * MILLI, "action_lag.dead_share": share, "dead_band.width": 10.0}
    effects = [find_effect(name, "axis") for name in ("dead_band", "action_lag")]
    made = [PlainModel(find_plant("axis"), tuple(order), values) for order in (effects, effects[::-1])]
    found = [seen(one, steps, "force") for one in made]
    assert found[0] == found[1]
    # the band is taken from the step, and what is left of it builds up by the lag's own time
    missing = [GAIN - 10.0 - force for force in found[0][1:]]
    time = 10 * MILLI * (1.0 - share)
    assert [after / before for before, after in pairwise(missing)] == pytest.approx([exp(-MILLI / time)] * 39, rel=1e-3)


# --- Bodies


def added(name: str, place: dict[str, float], **values: float) -> float:
    """Return the force that an effect adds to the carriage of the axis, seen in its acceleration."""
    made, plain = model("axis", name, **values), PlainModel(find_plant("axis"))
    forces = [MASS * one.rates(MOVING | place)["velocity"] for one in (made, plain)]
    assert forces[1] == pytest.approx(GAIN * 2.0 - COULOMB - VISCOUS * (MOVING | place)["velocity"])
    return forces[0] - forces[1]


@pytest.mark.parametrize("position", [-0.3, 0.0, 0.2])
def test_forces_that_depend_on_position(position: float) -> None:
    here = {"position": position}
    assert added("constant_force", here, strength=5.0) == pytest.approx(5.0)
    assert added("spring", here, stiffness=30.0, rest_position=0.1) == pytest.approx(-30.0 * (position - 0.1))
    assert added("cubic_spring", here, stiffness=3e3, rest_position=0.1) == pytest.approx(-3e3 * (position - 0.1) ** 3)


def test_a_maxwell_element_is_a_spring_at_first_and_lets_go_with_time() -> None:
    made = model("axis", "maxwell_element", stiffness=30.0, relaxation=50 * MILLI)
    plain = seen(PlainModel(find_plant("axis")), [{"position": 0.0}], "friction_push")[0]
    held = seen(made, [{"position": 0.0}, *[{"position": 0.2}] * 200], "friction_push")
    ramp = (1.0 - exp(-1.0 / 50.0)) * 50.0
    for k in (1, 51, 200):
        assert held[k] - plain == pytest.approx(-30.0 * 0.2 * ramp * exp(-(k - 1) / 50.0), rel=1e-3)
    # drawn out slowly it is a damper of k tau
    slow = seen(made, [{"position": 0.01 * k * MILLI} for k in range(600)], "friction_push")
    assert slow[-1] - plain == pytest.approx(-30.0 * 50 * MILLI * 0.01, rel=1e-3)


@pytest.mark.parametrize(("position", "force"), [(0.25, -50.0), (0.2, 0.0), (-0.1, 0.0), (-0.15, 50.0)])
def test_a_soft_stop_pushes_back_at_both_ends(position: float, force: float) -> None:
    found = added("soft_stop", {"position": position}, free_travel=0.15, centre=0.05, stiffness=1e3)
    assert found == pytest.approx(force, abs=1e-9)


@pytest.mark.parametrize(("end", "position", "velocity", "force"), [
    (0.2, 0.25, 0.1, -50.0 * 1.2), (0.2, 0.25, -0.1, -50.0 * 0.8), (0.2, 0.25, -0.6, 0.0), (0.2, 0.1, 0.1, 0.0),
    (0.2, -0.9, -0.1, 0.0), (-0.2, -0.25, -0.1, 50.0 * 1.2), (-0.2, 0.9, 0.1, 0.0),
])  # fmt: skip
def test_a_hard_stop_is_met_at_one_end_and_never_pulls(end: float, position: float, velocity: float, force: float) -> None:
    found = added("hard_stop", {"position": position, "velocity": velocity}, end=end, stiffness=1e3, loss=2.0)
    assert found == pytest.approx(force, abs=1e-9)


def test_a_hard_stop_gives_back_what_hunt_and_crossley_say() -> None:
    # For small losses the speed after over the speed before is 1 - 2/3 of loss times speed.
    force = find_effect("hard_stop", "axis").terms["load"].function
    stiffness, loss, speed, step = 1e4, 0.05, 1.0, 1e-5
    x, v = 0.0, speed
    for _ in range(10**6):
        v += step * force(x, v, 0.0, stiffness, loss) / MASS
        x += step * v
        if x <= 0.0:
            break
    assert -v / speed == pytest.approx(1.0 - 2.0 / 3.0 * loss * speed, abs=2e-3)


def test_a_pendulum_hangs_at_its_rest_angle() -> None:
    for angle in (-1.0, 0.3, 2.0):
        made = model("rotor", "pendulum_weight", moment=0.2, rest_angle=0.3)
        assert made.signals({"angle": angle})["load"] == pytest.approx(-0.2 * sin(angle - 0.3))


# --- Contacts


def test_asymmetries_have_the_sign_of_the_motion_and_at_rest_that_of_the_push() -> None:
    made = model("axis", "coulomb_asymmetry", asymmetry=0.2)
    for place, factor in ((MOVING, 1.2), (BACK, 0.8), (REST, 1.2), (REST | {"voltage": -2.0}, 0.8)):
        found = made.signals(place)
        assert found["friction_static"] == found["friction_coulomb"] == pytest.approx(COULOMB * factor)
    made = model("axis", "viscous_asymmetry", asymmetry=0.2)
    for place, factor in ((MOVING, 1.2), (BACK, 0.8)):
        assert made.signals(place)["friction_viscous"] == pytest.approx(VISCOUS * factor)


def test_drag_grows_with_the_square_of_the_speed_against_the_motion() -> None:
    made, plain = model("axis", "quadratic_drag", drag=1e3), PlainModel(find_plant("axis"))
    for speed in (0.1, 0.2, -0.2):
        place = {"velocity": speed, "direction": 1.0 if speed > 0.0 else -1.0}
        apart = made.signals(place)["friction"] - plain.signals(place)["friction"]
        assert apart == pytest.approx(1e3 * speed * abs(speed))


def test_viscous_friction_is_proportional_to_the_speed_and_none_at_rest() -> None:
    made, plain = model("dry_wheel", "viscous_friction", coefficient=1e-4), PlainModel(find_plant("dry_wheel"))
    for speed in (0.0, 10.0, -20.0):
        place = {"speed": speed, "direction": 1.0 if speed > 0.0 else -1.0}
        apart = made.signals(place)["rub"] - plain.signals(place)["rub"]
        assert apart == pytest.approx(1e-4 * speed)
        assert made.signals(place)["rub_static"] == plain.signals(place)["rub_static"]


def test_the_excess_of_static_friction_fades_with_speed() -> None:
    made = model("axis", "stribeck_excess", excess=8.0, stribeck_speed=0.01)
    assert made.signals(REST)["friction_static"] == pytest.approx(COULOMB + 8.0)
    for speed, left in ((0.0, 8.0), (0.01, 8.0 / exp(1.0)), (0.1, 0.0)):
        assert made.signals(MOVING | {"velocity": speed})["friction_coulomb"] == pytest.approx(COULOMB + left)


def test_friction_falls_from_static_to_coulomb_where_the_plant_has_both() -> None:
    made = model("rotor", "stribeck_friction", stribeck_velocity=0.5)
    for speed, friction in ((0.0, 0.05), (0.5, 0.03 + 0.02 / exp(1.0)), (50.0, 0.03)):
        assert made.signals({"speed": speed, "direction": 1.0})["rub_coulomb"] == pytest.approx(friction)


@pytest.mark.parametrize("pressure", [-8e4, 0.0, 1e5])
def test_friction_grows_with_the_load_on_either_side(pressure: float) -> None:
    found = model("rotor", "load_friction", coefficient=0.1).signals({"pressure": pressure, "direction": 1.0})
    assert found["rub_coulomb"] == pytest.approx(0.03 + 0.1 * abs(1e-6 * pressure))
    assert found["rub_static"] == pytest.approx(0.05 + 0.1 * abs(1e-6 * pressure))


def test_friction_along_the_travel_and_with_time() -> None:
    made = model("axis", "position_friction", amplitude=0.5, period=0.2, phase=0.0)
    for position, factor in ((0.0, 1.0), (0.05, 1.5), (0.15, 0.5), (0.25, 1.5)):
        assert made.signals(MOVING | {"position": position})["friction_coulomb"] == pytest.approx(COULOMB * factor)
    for concentration, place in ((4.0, 0.05), (-4.0, 0.15)):
        made = model("axis", "position_friction", amplitude=0.5, period=0.2, phase=0.0, concentration=concentration)
        sign = 1.0 if concentration > 0.0 else -1.0
        for turn, share in ((0.0, 1.0), (0.25, 0.0), (0.5, -exp(-4.0))):
            seen_here = made.signals(MOVING | {"position": place + 0.2 * turn})["friction_coulomb"]
            assert seen_here == pytest.approx(COULOMB * (1.0 + sign * 0.5 * share))
        # half of a narrow bump's height at half the width of the normal curve of 1 / sqrt(k)
        half = made.signals(MOVING | {"position": place + 0.2 * sqrt(2.0 * log(2.0) / 4.0) / (2.0 * pi)})
        assert abs(half["friction_coulomb"] / COULOMB - 1.0) == pytest.approx(0.25, rel=0.06)
    made = model("axis", "position_friction", amplitude=0.5, viscous_amplitude=0.2, period=0.2, phase=0.0)
    found = made.signals(MOVING | {"position": 0.05})
    assert found["friction_viscous"] == pytest.approx(VISCOUS * 1.2) and found["friction_coulomb"] == pytest.approx(
        COULOMB * 1.5
    )
    made = model("axis", "friction_drift", drift=0.5, settling_time=0.2, pace=2.5)
    course = [{"time": k * MILLI} for k in range(100)]
    assert seen(made, course, "friction_viscous")[-1] == pytest.approx(VISCOUS)
    thin = model("axis", "friction_drift", drift=0.0, viscous_drift=-0.5, settling_time=0.2, pace=2.5)
    assert seen(thin, course, "friction_viscous")[-1] == pytest.approx(VISCOUS * (1 - 0.1 * (1 - exp(-0.099 / 0.2))))
    assert seen(made, course, "friction_static")[-1] == pytest.approx(COULOMB * (1 + 0.1 * (1 - exp(-0.099 / 0.2))))


@pytest.mark.parametrize(("speed", "share"), [(0.0, 0.0), (0.01, 1.0 - exp(-3.0)), (1.0, 1.0)])
def test_a_creeping_contact_holds_nothing_and_has_its_friction_above_the_creep_speed(speed: float, share: float) -> None:
    made = model("axis", "contact_creep", creep_speed=0.01)
    for sign in (1.0, -1.0):
        # the regime may be that of before the turn: the velocity counts
        found = made.signals({"velocity": sign * speed, "direction": 1.0, "voltage": 2.0})
        assert found["friction"] == pytest.approx(sign * (COULOMB * share + VISCOUS * speed))
        assert found["friction_locks"] == 0.0


@pytest.mark.parametrize("sharpness", [0.7, 1.0, 2.0, 4.0])
def test_most_of_a_creeping_friction_is_there_at_the_creep_speed_and_a_sharp_one_is_nearly_a_tanh(sharpness: float) -> None:
    made = model("axis", "contact_creep", creep_speed=0.01, sharpness=sharpness)

    def dry(speed: float) -> float:
        return float(made.signals({"velocity": speed, "direction": 1.0})["friction"] - VISCOUS * speed)

    assert dry(0.01) == pytest.approx(COULOMB * (1.0 - exp(-3.0)))
    if sharpness == 2.0:
        slope = sqrt(-log(1.0 - (1.0 - exp(-3.0)) ** 2)) / 0.01
        assert all(dry(x / slope) == pytest.approx(COULOMB * tanh(x), rel=0.05) for x in (0.1, 0.5, 1.0, 2.0))


def test_static_friction_ages_with_the_rest() -> None:
    made = model("axis", "static_friction_ageing", growth=0.4, half_time=0.05, rest_before=0.05)
    course = [REST | {"time": k * MILLI} for k in range(51)] + [MOVING | {"time": 0.051}, REST | {"time": 0.052}]
    found = seen(made, course, "friction_static")
    assert found[0] == pytest.approx(COULOMB * 1.2) and found[50] == pytest.approx(COULOMB * (1 + 0.4 * 2 / 3))
    assert found[-1] == pytest.approx(COULOMB * (1 + 0.4 / 51))


def test_bristles_are_springs_before_breakaway_and_slide_at_coulomb_friction() -> None:
    compliance = 1e-7
    made = model("axis", "presliding", compliance=compliance, fall_velocity=0.0025, lateness=16.0)
    # a push of a tenth of the friction is carried by a deflection of so much times the compliance
    start = made.begin(REST | {"voltage": 2.0 / GAIN})
    assert start[made.composition.held[0] + 1] == pytest.approx(compliance * 2.0)
    assert made.signals(REST | {"voltage": 2.0 / GAIN})["friction"] == pytest.approx(2.0)
    assert made.signals(REST)["friction_locks"] == 0.0
    sliding = [MOVING | {"time": k * MILLI} for k in range(300)]
    assert seen(made, sliding, "friction")[-1] == pytest.approx(COULOMB + VISCOUS * 0.1, rel=1e-3)


# --- Stores and paths


def test_a_second_store_beside_one_gives_back_what_it_took() -> None:
    period = find_plant("tanks").period
    made = model("tanks", "second_store_at_upper", conductance=0.01, delay=100.0 * period)
    found = seen(made, [{"upper": 2.0}, *[{"upper": 5.0}] * 400, *[{"upper": 2.0}] * 1000], "upper_loss")
    # of a step of 3 the flow is G times what the second store lacks; the step itself is a ramp of one sample here
    ramp = (1.0 - exp(-0.01)) / 0.01
    for k in (1, 100, 400):
        assert found[k] == pytest.approx(0.01 * 3.0 * ramp * exp(-0.01 * (k - 1)), rel=1e-3)
    # what went in comes out again: C = G tau of each unit of level
    taken = 0.01 * 3.0 * 100.0 * (1.0 - exp(-4.0))
    assert sum(found[:401]) == pytest.approx(taken, rel=0.01) and sum(found[401:]) == pytest.approx(-taken, rel=0.01)
    assert found[0] == 0.0


@pytest.mark.parametrize("caught", [0.0, 0.4, 1.0])
def test_what_spills_falls_into_the_tank_below(caught: float) -> None:
    place = {"upper": 7.0, "lower": 1.0, "pump": 3.0}
    made, plain = model("tanks", "spill_over", brim=6.0, spill=2.0, caught=caught), PlainModel(find_plant("tanks"))
    apart = {tank: made.rates(place)[tank] - plain.rates(place)[tank] for tank in ("upper", "lower")}
    assert apart == pytest.approx({"upper": -2.0, "lower": caught * 2.0})
    assert made.rates(place | {"upper": 5.0}) == plain.rates(place | {"upper": 5.0})


def test_half_a_power_more_makes_a_root_a_line() -> None:
    made = model("tanks", "flow_exponent_at_outflow", exponent=0.5, reference=1.0)
    for level in (0.0, 0.5, 4.0):
        assert made.signals({"upper": 1.0, "lower": level})["outflow"] == pytest.approx(0.05 * level)


def test_a_valve_holds_back_what_flows_against_it() -> None:
    made, plain = model("driver", "check_valve", blocked=0.75), PlainModel(find_plant("driver"))
    for voltage, left in ((3.0, 1.0), (-3.0, 0.25)):
        place = {"voltage": voltage, "speed": 0.0, "direction": 1.0}
        assert made.signals(place)["current"] == pytest.approx(left * plain.signals(place)["current"])
        assert plain.signals(place)["current"] == pytest.approx(voltage / 2.0)


def test_what_leaks_past_a_path_goes_with_the_difference() -> None:
    made = model("tanks", "cross_leakage", conductance=0.01)
    assert made.signals({"upper": 4.0, "lower": 1.0})["between"] == pytest.approx(0.05 * 2.0 + 0.03)
    assert made.signals({"upper": 1.0, "lower": 4.0})["between"] == pytest.approx(0.05 - 0.03)


def test_what_leaks_from_one_store_to_another_is_lost_to_neither() -> None:
    place = {"pressure1": 3e5, "pressure2": 1e5}
    made, plain = model("two_pumps", "internal_leakage", conductance=2e-12), PlainModel(find_plant("two_pumps"))
    lost = [(made.signals(place)[f"{line}_loss"] - plain.signals(place)[f"{line}_loss"]) for line in ("line1", "line2")]
    assert lost == pytest.approx([2e-12 * 2e5, -2e-12 * 2e5])
    # a path that joins two tanks is their way already
    assert "internal_leakage" not in load_effects(plant=find_plant("tanks"))


def test_air_halves_the_stiffness_where_it_gives_as_much_as_the_store() -> None:
    made = model("rotor", "entrained_air", air_volume=101325.0 / 1e11)
    assert made.signals({"pressure": 0.0})["pressure_stiffness"] == pytest.approx(0.5e11)
    assert made.signals({"pressure": 101325.0})["pressure_stiffness"] == pytest.approx(1e11 / 1.25)
    assert made.rates({"pressure": 0.0, "flow": 1e-6})["pressure"] == pytest.approx(0.5e11 * 1e-6)


# --- Sensors and transmissions


def test_errors_of_a_sensor() -> None:
    here = {"position": 0.2, "time": 3.0}
    for name, values, error in (
        ("sensor_offset", {"offset": 0.01}, 0.01),
        ("sensor_gain", {"gain_error": -0.1}, -0.02),
        ("sensor_drift", {"drift": 0.001}, 0.003),
    ):
        assert model("axis", name, **values).signals(here)["encoder"] == pytest.approx(0.2 + error)
    assert model("axis", "sensor_drift", drift=0.001).signals(here | {"time": -1.0})["encoder"] == 0.2
    made = model("rotor", "eccentricity", amplitude=0.02, phase=0.5, zeroed=1.0)
    assert made.signals({"angle": 0.0})["encoder"] == pytest.approx(0.0)
    assert made.signals({"angle": pi - 1.0})["encoder"] == pytest.approx(pi - 1.0)


def test_play_is_half_behind_in_each_direction_and_stands_still_within() -> None:
    angles = [0.0, 0.2, 0.4, 0.35, 0.31, 0.29, 0.0, -0.2, -0.15]
    found = seen(model("rotor", "backlash", play=0.1), [{"angle": angle} for angle in angles], "arm")
    assert found == pytest.approx([0.0, 0.15, 0.35, 0.35, 0.35, 0.34, 0.05, -0.15, -0.15])
    assert seen(model("rotor", "backlash", play=0.0), [{"angle": angle} for angle in angles], "arm") == angles


def test_a_loaded_contact_of_the_axis_gets_what_it_lacked(folder: Path) -> None:
    path = folder / "plants" / "axis.py"
    path.write_text(path.read_text().replace("            travel=", "            load=force,\n            travel="))
    found = model("axis", "load_friction", coefficient=0.1).signals(MOVING)
    assert found["friction_coulomb"] == pytest.approx(COULOMB + 0.1 * GAIN * 2.0)
