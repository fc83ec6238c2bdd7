"""The truth axis against answers by hand: terminal speed, stiction, a soft start of each contact, files and draws."""

import json
from pathlib import Path

import numpy as np
import pytest

from truth.axis.case import FIELDS, build_axis_case, simulate_axis, write_axis_case
from truth.axis.hidden import FORMS
from truth.axis.plant import Axis, run
from truth.contact import CONTACTS, contact_step, falling
from truth.hidden_form import find_form, level_of

# nothing of the program stands on it: it makes the data of the benchmarks
pytestmark = pytest.mark.study

PULSED = Axis(kp=0.0, kv=0.0, ki=0.0)  # nobody holds it: the pulses alone drive it


def pulsed(axis: Axis, volt: np.ndarray) -> np.ndarray:
    """Return the rows of a test whose voltage is given."""
    none = np.zeros(volt.size)
    return run(axis, none, volt, np.zeros(201), none, 0.5)


@pytest.mark.parametrize("law", range(4))
def test_terminal_speed_and_time_constant(law: int) -> None:
    axis = PULSED._replace(law=float(law), grain=1e-4 if law == 1 else 3e-6)
    speed = pulsed(axis, np.full(3000, 2.0))[:, 4]
    fast = (2.0 * axis.gain - axis.coulomb_positive) / axis.viscous_positive
    lag = axis.mass / axis.viscous_positive
    time = np.arange(3000) * 1e-3 - axis.current_lag
    expected = fast * (1 - np.exp(-time / lag))
    assert np.abs(speed - expected)[50:].max() < 5e-3 * fast


@pytest.mark.parametrize(("law", "creep"), [(0, 0.0), (2, 4e-5), (3, 4e-5)])
def test_stiction_holds_below_the_coulomb_friction(law: int, creep: float) -> None:
    axis = PULSED._replace(law=float(law), grain=3e-6)
    place = pulsed(axis, np.full(2000, 0.9 * axis.coulomb_positive / axis.gain))[:, 3]
    assert place.max() <= creep
    assert np.ptp(place[1000:]) < 1e-9
    smooth = pulsed(axis._replace(law=1.0, grain=1e-3), np.full(2000, 0.9 * axis.coulomb_positive / axis.gain))
    viscous = axis.viscous_positive
    speed = smooth[-1, 4]
    assert axis.coulomb_positive * np.tanh(speed / 1e-3) + viscous * speed == pytest.approx(0.9 * 20.0, rel=1e-3)


@pytest.mark.parametrize("law", range(4))
def test_friction_takes_the_energy_that_the_carriage_had(law: int) -> None:
    speed, work, stretch = 0.2, 0.0, np.zeros(6)
    for _ in range(20000):
        before = speed
        speed, friction = contact_step.py_func(law, speed, 0.0, 5.0, 8.0, 8.0, 0.0, 1e-3 if law == 1 else 5e-6, stretch, 1e-5)
        work += friction * 0.5 * (speed + before) * 1e-5
        if abs(speed) < 1e-3:
            break
    assert work == pytest.approx(0.5 * 5.0 * (0.2**2 - speed**2), rel=2e-2)


def test_the_spring_and_the_place_of_rest_balance() -> None:
    axis = PULSED._replace(spring=1000.0, coulomb_positive=1e-9, coulomb_negative=1e-9, viscous_positive=300.0)
    place = pulsed(axis._replace(viscous_negative=300.0), np.full(8000, 1.0))[-1, 3]
    assert place == pytest.approx(axis.gain / 1000.0, rel=1e-3)


def test_the_falling_friction_has_two_forms() -> None:
    assert falling.py_func(3.0, 0.01, 0.0, 0.0) == falling.py_func(3.0, 0.01, 0.0, 1.0) == 3.0
    assert falling.py_func(3.0, 0.01, 0.01, 0.0) == pytest.approx(3.0 / np.e)
    assert falling.py_func(3.0, 0.01, 0.01, 1.0) == pytest.approx(1.5)


