"""A plant of a user's own is one file: its elements become slots and places, and each mistake is one clear message."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hjcamp import cli
from hjcamp.effects import library_of, load_effects
from hjcamp.errors import UsageError
from hjcamp.known_plants import find_plant
from hjcamp.model.checks.plant_bench import effects_seen, identified
from hjcamp.model.checks.plant_checks import CHECKS, check_plant, check_users_plant, other_period
from hjcamp.model.compile.compose import Composition
from hjcamp.model.compile.function_sources import rates_source, signals_source
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State
from hjcamp.model.language.amount_formula import plain_functions
from hjcamp.model.language.binding import bind
from hjcamp.model.language.effect_units import check_units
from hjcamp.model.language.quantities import usual_sizes
from hjcamp.model.language.vocabulary import read_vocabulary

MISTAKES = {
    "a state without a rate": ("        rate.position = state.velocity\n", "", "the state 'position' has no rate"),
    "a rate in a wrong unit": ("rate.position = state.velocity", "rate.position = state.position", "must be in m/s"),
    "an unknown argument": ("viscous=parameter", "viscos=parameter", "did you mean 'viscous'"),
    "a missing argument": (
        "            state.velocity,\n            push",
        "            push",
        "contact(...) lacks 'velocity'",
    ),
    "another push than the rates have": ("push=force + load", "push=force", "the push of contact 'friction' is"),
    "an algebraic loop": ("gain * drive.voltage)", "gain * drive.voltage + friction)", "no algebraic loops"),
    "an unknown parameter": ("mass=parameter.mass", "mass=parameter.mas", "did you mean 'mass'"),
    "an unknown input": ("* drive.voltage", "* drive.volt", "did you mean 'voltage'"),
    "an unknown state": ("= state.velocity", "= state.velocty", "did you mean 'velocity'"),
    "an unknown element": ("actuator(parameter", "actuater(parameter", "unknown name 'actuater'"),
    "a sensor that measures nothing": ('Measured("encoder"', 'Measured("encodr"', "did you mean 'encoder'"),
    "a field in another unit": ("position_m =", "position_v =", "says V, but 'encoder' is in m"),
    "an input's field without a unit": ('Input("V"', 'Input("V", field="u_now"', "unit at the end of the field 'u_now'"),
    "an input's field in another unit": (
        'Input("V"',
        'Input("V", field="volume_m3"',
        "says m^3, but the input 'voltage' is in V",
    ),
    "a field in degrees Celsius": ("position_m =", "position_degc =", "write 'position_k', and 'unit: degC' in the map"),
    "friction of a force": ("            state.velocity,\n", "            force,\n", "must be a state"),
    "friction that drives": ("coulomb=parameter", "coulomb=-parameter", "drives the motion instead of braking it"),
    "a loop": ("        force =", "        for i in range(3):\n            pass\n        force =", "assignments only"),
    "a body that is no rate": ("rate.velocity = body", "speed = body", "write rate.STATE = body(...)"),
    "a force without a unit": ('outside("N")', "outside()", "lacks its unit"),
    "mixed units": ("gain * drive.voltage)", "gain * drive.voltage + state.position)", "adds"),
    "two places of one name": ("sensor(state.position)", 'sensor(state.position, name="force")', "two places"),
    "a name of the compiled model": (
        'load = outside("N")',
        'load = outside("N")\n        out = outside("N")',
        "'out' is a name",
    ),
    "a name of every plant": ("    gain = Parameter", "    cut = Parameter", "'cut' is a name that every plant has for itself"),
    "a state's name in it": (
        'load = outside("N")',
        'load = outside("N")\n        s_position = load + 0.0',
        "call this line otherwise",
    ),
    "a line twice": ('load = outside("N")', 'load = outside("N")\n        load = outside("N")', "assigned twice"),
    "a root out of its range": (
        "gain * drive.voltage)",
        "gain * drive.voltage * (state.position / 0.1 - 2.0) ** 0.5)",
        "line",
    ),
    "nothing measured": ('    position_m = Measured("encoder", of="position")\n', "", "nothing is measured"),
    "a module": ("gain * drive.voltage)", "gain * np.sin(drive.voltage / 3.0))", "write sin(...)"),
    "a rate that is given below": (
        "gain * drive.voltage)",
        "gain * drive.voltage + rate.velocity)",
        "given in a line above",
    ),
    "a sensor of no state": ('of="position"', 'of="force"', "leave of= out"),
    "a unit without its power sign": ('"N*s/m"', '"N*s/m1"', "did you mean 'N*s/m^1'"),
    "a unit in capitals": ('"N*s/m"', '"Newton*S/m"', "did you mean 'newton*s/m'"),
    "newton metres": ('"N*s/m"', '"Nm"', "did you mean 'N*m'"),
    "an unknown argument of a state": ("typical=0.05", "typicl=0.05", "did you mean 'typical'"),
    "a size that is none": ("typical=0.05", "typical=0", "axis.py: line 15: Axis.velocity: typical is 0"),
    "a size that is no number": ("typical=0.05", 'typical=float("nan")', "above zero"),
    "a start that is none": ("typical=0.05", 'typical=0.05, start="unknwn"', 'a number or "unknown"'),
    "a lowest value that is none": ("typical=0.05", 'typical=0.05, low=float("nan")', "cannot fall below"),
    "scatter below zero": ("typical=0.05", "typical=0.05, scatter=-1.0", "from 0 on"),
    "an element within a line": (
        "rate.position = state.velocity",
        "rate.position = sensor(state.velocity) / 1.0",
        "alone on",
    ),
    "a period of nothing": ("period = 0.001", "period = 0.0", "period is 0.0; the seconds between"),
    "a period in words": ("period = 0.001", 'period = "1 ms"', "the seconds between"),
    "an unknown loop": ("period = 0.001", 'loop = "foriegn"', "did you mean 'foreign'"),
    "an unknown hold": ('"V", text', '"V", hold="lineer", text', "did you mean 'linear'"),
    "noise below zero": ('of="position"', 'of="position", noise=-1e-6', "noise is -1e-06"),
    "degrees Celsius": ('"N*s/m"', '"degC"', r"did you mean 'K'"),
    "no SI unit": ('"N*s/m"', '"N*s/mm"', "is not an SI unit"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_one_message_with_its_line(folder: Path, mistake: str, capsys: pytest.CaptureFixture[str]) -> None:
    old, new, told = MISTAKES[mistake]
    path = folder / "plants" / "axis.py"
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new, 1))
    assert cli.run(["plants", "test", "axis"]) == 2
    message = capsys.readouterr().err
    assert told in message and "internal error" not in message and len(message) < 700


def test_lines_may_go_on_and_comments_stand_at_the_left(folder: Path) -> None:
    path = folder / "plants" / "axis.py"
    text = path.read_text()
    path.write_text(text.replace("            push=force + load,\n", "# the guide\npush=force + load,\n"))
    moved = read_vocabulary(find_plant("axis"))
    path.write_text(text)
    assert [(one.target, one.expression) for one in moved.statements] == [
        (one.target, one.expression) for one in read_vocabulary(find_plant("axis")).statements
    ]
    assert moved.slots["friction"].line == read_vocabulary(find_plant("axis")).slots["friction"].line


def test_a_guide_in_oil_needs_neither_dry_friction_nor_a_push(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = folder / "plants" / "axis.py"
    text = path.read_text()
    path.write_text(text.replace("            push=force + load,\n            coulomb=parameter.coulomb,\n", ""))
    wet = path.read_text()
    assert len(wet) < len(text)
    oiled = Composition(find_plant("axis"), [])
    rates = plain_functions(rates_source(oiled))["rates"]
    values = {name: one.default for name, one in oiled.parameters.items()}
    found = np.zeros(2)
    rates(
        -1,
        0.0,
        1.0,
        np.array([0.0, 0.1]),
        np.array([2.0, *[0.0] * (len(oiled.inputs) - 1)]),
        np.array(list(values.values())),
        found,
    )
    assert found[1] == pytest.approx((values["gain"] * 2.0 - values["viscous"] * 0.1) / values["mass"])
    check_plant(find_plant("axis"))
    # what moves its mass tells the unit of a push where nothing is known of friction
    bare = wet.replace("            viscous=parameter.viscous,\n", "")
    path.write_text(bare)
    plant = find_plant("axis")
    assert read_vocabulary(plant).signals["friction_push"].unit == "N"
    assert {"dry_friction", "viscous_friction", "quadratic_drag"} <= set(load_effects(plant="axis"))
    path.write_text(bare.replace("mass=parameter.mass", "mass=2.0 * parameter.mass"))
    assert cli.run(["plants", "test", "axis"]) == 2
    assert "has no friction that would tell the unit of a push" in capsys.readouterr().err


def test_elements_stand_for_marked_lines(folder: Path) -> None:
    vocabulary = read_vocabulary(find_plant("axis"))
    assert [line.target for line in vocabulary.slots.values()] == [
        "force", "load", "friction_static", "friction_coulomb", "friction_viscous", "friction_locks", "friction",
        "velocity_mass", "encoder",
    ]  # fmt: skip
    assert vocabulary.signals["friction_viscous"].unit == "N*s/m" and vocabulary.signals["friction_push"].unit == "N"
    assert vocabulary.signals["velocity_acceleration"].unit == "m/s^2"
    assert vocabulary.contacts[0].velocity == "velocity" and vocabulary.contacts[0].limit == "friction_static"
    assert vocabulary.ports["friction"].names["travel"] == "position"
    assert vocabulary.ports["velocity"].names["force"] == "load"


def test_what_a_plant_calls_a_unit_is_its_word_for_it(folder: Path) -> None:
    path = folder / "plants" / "axis.py"
    path.write_text(path.read_text().replace('"N*s/m"', '"kg/s"').replace('"m/s"', '"rad*m/s"'))
    signals = read_vocabulary(find_plant("axis")).signals
    assert signals["friction_viscous"].unit == "kg/s"
    assert signals["friction_speed"].unit == "m/s" and signals["encoder_true"].unit == "m"


def test_rates_are_those_of_the_equations(folder: Path) -> None:
    plant = find_plant("axis")
    composition = Composition(plant)
    rates = plain_functions(rates_source(composition))["rates"]
    u = np.zeros(len(composition.inputs))
    u[composition.inputs.index("voltage")], u[composition.inputs.index("friction_scatter")] = 2.0, 1.0
    p = np.array([item.default for item in plant.parameters.values()])
    out = np.zeros(2)
    for direction, acceleration in ((1.0, (70.0 - 20.0 - 200.0 * 0.1) / 95.0), (0.0, 0.0)):
        rates(-1, 0.0, direction, np.array([0.3, 0.1]), u, p, out)
        assert out == pytest.approx([0.1, acceleration])


def test_a_line_may_read_a_rate_above_it_at_rest_too(folder: Path) -> None:
    path = folder / "plants" / "axis.py"
    state = '    follower = State("m/s")\n    voltage = '
    line = "        rate.follower = 2.0 * rate.velocity\n        encoder = "
    path.write_text(path.read_text().replace("    voltage = ", state, 1).replace("        encoder = ", line, 1))
    plant = find_plant("axis")
    check_plant(plant)
    assert usual_sizes(plant)["velocity_acceleration"] > 0.0
    rates = plain_functions(rates_source(composition := Composition(plant)))["rates"]
    u = np.zeros(len(composition.inputs))
    u[composition.inputs.index("voltage")], u[composition.inputs.index("friction_scatter")] = 2.0, 1.0
    p = np.array([item.default for item in plant.parameters.values()])
    out = np.zeros(3)
    for direction, acceleration in ((1.0, (70.0 - 20.0 - 200.0 * 0.1) / 95.0), (0.0, 0.0)):
        rates(-1, 0.0, direction, np.array([0.3, 0.1, 0.0]), u, p, out)
        assert out[2] == pytest.approx(2.0 * acceleration)


def test_a_heater_may_stand_in_a_room(folder: Path) -> None:
    path = folder / "plants" / "axis.py"
    path.write_text(path.read_text().replace("    gain =", '    room = Input("K", typical=295.0)\n    gain =', 1))
    check_plant(plant := find_plant("axis"))
    assert "room" in plant.given_inputs() and plant.room_of("compare") is None


def test_logs_of_another_period_are_told_which_line_to_write(folder: Path) -> None:
    plant = find_plant("tanks")
    assert "write 'period = 4'" in other_period(plant, 4.0)
    assert "unit of time_s ms?" in other_period(plant.sampled(4.0), 3990.0)
    assert "unit" not in other_period(plant, 1.0) + other_period(plant.sampled(4.0), 300.0)
    assert other_period(plant, plant.period * 4.9) == other_period(plant, plant.period / 4.9) == ""


def test_friction_may_differ_between_the_directions(folder: Path) -> None:
    path = folder / "plants" / "axis.py"
    path.write_text(
        path.read_text().replace(
            "coulomb=parameter.coulomb", "coulomb=(parameter.coulomb, parameter.coulomb + parameter.coulomb)"
        )
    )
    plant = find_plant("axis")
    check_plant(plant)
    signals = plain_functions(signals_source(Composition(plant)))["signals"]
    names = list(read_vocabulary(plant).signals)
    out = np.zeros(len(names))
    p = [item.default for item in plant.parameters.values()]
    for direction, coulomb in ((1.0, 20.0), (-1.0, 40.0)):
        signals(0.0, direction, [0.0, 0.01 * direction], [0.0, 1.0], p, out)
        assert out[names.index("friction_coulomb")] == coulomb


class Drag(Effect):
    """A drag that grows with the square of the speed."""

    acts_on = "contact"
    drag = Parameter("friction/speed**2", 0.1, (0.0, 2.0), text="force at the usual speed, over the usual friction", off=0.0)

    @staticmethod
    def friction(velocity, speed, drag):
        return drag * velocity * speed


class Late(Effect):
    """A sensor that lags."""

    acts_on = "sensor"
    lag = Parameter("s", 5e-3, (1e-4, 0.2), "log-uniform", off=0.0)
    caught = State("true")

    @staticmethod
    def d_caught(true, caught, lag):
        return (true - caught) / lag

    @staticmethod
    def reading(reading, caught):
        return caught


class Loss(Effect):
    """A store that leaks."""

    acts_on = "store"
    together = True
    conductance = Parameter("loss/level", 0.1, (0.0, 1.0), off=0.0)
    lost = State("loss*s")

    @staticmethod
    def d_lost(level, conductance):
        return conductance * level

    @staticmethod
    def loss(level, conductance):
        return conductance * level


def named(effect: type[Effect], name: str) -> type[Effect]:
    effect.name = name
    return effect


def test_a_generic_effect_is_bound_in_the_units_and_sizes_of_its_place(folder: Path) -> None:
    plant = find_plant("axis")
    [drag] = bind(named(Drag, "drag"), plant)
    parameter = drag.parameters["drag"]
    size = usual_sizes(plant)["friction"] / 0.05**2
    assert parameter.default == pytest.approx(0.1 * size) and parameter.bounds == pytest.approx((0.0, 2.0 * size))
    check_units(drag, plant)
    assert list(drag.terms) == ["friction"] and drag.terms["friction"].arguments == (
        "velocity",
        "friction_speed",
        "drag",
    )
    [late] = bind(named(Late, "late"), plant)
    check_units(late, plant)
    assert late.states["caught"].unit == "m"


def test_an_effect_is_named_after_its_place_where_there_are_several(folder: Path) -> None:
    path = folder / "plants" / "tanks.py"
    tanks = find_plant("tanks")
    assert [one.name for one in bind(named(Loss, "loss"), tanks)] == ["loss_at_upper", "loss_at_lower"]
    path.write_text(
        path.read_text()
        .replace("store(inflow - between)", 'store(inflow - between, group="tanks")')
        .replace("store(between - outflow)", 'store(between - outflow, group="tanks")')
    )
    [both] = bind(named(Loss, "loss"), find_plant("tanks"))
    assert list(both.terms) == ["upper_loss", "lower_loss"] and list(both.states) == ["lost_upper", "lost_lower"]
    assert list(both.parameters) == ["conductance"]


def test_what_does_not_fit_says_why(folder: Path) -> None:
    with pytest.raises(UsageError, match=r"needs a contact .* plant tanks has none"):
        bind(named(Drag, "drag"), find_plant("tanks"))

    class Loaded(Effect):
        """Friction that grows with a load."""

        acts_on = "contact"
        share = Parameter("coulomb/load", 0.1, (0.0, 1.0), off=0.0)

        @staticmethod
        def coulomb(load, share):
            return share * load

    with pytest.raises(UsageError, match=r"needs load, .* contact\(\.\.\., load=\.\.\.\)"):
        bind(named(Loaded, "loaded"), find_plant("axis"))


def test_the_pump_joint_has_all_its_effects(folder: Path) -> None:
    assert len(library_of(find_plant("pump_joint")).effects) == 22


@pytest.mark.parametrize("name", ["axis", "tanks", "pump_joint"])
def test_plants_shows_lines_places_and_what_fits(folder: Path, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["plants", name]) == 0
    told = capsys.readouterr().out
    assert "effects that fit" in told and "rate." in told
    assert (name == "pump_joint") == ("constant_force: plant pump_joint needs none: " in told)
    assert cli.run(["plants"]) == 0
    assert name in capsys.readouterr().out


def test_a_new_plant_passes_its_tests(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["plants", "new", "my_axis"]) == 0
    assert cli.run(["plants", "test", "my_axis"]) == 0
    assert "my_axis passes" in capsys.readouterr().out
    for words, told in (
        (["new", "my_axis"], "exists; it is left as it is"),
        (["new", "My-Axis"], "write it in small letters"),
        (["new", "class"], "this is a word of Python; choose another, such as class_1"),
        (["new", "none"], "this is a word of Python"),
        (["new", "tanks"], "exists; it is left as it is"),
        (["new", "pump_joint"], "is taken"),
        (["my_axs"], "did you mean 'my_axis'"),
        (["test"], "give one name"),
    ):
        assert cli.run(["plants", *words]) == 2
        assert told in capsys.readouterr().err


def test_a_plant_is_checked_once_and_again_once_its_file_has_changed(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[object] = []
    monkeypatch.setitem(CHECKS, "units", lambda plant: str(seen.append(plant)))
    path = folder / "plants" / "axis.py"
    for text, checked in ((path.read_text(), 1), (path.read_text() + "\n# another mass\n", 2)):
        path.write_text(text)
        for _ in range(2):
            check_users_plant(find_plant("axis"))
        assert len(seen) == checked


def test_two_plants_of_one_name_are_refused(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "plants" / "pump_joint.py").write_text((folder / "plants" / "axis.py").read_text())
    assert cli.run(["plants", "pump_joint"]) == 2
    assert "'pump_joint' is taken" in capsys.readouterr().err


def test_a_faulty_file_is_no_fault_of_the_plants_beside_it(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "plants" / "broken.py").write_text("class (")
    axis = (folder / "plants" / "axis.py").read_text()
    (folder / "plants" / "odd.py").write_text(axis.replace("rate.velocity =", "rate.speed ="))
    assert cli.run(["plants", "axis"]) == 0
    capsys.readouterr()
    assert cli.run(["plants"]) == 0
    said = capsys.readouterr().out
    assert "axis" in said and "not a plant: " in said and "broken.py: line 1: invalid syntax" in " ".join(said.split())
    assert "unknown state 'speed' in plant odd" in said
    assert cli.run(["plants", "new", "third"]) == 0
    assert cli.run(["plants", "broken"]) == 2


def test_base_parameters_that_only_their_product_tells_are_named(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = folder / "plants" / "axis.py"
    text = path.read_text().replace('Parameter("N/V", 35.0, text', 'Parameter("N/V", 35.0, (1.0, 100.0), base=True, text')
    path.write_text(text)
    assert cli.run(["plants", "test", "axis"]) == 2
    message = capsys.readouterr().err
    assert "moves together with" in message and all(name in message for name in ("gain", "mass", "coulomb", "viscous"))


def test_a_base_parameter_that_nothing_shows_is_named(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = folder / "plants" / "tanks.py"
    path.write_text(path.read_text().replace("    level_v", '    spare = Parameter("V", 2.0, base=True)\n    level_v'))
    assert cli.run(["plants", "test", "tanks"]) == 2
    assert "'spare' changes nothing that is measured" in capsys.readouterr().err


ROLLS_OUT = '''"""A car that rolls out."""
from hjcamp.plant import Measured, Parameter, Plant, State, body, contact, outside, sensor


class Car(Plant):
    r"""Rolling resistance alone.

    .. math:: m \\\\dot v = -R
    """

    position = State("m", typical=100.0)
    speed = State("m/s", typical=5.0)
    mass = Parameter("kg", 78.0)
    rolling = Parameter("N", 3.0, (0.01, 50.0), base=True)
    speed_m_per_s = Measured("gps", of="speed")
    period = 1.0

    @staticmethod
    def equations(state, parameter, drive, rate):
        load = outside("N")
        friction = contact(state.speed, push=load, coulomb=parameter.rolling, travel=state.position)
        rate.position = state.speed
        rate.speed = body(load - friction, mass=parameter.mass, load=load, position=state.position)
        gps = sensor(state.speed)
'''
JACKET = '''"""A jacket that a valve cools."""
from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, sensor, store


class Jacket(Plant):
    r"""A negative opening would heat it without end.

    .. math:: C \\\\dot T = P - G v T
    """

    warmth = State("K", typical=30.0)
    valve = Input("1", typical=0.5)
    heater = Input("W", typical=1e3)
    capacity = Parameter("J/K", 500.0, base=True)
    flow = Parameter("W/K", 200.0, base=True)
    warmth_k = Measured("probe", of="warmth")
    period = 5.0

    @staticmethod
    def equations(state, parameter, drive, rate):
        cooling = actuator(parameter.flow * drive.valve)
        heat = actuator(drive.heater)
        rate.warmth = store((heat - cooling * state.warmth) / parameter.capacity)
        probe = sensor(state.warmth)
'''


@pytest.mark.parametrize(("name", "text", "told"), [("car", ROLLS_OUT, "1 base"), ("jacket", JACKET, "2 base")])
def test_what_rolls_out_or_must_not_be_driven_backwards_is_told(folder: Path, name: str, text: str, told: str) -> None:
    (folder / "plants" / f"{name}.py").write_text(text)
    plant = find_plant(name)
    assert identified(plant).startswith(told)
    # an effect that only one sign of the inputs bears fails no test
    assert effects_seen(plant, {"sensor_gain": load_effects(plant=name)["sensor_gain"]}) == "1 of 1"
