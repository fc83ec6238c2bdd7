"""A plant as a class in a cell of a notebook: its file, which any command reads, and what is no such class."""

from __future__ import annotations

import linecache
from pathlib import Path
from typing import Any

import pytest

import hjcamp
from hjcamp.commands.shared.plant_template import TEMPLATE
from hjcamp.errors import UsageError

CELL = TEMPLATE.format(title="MyAxis")


def run_cell(text: str, number: int = 1, **before: Any) -> dict[str, Any]:
    """Run a cell as a notebook does, which keeps its lines under a name that is no file; return the names it made."""
    name = f"<ipython-input-{number}>"
    linecache.cache[name] = (len(text), None, text.splitlines(True), name)
    names = {"__name__": "__main__", **before}
    exec(compile(text, name, "exec"), names)
    return names


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_a_class_in_a_cell_becomes_the_plant_of_its_file() -> None:
    assert hjcamp.new_plant(run_cell(CELL)["MyAxis"]).as_posix() == "plants/my_axis.py"
    made = hjcamp.plants("my_axis")
    hjcamp.new_plant("same")
    told = hjcamp.plants("same")
    assert made.frame.equals(told.frame) and made.sentences() == told.sentences()


def test_a_cell_that_is_run_again_replaces_its_file() -> None:
    hjcamp.new_plant(run_cell(CELL)["MyAxis"])
    assert hjcamp.plants("my_axis").frame["value"].to_list().count("95") == 1
    hjcamp.new_plant(run_cell(CELL.replace("95.0", "81.0"), 2)["MyAxis"])
    assert hjcamp.plants("my_axis").frame["value"].to_list().count("81") == 1


def test_words_that_another_cell_imported_come_along() -> None:
    imports, body = CELL[: CELL.index("class MyAxis")], CELL[CELL.index("class MyAxis") :]
    path = hjcamp.new_plant(run_cell(body, 2, **run_cell(imports, 1))["MyAxis"])
    assert hjcamp.plants("my_axis").plant.name == "my_axis" and path.read_text().count("import") == 1


@pytest.mark.parametrize(
    ("text", "name", "said"),
    [
        ("class Thing:\n    pass\n", "Thing", "Thing is no class of a plant"),
        (CELL.replace("MyAxis", "Def"), "Def", "this is a word of Python"),
    ],
)
def test_what_is_no_plant_is_refused(text: str, name: str, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        hjcamp.new_plant(run_cell(text)[name])
    assert not list(Path().rglob("*.py"))


def test_a_file_that_no_cell_wrote_is_left() -> None:
    path = hjcamp.new_plant("my_axis")
    before = path.read_text()
    with pytest.raises(UsageError, match="exists, and no cell of a notebook wrote it"):
        hjcamp.new_plant(run_cell(CELL)["MyAxis"])
    assert path.read_text() == before


def test_a_class_whose_lines_are_not_known_is_refused() -> None:
    made = run_cell(CELL)["MyAxis"]
    del linecache.cache["<ipython-input-1>"]
    with pytest.raises(UsageError, match="the lines of MyAxis are not known"):
        hjcamp.new_plant(made)
