"""A turn where friction has neither a leap nor a kink is no event: such a contact costs no more than a viscous force."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from plain_kernel import uncompiled
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from hjcamp.effects import load_effects
from hjcamp.known_plants import find_plant
from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.course import Given
from hjcamp.model.run.inputs_along import inputs_along
from hjcamp.model.run.simulator import Ran, Simulator

Array = NDArray[np.float64]
# a rod of 0.1 kg behind a load cell: it swings at 276 Hz and turns nearly three times a sample
MASS, STIFFNESS, VISCOUS, SAMPLES, PERIOD = 0.1, 3e5, 17.0, 30, 5e-3
START = (1e-3, 0.0)
ROD = '''"""A rod behind a stiff load cell."""
from hjcamp.plant import Input, Measured, Parameter, Plant, State, body, contact, sensor


class Rod(Plant):
    """A rod behind a stiff load cell."""

    position = State("m", typical=0.01)
    velocity = State("m/s", typical=1.0)
    travel = Input("m", typical=0.01)
    viscous = Parameter("N*s/m", 17.0)
    more = Parameter("N*s/m", 51.0)
    dry = Parameter("N", 3.0)
    stiffness = Parameter("N/m", 3e5)
    mass = Parameter("kg", 0.1)
    position_m = Measured("encoder", of="position")
    period = 0.005

    @staticmethod
    def equations(state, parameter, drive, rate):
        """Give the rate of every state."""
        held = parameter.stiffness * (drive.travel - state.position)
        friction = contact(state.velocity, FRICTION, travel=state.position)
        rate.position = state.velocity
        rate.velocity = body(held - friction, mass=parameter.mass, position=state.position)
        encoder = sensor(state.position)
'''


def ran(folder: Path, friction: str, effects: dict[str, dict[str, float]] | None = None) -> Ran:
    """Return the rod let go 1 mm from rest."""
    (folder / "plants" / "rod.py").write_text(ROD.replace("FRICTION", friction))
    plant, effects = find_plant("rod"), effects or {}
    library = load_effects(plant=plant)
    model = uncompiled(Simulator(Composition(plant, tuple(library[name] for name in effects)), free=True))
    values = {
        f"{name}.{key}": value for name, own in effects.items() for key, value in (library[name].defaults() | own).items()
    }
    begins, time = np.zeros(SAMPLES, dtype=np.int64), np.arange(SAMPLES) * PERIOD
    begins[0] = 1
    given = Given(PERIOD, begins, time, inputs_along(plant, SAMPLES, travel=np.zeros(SAMPLES)), np.array([START]))
    return model.run_to_ends(model.vector(values), given)


def solved(viscous: tuple[float, float]) -> Array:
    """Return the positions by SciPy, with another viscous friction to each side."""

    def rates(_: float, z: Array) -> list[float]:
        return [z[1], -(STIFFNESS * z[0] + viscous[int(z[1] < 0.0)] * z[1]) / MASS]

    time = np.arange(SAMPLES) * PERIOD
    return np.asarray(solve_ivp(rates, (0.0, time[-1]), START, "DOP853", time, rtol=1e-11, atol=1e-14).y[0])


@pytest.mark.parametrize("viscous", ["parameter.viscous", "(parameter.viscous + parameter.more) / 4.0"])
def test_without_dry_friction_a_sample_is_one_step_however_often_it_turns(folder: Path, viscous: str) -> None:
    found = ran(folder, f"viscous={viscous}")
    turns = expm(np.array([[0.0, 1.0], [-STIFFNESS / MASS, -VISCOUS / MASS]]) * PERIOD)
    exact = [np.linalg.matrix_power(turns, k) @ START for k in range(SAMPLES)]
    np.testing.assert_allclose(found.states, exact, rtol=0.0, atol=1e-10)
    assert found.steps == SAMPLES


@pytest.mark.parametrize(
    ("friction", "effects"),
    [
        ("viscous=(parameter.viscous, parameter.more)", {}),
        ("viscous=0.5 * (parameter.viscous + parameter.more)", {"viscous_asymmetry": {"asymmetry": -0.5}}),
    ],
)
def test_with_another_viscous_friction_to_each_side_a_turn_is_met_where_it_is(
    folder: Path, friction: str, effects: dict[str, dict[str, float]]
) -> None:
    found = ran(folder, friction, effects)
    np.testing.assert_allclose(found.states[:, 0], solved((17.0, 51.0)), rtol=0.0, atol=1e-5)


@pytest.mark.parametrize(
    ("friction", "effects"),
    [
        ("coulomb=parameter.dry, viscous=parameter.viscous", {}),
        ("coulomb=0.0, static=parameter.dry, viscous=parameter.viscous", {}),
        ("viscous=parameter.viscous", {"dry_friction": {"level": 3.0}}),
    ],
)
def test_with_dry_friction_of_the_file_or_of_an_effect_it_comes_to_rest(
    folder: Path, friction: str, effects: dict[str, dict[str, float]]
) -> None:
    found = ran(folder, friction, effects)
    # it swings about 0 and stays where the spring is within the friction
    assert found.states[-1, 1] == 0.0
    assert 0.0 < abs(found.states[-1, 0]) <= 3.0 / STIFFNESS
    assert found.steps > 2 * SAMPLES
