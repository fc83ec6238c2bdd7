"""An answer that somebody sent is data: no text of it runs in the effect file that is begun from it."""

from __future__ import annotations

import ast
import copy
import json
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from test_begun_from_a_diagnosis import BELL, SPRING, joint

from hjcamp import cli
from hjcamp.commands.shared.effect_from import write_from_diagnosis
from hjcamp.commands.shared.plant_template import write_template
from hjcamp.effects import load_effects
from hjcamp.effects._written import check_effect_file
from hjcamp.errors import UsageError

RUNS = "__import__('pathlib').Path('PWNED').write_text('x')"
HOSTILE = (
    f'N", 0.0, (0.0, 1.0)); {RUNS}; z = str("', f"N\n{RUNS}\n", f'"""\n{RUNS}\n"""', f"N\r{RUNS}\r#", f"\\\n{RUNS}",
    f"x'); {RUNS}; ('", f"{{{RUNS}}}", f"load(self, a={RUNS}):\n        return 0.0\n\n    def other", f"a - {RUNS}",
    f"N\u2028{RUNS}", "m^9^9^9^9", "__class__", "lambda", RUNS, "N\x00", "N\x1b]0;x\x07",
)  # fmt: skip
TWO_TABLES = SPRING | {"plant": "axis"}


def texts_of(content: Any, place: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield where each text stands in an answer."""
    items = content.items() if isinstance(content, dict) else enumerate(content) if isinstance(content, list) else ()
    for key, value in items:
        if isinstance(value, str):
            yield (*place, key)
        yield from texts_of(value, (*place, key))


def changed(content: dict[str, Any], place: tuple[Any, ...], text: str) -> dict[str, Any]:
    """Return the answer with one text replaced."""
    found = copy.deepcopy(content)
    inside: Any = found
    for key in place[:-1]:
        inside = inside[key]
    inside[place[-1]] = text
    return found


def nothing_runs(name: str) -> None:
    """Load whatever was written, as every command does, and look whether it ran."""
    if Path("effects", f"{name}.py").exists():
        # every file is imported, whatever plant it is for
        with suppress(UsageError):
            load_effects(plant="axis")
    assert not Path("PWNED").exists()


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_template("axis", Path("plants"), [])
    return tmp_path


@pytest.mark.parametrize(
    "content", [TWO_TABLES, joint() | {"plant": "pump_joint"}, SPRING | BELL], ids=["any_plant", "joint", "formula"]
)
def test_no_text_of_an_answer_runs(here: Path, content: dict[str, Any]) -> None:
    Path("effects").mkdir()
    for place in texts_of(content):
        for number, text in enumerate(HOSTILE):
            Path("answer.json").write_text(json.dumps(changed(content, place, text)), encoding="utf-8")
            name = f"mine_{'_'.join(map(str, place))}_{number}"
            with suppress(UsageError):
                written = write_from_diagnosis(name, Path("answer.json"), [], "bell" if "formulas" in content else "")[0]
                check_effect_file(written.read_text(encoding="utf-8"))
                nothing_runs(name)
                written.unlink()
    assert not list(Path("effects").glob("*.py"))


@pytest.mark.parametrize("file", [f"a\n{RUNS}\n.json", f'a""" + {RUNS.replace("/", "")} + """.json', "a\\", "a'\r\n#.json"])
def test_the_name_of_the_file_is_no_code(here: Path, file: str) -> None:
    Path(file).write_text(json.dumps(SPRING), encoding="utf-8")
    assert cli.run(["effects", "new", "mine", "--from", file]) == 0
    assert "mine" in load_effects(plant="axis")
    nothing_runs("mine")


def test_a_text_that_is_none_is_refused_with_the_file(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for place, said in ((("unknowns", 0, "curve", "y_unit"), "unknown unit"), (("unknowns", 0, "signal"), "unknown name")):
        Path("answer.json").write_text(json.dumps(changed(SPRING, place, HOSTILE[0])), encoding="utf-8")
        assert cli.run(["effects", "new", "mine", "--from", "answer.json"]) == 2
        told = capsys.readouterr().err
        assert said in told and "answer.json" in told
        assert not Path("effects").exists()


def test_a_number_that_is_none_is_refused(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for x in ([float("nan"), 0.0, 0.1], [0.0, 0.1, float("inf")], ["0", RUNS, "1"], [10**400, 0, 1]):
        content = copy.deepcopy(SPRING)
        content["unknowns"][0]["knots"] = {"x": x, "y": [1.0, 2.0, 3.0]}
        Path("answer.json").write_text(json.dumps(content), encoding="utf-8")
        assert cli.run(["effects", "new", "mine", "--from", "answer.json"]) == 2
        assert "internal error" not in capsys.readouterr().err
        assert not Path("effects").exists()


GOOD = '''"""About."""
from hjcamp.effect import Effect, Parameter


class Mine(Effect):
    """What it is."""

    plant = "axis"
    amplitude = Parameter("N", 1.0, (0.0, 5.0), off=0.0)

    @staticmethod
    def load(position, amplitude):
        """Force, N."""
        at = 2.0 * min(max(position, 0.0), 1.0)
        return -amplitude * (0.5 * max(0.0, 1.0 - abs(at)))
'''


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"""About."""', f'"""About."""\n{RUNS}'),
        ("import Effect", "import Effect, library"),
        ("Effect, Parameter", "Effect, Parameter as abs"),
        ('plant = "axis"', f'plant = "axis"; other = {RUNS}'),
        ('Parameter("N", 1.0', f'Parameter("N", {RUNS}'),
        ("off=0.0", f"off={RUNS}"),
        ("position, amplitude)", f"position, amplitude={RUNS})"),
        ("position, amplitude)", f"position, amplitude: {RUNS})"),
        ("@staticmethod", f"@{RUNS}"),
        ("class Mine(Effect)", f"class Mine(Effect, metaclass={RUNS})"),
        ("abs(at)", RUNS),
        ("abs(at)", "(lambda: 1.0)()"),
        ("at = 2.0", "Effect.terms = at = 2.0"),
        ('"""Force, N."""', f'f"{{{RUNS}}}"'),
        ("return -amplitude", "global os\n        return -amplitude"),
    ],
)
def test_the_shape_of_a_file_is_one_effect_and_formulas_of_numbers(old: str, new: str) -> None:
    check_effect_file(GOOD)
    assert old in GOOD
    text = GOOD.replace(old, new)
    ast.parse(text)
    with pytest.raises(UsageError, match="more than an effect"):
        check_effect_file(text)