@pytest.mark.parametrize("delayed", ["delay", "sensor_lag"])
def test_a_delay_moves_the_log_in_time(delayed: str) -> None:
    form = {"delay_form": 0.0} if delayed == "delay" else {"sensor_form": 1.0}
    volt = 3.0 * np.sign(np.sin(np.arange(3000) * 6e-3))
    plain, late = pulsed(PULSED, volt), pulsed(PULSED._replace(**{delayed: 8e-3}, **form), volt)
    assert np.abs(late[8:, 0] - plain[:-8, 0]).max() < 2e-5


@pytest.mark.parametrize("seed", range(4))
def test_the_loop_follows_and_the_log_repeats_by_seed(seed: int) -> None:
    case = build_axis_case("nothing", None, seed)
    _, rows = simulate_axis(case.axis, case.use, seed, "train")
    again = simulate_axis(case.axis, case.use, seed, "train")[1]
    assert np.array_equal(rows, again)
    assert np.sqrt(np.mean((rows[:, 0] - rows[:, 2]) ** 2)) < 3e-3 * case.use.stroke
    other = simulate_axis(case.axis, case.use, seed + 1, "train")[1]
    assert not np.array_equal(rows, other)


def test_every_effect_has_a_form_that_the_program_does_not_know() -> None:
    foreign = {form.effect for form in FORMS if not form.ours}
    assert foreign == {form.effect for form in FORMS}
    forms = {(form.effect, form.name) for form in FORMS}
    assert len(forms) == len(FORMS)
    drawn = {find_form(FORMS, "spring", None, seed).name for seed in range(20)}
    assert drawn == {"linear", "cubic", "softening"}


@pytest.mark.parametrize("form", FORMS, ids=lambda form: f"{form.effect}-{form.name}")
def test_what_hides_changes_the_log(form) -> None:
    case = build_axis_case(form.effect, form.name, 2, contact="lugre" if form.effect == "presliding" else "sharp")
    _, rows = simulate_axis(case.axis, case.use, 2, "train")
    plain = simulate_axis(case.plain, case.use, 2, "train")[1]
    again = simulate_axis(case.plain, case.use, 2, "train", 1)[1]
    assert np.isfinite(rows).all()
    if form.visible and form.effect != "asymmetry":
        change, chance = (np.mean((other[:, 1] - plain[:, 1]) ** 2) for other in (rows, again))
        assert change > 1.5 * chance


@pytest.mark.parametrize("one_log", [True, False])
def test_a_case_on_disk(tmp_path: Path, one_log: bool) -> None:
    path = write_axis_case(tmp_path / "case", "stribeck", "hyperbolic", 5, one_log, contact="maxwell")
    answer = json.loads(path.read_text())
    assert (answer["verdict"], answer["effects"], answer["contact"]) == ("effect", ["stribeck_excess"], "maxwell")
    assert set(answer["changes"]) == {"excess", "fall_speed", "fall_form"}
    assert answer["seen"]["change_v"] > answer["seen"]["scatter_v"] > 0
    measured = sorted(file.name for file in (path.parent / "measured").iterdir())
    assert measured == ["train.csv"] if one_log else len(measured) == 18
    table = np.loadtxt(path.parent / "measured" / measured[0], delimiter=",", skiprows=1)
    assert table.shape == (25000 if one_log else 4000, 4)
    with (path.parent / "heldout" / "held_out.csv").open() as stream:
        assert stream.readline().strip() == ",".join(FIELDS.values())
    compile((path.parent / "plants" / "axis.py").read_text(), "axis.py", "exec")


def test_bad_calls_are_refused() -> None:
    with pytest.raises(ValueError, match="known are nothing, stribeck"):
        build_axis_case("stribek")
    with pytest.raises(ValueError, match="known are exponential, hyperbolic"):
        build_axis_case("stribeck", "sine")
    with pytest.raises(ValueError, match="known are sharp"):
        build_axis_case(contact="dry")
    with pytest.raises(ValueError, match="weak, medium, strong"):
        level_of("huge")
    assert CONTACTS == ("sharp", "smooth", "lugre", "maxwell")
