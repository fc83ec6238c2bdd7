"""Functions, files and folders stay small enough to be read at once; what is longer is named here, with its reason."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MOST_LINES_OF_A_FUNCTION = 60
MOST_LINES_OF_A_FILE = 350
MOST_FILES = 20
PARTS = ("hjcamp", "tests", "benchmarks")
GOES = "goes with the joint's own engine"
STEPS = "the steps of a machine, one loop that is compiled as a whole: parts would share all its variables"
#: Functions that are longer, by file and name, and why.
LONG_FUNCTIONS = {
    ("hjcamp/model/compile/integrator.py", "move"): STEPS,
    ("tests/truth/axis/plant.py", "simulate"): STEPS,
    ("tests/truth/pump_joint/joint.py", "joint_step"): STEPS,
    ("tests/truth/pump_joint/simulate.py", "simulate"): STEPS,
    ("tests/truth/servo/plant.py", "simulate"): STEPS,
    ("hjcamp/plants/pump_joint/plant.py", "equations"): "equations of a plant",
    ("hjcamp/plants/valve_joint/plant.py", "equations"): "equations of a plant",
    ("hjcamp/plants/pump_joint/feedforward.py", "command"): "equations of the thesis in their order",
    ("hjcamp/plants/pump_joint/diagnosis/diagnose.py", "run"): GOES,
}
LONG_FILES: dict[str, str] = {}
FULL_FOLDERS = {
    "hjcamp/effects": "one file for each effect",
    "hjcamp/plants/pump_joint/answers": GOES,
}


def long_functions(root: Path) -> set[tuple[str, str]]:
    """The functions of product, tests and benchmarks that have too many lines, by file and name."""
    return {
        (path.relative_to(root).as_posix(), node.name)
        for name in PARTS
        for path in (root / name).rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))
        and (node.end_lineno or 0) - node.lineno + 1 > MOST_LINES_OF_A_FUNCTION
    }


def long_files(root: Path) -> set[str]:
    """The files under a folder that have too many lines."""
    files = (root / "hjcamp").rglob("*.py")
    return {
        path.relative_to(root).as_posix()
        for path in files
        if len(path.read_text(encoding="utf-8").splitlines()) > MOST_LINES_OF_A_FILE
    }


def full_folders(root: Path) -> set[str]:
    """The folders of product, tests and benchmarks that hold too many modules."""
    parts = [folder for name in PARTS for folder in (root / name, *(root / name).rglob("*"))]
    return {folder.relative_to(root).as_posix() for folder in parts if len(list(folder.glob("*.py"))) > MOST_FILES}


@pytest.mark.parametrize(
    ("found", "named"),
    [(long_functions, LONG_FUNCTIONS), (long_files, LONG_FILES), (full_folders, FULL_FOLDERS)],
    ids=["functions", "files", "folders"],
)
def test_what_is_too_long_is_named_with_its_reason(found: object, named: dict[object, str]) -> None:
    assert found(ROOT) == set(named)  # type: ignore[operator]


def test_too_long_is_found(tmp_path: Path) -> None:
    folder = tmp_path / "hjcamp"
    folder.mkdir()
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "test_long.py").write_text(
        "def test():\n" + "    pass\n" * MOST_LINES_OF_A_FUNCTION, encoding="utf-8"
    )
    (folder / "long.py").write_text("def long():\n" + "    pass\n" * MOST_LINES_OF_A_FUNCTION, encoding="utf-8")
    (folder / "longest.py").write_text("\n" * (MOST_LINES_OF_A_FILE + 1), encoding="utf-8")
    for number in range(MOST_FILES - 1):
        (folder / f"one{number}.py").touch()
    assert long_functions(tmp_path) == {("hjcamp/long.py", "long"), ("tests/test_long.py", "test")}
    assert long_files(tmp_path) == {"hjcamp/longest.py"}
    assert full_folders(tmp_path) == {"hjcamp"}
