"""What the checks of a plant say of where their own inputs drive it, of what diverges, and of what is over within a sample."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hjcamp.errors import UsageError
from hjcamp.known_plants import plant_called
from hjcamp.model.checks import plant_bench
from hjcamp.model.checks.plant_bench import BOTH, SHARES, FarAway, check_within, identified, under_either
from hjcamp.model.checks.plant_clock import rate_slopes, time_constants
from hjcamp.model.declare.plant import Plant

CYLINDER = '''"""A piston on a cushion of gas."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, sensor


class Cylinder(Plant):
    """A piston on a cushion of gas, which a valve fills."""

    position = State("m", typical=0.01)
    pressure = State("Pa", typical=1e4)
    valve = Input("V", typical=@usual@)
    area = Parameter("m^2", 1e-3, base=True)
    gain = Parameter("Pa/s/V", 1e4, base=True)
    leak = Parameter("1/s", 2.0, base=True)
    damping = Parameter("N*s/m", 200.0, base=True)
    stroke = Parameter("m", 0.05)
    period = 0.01
    position_m = Measured("scale", of="position")
    pressure_pa = Measured("gauge", of="pressure")

    @staticmethod
    def equations(state, parameter, drive, rate):
        inside = 1.0 if abs(state.position) < parameter.stroke else 0.0
        rate.position = inside * parameter.area * state.pressure / parameter.damping - state.position * @pull@
        rate.pressure = inside * (parameter.gain * drive.valve - parameter.leak * state.pressure) + (1.0 - inside) * @lost@
        scale = sensor(state.position)
        gauge = sensor(state.pressure)
'''


def plant_of(folder: Path, usual: float = 0.05, pull: float = 2.0, lost: float = 0.0, idle: bool = False) -> type[Plant]:
    text = CYLINDER.replace("@usual@", repr(usual)).replace("@pull@", f"({pull!r} * parameter.leak / 2.0)")
    text = text.replace("@lost@", f"({lost!r} * parameter.leak * state.pressure)")
    if idle:
        text = text.replace("    stroke =", '    idle = Parameter("kg", 1.0, base=True)\n    stroke =')
    (folder / "plants" / "cylinder.py").write_text(text)
    return plant_called("cylinder", "here")


@pytest.mark.study
@pytest.mark.parametrize("far", [0.5 * plant_bench.FAR, plant_bench.FAR, 2.0 * plant_bench.FAR])
def test_inputs_that_drive_a_piston_out_of_its_stroke_are_no_reason_to_refuse_a_plant(
    folder: Path, monkeypatch: pytest.MonkeyPatch, far: float
) -> None:
    monkeypatch.setattr(plant_bench, "FAR", far)
    # of a parameter that nothing shows no size of inputs says otherwise
    with pytest.raises(UsageError, match="the base parameter 'idle' changes nothing that is measured"):
        identified(plant_of(folder, idle=True))
    # twice 100 V would push it 0.25 m, far beyond its stroke, where nothing tells anything; a hundredth of that does not
    assert identified(plant_of(folder, usual=100.0)).startswith("4 base parameters")


@pytest.mark.parametrize(
    ("largest", "said"),
    [
        (0.09, ""),
        (0.2, "drove position to 0.2 m, 20 times its typical"),
        (float("inf"), "position diverges, 0.02 s after a start"),
    ],
)
def test_that_the_inputs_of_a_check_drove_a_state_too_far_is_said(folder: Path, largest: float, said: str) -> None:
    states = np.array([[0.01, 0.0], [0.02, 1e3], [-largest, 1e3]])
    found = ""
    try:
        check_within(plant_of(folder), states, BOTH, 1.0)
    except FarAway as problem:
        found = str(problem)
    assert bool(found) == bool(said) and said in found
    assert not said or "under valve of up to 0.1 V" in found


@pytest.mark.parametrize(
    ("fails", "far", "said"),
    [
        ([], [], "1.0 2"),
        ([(2, 1.0)], [], "1.0 1"),  # a valve cannot open less than not at all
        ([], [(2, 1.0), (1, 1.0)], "0.1 2"),  # a piston in its stroke
        ([(2, 1.0), (1, 1.0)], [], "refused 1.0 2"),
        # what these inputs do not tell, smaller ones tell less
        ([(1, 1.0), (2, 0.1)], [(2, 1.0)], "refused 0.1 2"),
        ([(2, 1.0)], [(1, 1.0)], "0.1 1"),
        ([(2, 0.01), (1, 0.01)], [(2, 1.0), (1, 1.0), (2, 0.1), (1, 0.1)], "refused 0.01 2"),  # where the equations hold
        ([], [(signs, share) for signs in (1, 2) for share in SHARES], "far 1.0 2"),
    ],
)
def test_smaller_inputs_are_tried_where_a_state_left_what_is_usual_of_it(
    fails: list[tuple[int, float]], far: list[tuple[int, float]], said: str
) -> None:
    def check(signs: tuple[float, ...], share: float) -> str:
        for kind, word, places in ((UsageError, "refused", fails), (FarAway, "far", far)):
            if (len(signs), share) in places:
                raise kind(f"{word} {share} {len(signs)}")
        return f"{share} {len(signs)}"

    try:
        found = under_either(check)
    except UsageError as problem:
        found = str(problem)
    assert found == said


@pytest.mark.parametrize(
    ("pull", "period", "said"),
    [
        (2.0, 0.01, "the shortest is 0.5 s, 50 samples"),
        (1e5, 0.01, "(position): far shorter than a sample"),
        (-20.0, 0.01, "position diverges by itself, e-fold in 0.05 s"),
    ],
)
def test_how_fast_a_plant_is_by_itself_is_said(folder: Path, pull: float, period: float, said: str) -> None:
    plant = plant_of(folder, pull=pull)
    assert said in time_constants(plant)
    assert ("diverges" in time_constants(plant)) == (pull < 0.0)
    place = {"s_position": 0.0, "s_pressure": 0.0, "u_valve": 0.0}
    place |= {f"p_{name}": one.default for name, one in plant.parameters.items()}
    assert rate_slopes(plant, place)[0, 0] == pytest.approx(-pull) and rate_slopes(plant, place)[1, 1] == pytest.approx(-2.0)
