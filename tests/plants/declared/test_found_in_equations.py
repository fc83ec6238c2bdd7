"""What elements are not given, and the equations say: where that stands which is driven, a load, the size of a push."""

from __future__ import annotations

from pathlib import Path

import pytest

from hjcamp.effects import load_effects
from hjcamp.errors import UsageError
from hjcamp.known_plants import plant_called
from hjcamp.model.declare.port import Port
from hjcamp.model.language.quantities import usual_sizes
from hjcamp.model.language.vocabulary import read_vocabulary

SHAFT = '''"""Two wheels and what is between them."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, contact, outside, sensor, transmission


class Shaft(Plant):
    """Two wheels and what is between them."""

    first = State("rad", typical=1.0)
    first_speed = State("rad/s", typical=2.0)
    second = State("rad", typical=1.0)
    second_speed = State("rad/s", typical=2.0)
    torque = Input("N*m", typical=3.0)
    stiffness = Parameter("N*m/rad", 10.0)
    ratio = Parameter("1", 0.5)
    inertia = Parameter("kg*m^2", 0.1, base=True)
    viscous = Parameter("N*m*s/rad", 0.01, base=True)
    first_rad = Measured("encoder", of="first")
    period = 0.01

    @staticmethod
    def equations(state, parameter, drive, rate):
        given = actuator(drive.torque)
        gear = transmission(@passed@)
        shaft = parameter.stiffness * (@bent@)
        rub = contact(state.first_speed, @push@viscous=parameter.viscous)
        rate.first = state.first_speed
        rate.first_speed = body(given - shaft - rub, mass=parameter.inertia@load@)
        rate.second = state.second_speed
        rate.second_speed = shaft / parameter.inertia
        encoder = sensor(state.first)
'''
USUAL = {"passed": "parameter.ratio * state.first", "bent": "gear - state.second", "push": "", "load": ""}


def ports_of(folder: Path, **changed: str) -> dict[str, Port]:
    text = SHAFT
    for name, value in (USUAL | changed).items():
        text = text.replace(f"@{name}@", value)
    (folder / "plants" / "shaft.py").write_text(text)
    return dict(read_vocabulary(plant_called("shaft", "here")).ports)


@pytest.mark.parametrize(
    ("changed", "driven"),
    [
        ({}, "second"),
        ({"bent": "state.second - gear"}, "second"),
        ({"bent": "gear - parameter.ratio * state.second"}, "gear_driven"),
        ({"passed": "parameter.ratio * state.first, driven=state.first"}, "first"),
        ({"passed": "state.first - state.second", "bent": "gear"}, "gear_driven"),
        # a sum is no single state, and two states are two machines
        ({"bent": "gear - (state.second + state.first)"}, ""),
        ({"bent": "gear - state.second + 0.1 * (gear - state.first)"}, ""),
        ({"bent": "gear"}, ""),
    ],
)
def test_where_that_stands_which_is_driven_is_found(folder: Path, changed: dict[str, str], driven: str) -> None:
    assert ports_of(folder, **changed)["gear"].names.get("driven", "") == driven
    backlash = load_effects(plant="shaft")["backlash"]
    # friction holds what is driven where nothing says where it is
    assert list(backlash.states) == ([] if driven else ["held"])
    assert ("gear_twist" in read_vocabulary(plant_called("shaft", "here")).signals) == bool(driven)


def test_the_play_of_a_twist_is_a_dead_zone(folder: Path) -> None:
    ports_of(folder, passed="state.first - state.second", bent="gear")
    term = load_effects(plant="shaft")["backlash"].terms["gear"]
    assert term.arguments == ("gear", "gear_input", "gear_driven", "play")
    for twist, passed in ((0.3, 0.2), (0.05, 0.0), (-0.1, 0.0), (-0.25, -0.15)):
        assert term.function(twist, twist, 0.0, 0.2) == pytest.approx(passed, abs=1e-12)


def test_a_body_without_a_load_has_one_of_its_own(folder: Path) -> None:
    ports = ports_of(folder)
    assert ports["first_speed"].names["force"] == "first_speed_load"
    assert {"spring", "constant_force", "cubic_spring"} & set(load_effects(plant="shaft")) >= {"constant_force"}
    assert "force" not in ports_of(folder, load=", load=0.0")["first_speed"].names
    assert "constant_force" not in load_effects(plant="shaft")
    # a push that is written out would lack it
    assert "force" not in ports_of(folder, push="push=given - shaft, ")["first_speed"].names


def test_a_push_that_is_not_given_is_as_large_as_what_moves_the_mass(folder: Path) -> None:
    ports_of(folder)
    # about the torque and the twist of the shaft, not the viscous friction of 0.02 N m
    assert usual_sizes(plant_called("shaft", "here"))["rub_push"] > 3.0
    assert load_effects(plant="shaft")["dry_friction"].parameters["level"].bounds[1] > 6.0


def test_a_state_that_stands_for_no_state_is_refused() -> None:
    from hjcamp.model.declare.effect import Effect
    from hjcamp.model.declare.parameter import Parameter

    with pytest.raises(UsageError, match=r"helt.*instead of driven"):
        type(
            "Wrong",
            (Effect,),
            {
                "acts_on": "transmission",
                "instead": {"driven": "helt"},
                "play": Parameter("input", 0.1),
                "output": staticmethod(lambda input, play: play),
            },
        )


@pytest.mark.parametrize(
    ("first", "second", "stands"),
    [
        ("state.first_speed", "state.second_speed", "first"),
        ("2.0 * state.first_speed", "state.second_speed", ""),
        ("state.first_speed", "state.first_speed", ""),
    ],
)
def test_where_a_body_and_its_contact_stand_is_found(folder: Path, first: str, second: str, stands: str) -> None:
    text = SHAFT.replace("rate.first = state.first_speed", f"rate.first = {first}")
    text = text.replace("rate.second = state.second_speed", f"rate.second = {second}")
    for name, value in USUAL.items():
        text = text.replace(f"@{name}@", value)
    (folder / "plants" / "shaft.py").write_text(text)
    ports = read_vocabulary(plant_called("shaft", "here")).ports
    assert ports["first_speed"].names.get("position", "") == ports["rub"].names.get("travel", "") == stands
    assert ("spring" in load_effects(plant="shaft")) == bool(stands)
