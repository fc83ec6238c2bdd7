"""Every generic effect on plants of a user's: units, finite, absent when off, seen; what fits, and why the rest does not."""

from __future__ import annotations

import pickle
from pathlib import Path

import pytest

from hjcamp.effects import effect_files, find_effect, library_of, load_effects
from hjcamp.errors import UsageError
from hjcamp.known_plants import find_plant
from hjcamp.model.checks.place_checks import PLACE_CHECKS, PlaceBench
from hjcamp.model.declare.port import KINDS
from hjcamp.model.language.binding import bind
from hjcamp.plants.pump_joint import PumpJoint

FILES = effect_files([])
GENERIC = sorted(name for name, effect in FILES.items() if effect.acts_on)
PLANTS = ("axis", "tanks", "rotor")
PRESS = ("added_mass", "dither_relief", "flow_inertance", "flow_resistance", "moving_backlash", "transmission_compliance")
# where alone some have a place, or show: a current that reverses, stores that no path joins, contacts without dry or viscous friction
ALONE = {
    "internal_leakage": ("two_pumps",),
    "dry_friction": ("wheel",),
    "viscous_friction": ("dry_wheel",),
    "check_valve": ("driver",),
} | dict.fromkeys(PRESS, ("press",))
FITS = {
    "axis": "action_lag command_delay constant_force contact_creep coulomb_asymmetry cubic_spring dead_band friction_drift "
    "hard_stop maxwell_element position_friction presliding quadratic_drag saturation sensor_drift sensor_gain sensor_lag "
    "sensor_offset soft_stop spring static_friction_ageing stribeck_excess viscous_asymmetry",
    "tanks": "action_lag check_valve_at_between check_valve_at_outflow command_delay cross_leakage dead_band "
    "flow_exponent_at_between flow_exponent_at_outflow leakage_at_lower "
    "leakage_at_upper overflow_at_lower overflow_at_upper saturation second_store_at_lower second_store_at_upper sensor_drift "
    "sensor_gain sensor_lag sensor_offset spill_over",
}


@pytest.mark.parametrize("name", GENERIC)
def test_on_every_plant_that_it_fits(folder: Path, name: str) -> None:
    tried = 0
    for plant in map(find_plant, ALONE.get(name, PLANTS)):
        if name in library_of(plant).unfit:
            continue
        for effect in bind(FILES[name], plant):
            tried += 1
            for check in PLACE_CHECKS.values():
                assert check(PlaceBench(effect, plant))
    assert tried


@pytest.mark.parametrize("name", GENERIC)
def test_the_docstring_tells_equation_sign_and_source(name: str) -> None:
    effect = FILES[name]
    text = effect.__doc__ or ""
    assert effect.equation() and all(part in text for part in ("Seen as: ", "Not for: ", "Source: "))
    assert all(parameter.text for parameter in effect.parameters.values())
    assert any(parameter.off is not None for parameter in effect.parameters.values())
    assert 1 <= len(effect.parameters) <= 5 and effect.acts_on in KINDS


@pytest.mark.parametrize("plant", FITS)
def test_which_effects_fit(folder: Path, plant: str) -> None:
    assert list(load_effects(plant=plant)) == FITS[plant].split()


@pytest.mark.parametrize(
    ("coulomb", "fits"),
    [
        ("", True),
        (", coulomb=0.0", True),
        (", coulomb=parameter.dry", True),
        (", coulomb=parameter.rub", False),
        (", coulomb=0.01 * torque", False),
    ],
)
def test_dry_friction_is_for_contacts_that_have_none(folder: Path, coulomb: str, fits: bool) -> None:
    path = folder / "plants" / "wheel.py"
    text = path.read_text().replace("viscous=parameter.viscous)", f"viscous=parameter.viscous{coulomb})")
    # a base parameter that begins at 0 is found by calibrating: beside it nothing could be told
    own = '    dry = Parameter("N*m", 0.0)\n    rub = Parameter("N*m", 0.0, (0.0, 1.0), base=True)\n    period'
    path.write_text(text.replace("    period", own))
    library = library_of(find_plant("wheel"))
    assert ("dry_friction" in library.effects) == fits
    assert ("coulomb_asymmetry" in library.effects) == ("presliding" in library.effects) == (not fits)
    if fits:
        assert "plant wheel has no coulomb in any such place" in str(library.unfit["presliding"])
    else:
        assert "plant wheel has coulomb of its own" in str(library.unfit["dry_friction"])


