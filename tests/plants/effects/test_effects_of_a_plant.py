"""``hjcamp effects`` for a plant of a user's: the catalogue, one effect, a new one for any plant, and its checks."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from hjcamp import cli
from hjcamp.effects._generic_template import EXAMPLES, MEANINGS
from hjcamp.model.declare.port import KINDS

CELL = '''"""A cell."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, sensor


class Cell(Plant):
    """A cell that is charged."""

    charge = State("C", typical=10.0)
    current = Input("A", typical=1.0)
    rest = Parameter("V", 4.0)
    bulk = Parameter("F", 1000.0, base=True)
    voltage_v = Measured("terminal")
    period = 1.0

    @staticmethod
    def equations(state, parameter, drive, rate):
        rate.charge = drive.current
        terminal = sensor(parameter.rest + state.charge / parameter.bulk)
'''
POLARISED = '''from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class Polarised(Effect):
    """Voltage that the current adds.

    Source: here.
    """

    plant = "cell"
    subsystem = "cell"
    ohms = Parameter("V/A", 1e-3, (0.0, 1.0), text="voltage for one ampere", off=0.0)

    @staticmethod
    def terminal(current, ohms):
        """Voltage, V."""
        return ohms * current
'''
SAMPLE_PLANT = {"path": "tanks", "store": "tanks", "transmission": "rotor", "partition": "two_pumps", "line": "press"}


def answer(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    """Call ``hjcamp effects WORDS`` and return its exit code and what it printed."""
    code = cli.run(["effects", *words])
    said = capsys.readouterr()
    return code, said.out, said.err


def test_the_catalogue_of_a_plant_names_what_fits_it(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = answer(capsys, "--plant", "tanks")
    assert code == 0 and "20 effects" in out and "overflow_at_lower" in out and "hjcamp plants tanks" in out
    assert "stribeck" not in out and "pump_backlash" not in out
    code, out, _ = answer(capsys)
    assert "22 effects" in out and "kind of place" in out and "overflow" in out and "stribeck_excess" in out


def test_one_effect_is_shown_as_its_plant_has_it(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = answer(capsys, "sensor_lag", "--plant", "axis")
    assert code == 0 and "acts on  encoder" in out and "0.0001 ... 0.2" in out and "period" not in out
    code, out, _ = answer(capsys, "sensor_lag")
    assert code == 0 and "reading of each sensor" in out and "period" in out
    assert not list(folder.glob("*.png"))


@pytest.mark.parametrize("kind", KINDS)
def test_a_new_effect_of_each_kind_passes_its_checks(folder: Path, capsys: pytest.CaptureFixture[str], kind: str) -> None:
    plant = SAMPLE_PLANT.get(kind, "axis")
    assert answer(capsys, "new", "mine", "--on", kind, "--plant", plant)[0] == 0
    text = (folder / "effects" / "mine.py").read_text()
    assert f'acts_on = "{kind}"' in text and max(map(len, text.splitlines())) <= 120
    assert all(name in text for name in KINDS[kind].names) and f"of {plant} offers" in text
    code, out, err = answer(capsys, "test", "mine", "--plant", plant)
    assert code == 0 and "passes" in out and "absent when off" in out, err
    (folder / "effects" / "mine.py").unlink()
    assert answer(capsys, "new", "mine", "--on", kind)[0] == 0
    assert " offers " not in (folder / "effects" / "mine.py").read_text()


def test_every_name_of_every_kind_has_a_meaning() -> None:
    assert set(MEANINGS) == {name for kind in KINDS.values() for name in kind.names}
    assert set(EXAMPLES) == set(KINDS)


def test_at_several_places_each_is_checked(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert answer(capsys, "new", "mine", "--on", "store")[0] == 0
    code, out, _ = answer(capsys, "test", "mine", "--plant", "tanks")
    assert code == 0 and "mine_at_upper passes" in out and "mine_at_lower passes" in out


CHECKS = {
    "units": ("drag * velocity * speed", "drag * velocity", "gives kg/s, but the slot"),
    "computed": ("speed\n", "speed * exp(1e4 * drag / drag)\n", "cannot be computed .*range"),
    "finite": ("speed\n", "speed * (1e200 * speed / speed * 1e200)\n", "division by zero|not finite"),
    "not off": ("off=0.0", "off=0.05", "with drag = .* still differs"),
    "unseen": ("0.1, (0.0", "1e-5, (0.0", "choose larger defaults"),
}


@pytest.mark.parametrize("check", CHECKS)
def test_each_check_can_fail(folder: Path, capsys: pytest.CaptureFixture[str], check: str) -> None:
    assert answer(capsys, "new", "mine", "--on", "contact")[0] == 0
    path = folder / "effects" / "mine.py"
    old, new, said = CHECKS[check]
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))
    code, _, err = answer(capsys, "test", "mine", "--plant", "axis")
    assert code == 2 and re.search(said, err) and "internal error" not in err, err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("new", "mine", "--on", "contacts"), "did you mean 'contact'"),
        (("new", "mine", "--on", "path", "--plant", "axis"), "plant axis has no path. It has: actuator, body"),
        (("new", "mine", "--plant", "axes"), "did you mean 'axis'"),
        (("new", "spring", "--on", "body"), "'spring' is taken"),
        (("new", "encoder_lag", "--on", "body"), "'encoder_lag' is taken"),
        (("--on", "body"), "--on is for a new effect"),
        (("spring", "--figure", "x.png"), "pictures are of tests of pump_joint"),
        (("spring", "--plant", "tanks"), "needs a body"),
        (("test", "spring"), "plant pump_joint needs none"),
        (("--plant", "axes"), "did you mean 'axis'"),
    ],
)
def test_a_wrong_call_is_one_clear_message(
    folder: Path, capsys: pytest.CaptureFixture[str], words: tuple[str, ...], said: str
) -> None:
    code, out, err = answer(capsys, *words)
    assert (code, out) == (2, "") and said in err and err.count("\n") == 1
    assert not (folder / "effects").exists()


def test_an_effect_is_small_or_large_beside_what_moves(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    # a cell of 4 V that moves by 10 mV: 1 mV is seen, though it is a four thousandth of the voltage
    (folder / "plants" / "cell.py").write_text(CELL)
    (folder / "effects").mkdir()
    (folder / "effects" / "polarised.py").write_text(POLARISED)
    code, out, err = answer(capsys, "test", "polarised", "--plant", "cell")
    assert code == 0 and "passes" in out, err
    (folder / "effects" / "polarised.py").write_text(POLARISED.replace("1e-3, (", "1e-6, ("))
    code, _, err = answer(capsys, "test", "polarised", "--plant", "cell")
    assert code != 0 and "choose larger defaults" in err