def test_viscous_friction_is_for_contacts_that_have_none(folder: Path) -> None:
    wheel, dry = (library_of(find_plant(name)) for name in ("wheel", "dry_wheel"))
    assert "viscous_friction" in dry.effects and "viscous_asymmetry" not in dry.effects
    assert "viscous_asymmetry" in wheel.effects and "plant wheel has viscous of its own" in str(wheel.unfit["viscous_friction"])


def test_an_angle_is_told_in_the_unit_of_its_state(folder: Path) -> None:
    rotor = load_effects(plant="rotor")
    assert rotor["spring"].parameters["rest_position"].unit == "rad"
    assert rotor["stribeck_excess"].parameters["stribeck_speed"].unit == "rad/s"
    wheel = load_effects(plant="wheel")
    assert wheel["sensor_offset"].parameters["offset"].unit == "rad/s"
    assert load_effects(plant="axis")["spring"].parameters["rest_position"].unit == "m"


def test_every_kind_of_place_has_an_effect() -> None:
    assert {effect.acts_on for effect in FILES.values()} - {""} == set(KINDS)


def test_signs_are_bounds() -> None:
    for name, parameter in (
        ("stribeck_excess", "excess"), ("quadratic_drag", "drag"), ("load_friction", "coefficient"), ("overflow", "spill"),
        ("leakage", "conductance"), ("dead_band", "width"), ("backlash", "play"), ("soft_stop", "stiffness"),
    ):  # fmt: skip
        assert FILES[name].parameters[parameter].bounds[0] == 0.0


@pytest.mark.parametrize(
    ("name", "plant", "said"),
    [
        ("stribeck_friction", "axis", "needs breakaway, .* write contact\\(\\.\\.\\., static=\\.\\.\\.\\)"),
        ("load_friction", "axis", "needs load, .* write contact\\(\\.\\.\\., load=\\.\\.\\.\\)"),
        ("eccentricity", "axis", "needs its true in rad, not m, at sensor 'encoder' of plant axis"),
        ("entrained_air", "tanks", "needs stiffness, .* write store\\(\\.\\.\\., stiffness=\\.\\.\\.\\)"),
        ("spill_over", "rotor", "needs loss_below, which store 'pressure' does not offer"),
        ("spring", "tanks", "needs a body \\(a mass that forces move\\); plant tanks has none"),
        ("backlash", "tanks", "needs a transmission"),
        ("gravity_load", "axis", "written in the names of plant pump_joint"),
        ("leakage", "tanks", "plant tanks has it as leakage_at_upper, leakage_at_lower"),
        ("sensor_lag", "pump_joint", "plant pump_joint has it as encoder_lag"),
        ("constant_force", "pump_joint", "needs none: .* base parameters"),
        ("presliding", "pump_join", "did you mean 'pump_joint'"),
        ("springs", "axis", "did you mean 'spring'"),
    ],
)
def test_what_does_not_fit_says_why(folder: Path, name: str, plant: str, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        find_effect(name, plant)


def test_without_its_load_a_body_says_how_to_give_it(folder: Path) -> None:
    path = folder / "plants" / "axis.py"
    path.write_text(path.read_text().replace(" load=load,", ""))
    with pytest.raises(UsageError, match=r"needs force, which body 'velocity' does not offer: write body\(\.\.\., load="):
        find_effect("constant_force", "axis")


def test_the_mass_of_a_contact_is_that_of_its_body(folder: Path) -> None:
    assert "presliding" in load_effects(plant="axis")
    path = folder / "plants" / "axis.py"
    text = path.read_text()
    start = text.index("        rate.velocity = body(")
    line = text[start : text.index("\n", start)]
    path.write_text(text.replace(line, "        rate.velocity = (force + load - friction) / parameter.mass"))
    assert "presliding" in load_effects(plant="axis") and "spring" not in load_effects(plant="axis")
    path.write_text(text.replace(line, "        rate.velocity = (force + load - friction) * (1.0 / parameter.mass)"))
    assert "presliding" not in load_effects(plant="axis")


def test_every_generic_effect_is_an_instance_or_covered_on_the_pump_joint() -> None:
    library = library_of(PumpJoint, [])
    assert len(library.effects) == 22
    assert {instance.of for instance in PumpJoint.instances} | set(PumpJoint.covers) == set(GENERIC)
    assert set(library.unfit) == set(PumpJoint.covers)


def test_a_generic_effect_of_the_users_fits_the_pump_joint_too(folder: Path) -> None:
    (folder / "effects").mkdir()
    (folder / "effects" / "louder.py").write_text(LOUDER)
    assert [name for name in load_effects() if "louder" in name] == [
        "louder_at_encoder",
        "louder_at_gauge1",
        "louder_at_gauge2",
    ]
    assert list(load_effects())[-1] == "louder_at_gauge2"  # ours first: the order of the terms in a kernel
    assert "louder" in load_effects(plant="tanks")


def test_an_effect_goes_to_another_process_as_what_it_was_made_of(folder: Path) -> None:
    for effect in [*load_effects([]).values(), *load_effects([], "axis").values()]:
        assert pickle.loads(pickle.dumps(effect)) is effect


LOUDER = '''"""A loud sensor."""
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class Louder(Effect):
    """A sensor is loud."""

    acts_on = "sensor"
    share = Parameter("1", 0.1, (0.0, 1.0), text="how loud", off=0.0)

    @staticmethod
    def reading(true, share):
        return share * true
'''
MISTAKES = {
    "an unknown kind": ('"sensor"', '"senser"', "unknown kind of place 'senser'.*did you mean 'sensor'"),
    "an unknown slot": ("def reading(", "def readin(", "unknown slot 'readin'.*did you mean 'reading'"),
    "an unknown name": ("(true, share)", "(tru, share)", "unknown name 'tru'.*did you mean 'true'"),
    "an unknown unit": ('"1"', '"true/speed"', "unknown unit 'speed'"),
    "a name of the kind": ("share", "true", "is a name of every sensor|duplicate argument"),
    "a list": ("return share * true", "return [share]", "it gives a list"),
    "a function of its own": ("return share * true", "return open(true)", "unknown argument, function or constant 'open'"),
    "a misspelt argument": ("return share * true", "return shar * true", "constant 'shar'.*did you mean 'share'.*, share,"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_faulty_generic_file_is_refused_on_every_plant(folder: Path, mistake: str) -> None:
    old, new, said = MISTAKES[mistake]
    (folder / "effects").mkdir()
    (folder / "effects" / "louder.py").write_text(LOUDER.replace(old, new))
    for plant in ("axis", "tanks", "pump_joint"):
        with pytest.raises(UsageError, match=said):
            find_effect("louder", plant)


def test_a_faulty_file_is_named_where_another_effect_is_asked_for(folder: Path) -> None:
    (folder / "effects").mkdir()
    path = folder / "effects" / "louder.py"
    path.write_text(LOUDER.replace("return share", "return shar"))
    with pytest.raises(UsageError, match=f"^{path}: .*did you mean 'share'"):
        find_effect("sensor_lag", "axis")


THEIRS = '''from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class Extra(Effect):
    """More friction."""

    subsystem = "joint"
    more = Parameter("1", 0.1, (0.0, 1.0), text="more", off=0.0)

    @staticmethod
    def friction_static(friction_static, slider_position, more):
        return friction_static * (1.0 + more)
'''


def test_an_effect_of_another_plants_names_says_of_which_place_they_are(folder: Path) -> None:
    (folder / "effects").mkdir()
    path = folder / "effects" / "extra.py"
    path.write_text(THEIRS)
    assert "extra" in load_effects()
    with pytest.raises(UsageError) as caught:
        load_effects(plant="tanks")
    said = str(caught.value)
    assert "effect extra" in said and 'write plant = "pump_joint"' in said
    assert "acts_on = \"contact\": 'friction_static' is its 'static'" in said
    path.write_text(THEIRS.replace("subsystem", 'plant = "pump_joint"\n    subsystem'))
    assert "extra" in load_effects() and "extra" not in load_effects(plant="tanks")
    path.write_text(THEIRS.replace("subsystem", 'plant = "tanks"\n    subsystem'))
    assert "extra" not in load_effects()
    with pytest.raises(UsageError, match="unknown slot 'friction_static'"):
        load_effects(plant="tanks")


INSTANCE = '''

class FromTheMaker(Instance):
    """The encoder is late by what its maker says."""

    of = "sensor_lag"
    at = {"encoder": {"lag": "delay"}}
    delay = Parameter("s", 0.002, (1e-4, 0.1), "log-uniform", "time by which it is late", off=0.0)
'''


def test_a_plant_names_its_own_instances(folder: Path) -> None:
    path = folder / "plants" / "axis.py"
    text = path.read_text().replace("import Input", "import Input, Instance")
    head, body = text.split("\n\n\nclass ", 1)
    text = (
        head
        + INSTANCE
        + "\n\nclass "
        + body.replace("    position = State", "    instances = (FromTheMaker,)\n    position = State", 1)
    )
    path.write_text(text)
    library = library_of("axis")
    assert "sensor_lag" not in library.effects
    effect = library.effects["from_the_maker"]
    assert list(effect.parameters) == ["delay", "dead_share"] and effect.parameters["delay"].default == 0.002
    assert effect.sentence() == "The encoder is late by what its maker says."
    for old, new, said in (
        ('"sensor_lag"', '"sensor_lags"', "did you mean 'sensor_lag'"),
        ('"encoder": {', '"encoders": {', "unknown place 'encoders'"),
        ('"encoder": {', '"force": {', "acts on a sensor, but 'force' is an actuator"),
        ('"lag": "delay"', "", "unknown parameter or state 'delay'"),
    ):
        path.write_text(text.replace(old, new))
        with pytest.raises(UsageError, match=said):
            library_of("axis")


DRY_ALONE = '''
class RoughPlace(Instance):
    """A rough place; this guide has next to no viscous friction."""

    of = "position_friction"
    at = {"guide": {}}
    without = ("viscous",)
'''


def test_an_instance_leaves_out_what_its_place_need_not_have(folder: Path) -> None:
    path = folder / "plants" / "axis.py"
    text = path.read_text().replace("import Input", "import Input, Instance")
    head, body = text.split("\n\n\nclass ", 1)
    body = body.replace("    position = State", "    instances = (RoughPlace,)\n    position = State", 1)
    text = f"{head}\n{DRY_ALONE}\n\nclass {body}"
    place = next(name for name in ("guide", "friction") if f"{name} = contact(" in text)
    text = text.replace('{"guide": {}}', f'{{"{place}": {{}}}}')
    path.write_text(text)
    effect = library_of("axis").effects["rough_place"]
    assert list(effect.parameters) == ["amplitude", "period", "phase", "concentration"]
    assert "friction_viscous" not in effect.terms and "friction_coulomb" in effect.terms
    path.write_text(text.replace('("viscous",)', '("viscos",)'))
    with pytest.raises(UsageError, match=r"unknown slot 'viscos'.*did you mean 'viscous'"):
        library_of("axis")


TWO = '''"""Two carriages."""
from hjcamp.plant import Input, Measured, Parameter, Plant, State, body, contact, outside, sensor


class Two(Plant):
    """Two carriages on one guide, coupled by a spring."""

    x = State("m", typical=0.1)
    v = State("m/s", typical=0.05)
    y = State("m", typical=0.1)
    w = State("m/s", typical=0.05)
    pull = Input("N", typical=50.0)
    stiffness = Parameter("N/m", 1e4)
    mass = Parameter("kg", 10.0, base=True)
    dry1 = Parameter("N", 20.0)
    dry2 = Parameter("N", 5.0)
    stuck2 = Parameter("N", 8.0)
    x_m = Measured("gauge_x", of="x")

    @staticmethod
    def equations(state, parameter, drive, rate):
        load = outside("N")
        between = parameter.stiffness * (state.y - state.x)
        first = contact(state.v, push=drive.pull + between + load, coulomb=parameter.dry1, load=between)
        second = contact(state.w, push=-between, coulomb=parameter.dry2, static=parameter.stuck2, travel=state.y)
        rate.x = state.v
        rate.v = body(drive.pull + between + load - first, mass=parameter.mass, load=load, position=state.x)
        rate.y = state.w
        rate.w = (-between - second) / parameter.mass
        gauge_x = sensor(state.x)
'''


def test_at_two_contacts_an_effect_acts_on_each_and_on_those_alone_that_offer_its_names(folder: Path) -> None:
    (folder / "plants" / "two.py").write_text(TWO)
    plant, found = find_plant("two"), load_effects(plant="two")
    # where each stands its rates say
    for name in ("coulomb_asymmetry", "presliding", "stribeck_excess", "static_friction_ageing", "position_friction"):
        assert {f"{name}_at_first", f"{name}_at_second"} <= set(found) and name not in found
    assert {"stribeck_friction", "load_friction"} <= set(found)
    # the load is a line that is no slot or signal: it is made one for whoever reads it
    assert found["load_friction"].terms["first_coulomb"].arguments == ("first_load", "coefficient")
    assert found["coulomb_asymmetry_at_second"].terms["second_static"].arguments[1] == "direction_second"
    for name in ("coulomb_asymmetry_at_first", "coulomb_asymmetry_at_second", "load_friction"):
        for check in PLACE_CHECKS.values():
            assert check(PlaceBench(found[name], plant))


def test_a_store_has_a_capacity_or_a_stiffness(folder: Path) -> None:
    path = folder / "plants" / "rotor.py"
    path.write_text(path.read_text().replace("stiffness=parameter.stiffness)", "capacity=1.0, stiffness=parameter.stiffness)"))
    with pytest.raises(UsageError, match="store 'pressure' a capacity or a stiffness, which is 1 over it, not both"):
        library_of("rotor")
