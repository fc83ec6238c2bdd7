"""No two modules import each other, directly or by way of others, for types only either."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "hjcamp"


def modules(package: Path) -> dict[str, ast.Module]:
    """Return every module of a package by its dotted name."""
    found = {}
    for path in package.rglob("*.py"):
        parts = path.relative_to(package.parent).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = ast.parse(path.read_text(encoding="utf-8"))
    return found


def imported(tree: ast.Module, known: Mapping[str, object]) -> Iterator[str]:
    """Yield the modules among the known ones that a module imports anywhere, in functions and for types too."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (one.name for one in node.names if one.name in known)
        elif isinstance(node, ast.ImportFrom):
            assert not node.level, "imports are absolute"
            names = [f"{node.module}.{one.name}" for one in node.names]
            yield from (own for own in (name if name in known else str(node.module) for name in names) if own in known)


def circle(package: Path) -> list[str]:
    """Return one circle of modules, the first also last; empty where there is none."""
    trees = modules(package)
    try:
        TopologicalSorter({name: {*imported(tree, trees)} - {name} for name, tree in trees.items()}).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def test_no_modules_import_each_other() -> None:
    assert circle(PACKAGE) == []


@pytest.mark.parametrize(
    "back",
    [
        "from own.a import x",
        "import own.a",
        "from own import a",
        "def f():\n    from own.a import x",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from own.a import x",
    ],
)
def test_a_circle_is_found_wherever_an_import_stands(tmp_path: Path, back: str) -> None:
    package = tmp_path / "own"
    package.mkdir()
    for name, text in {
        "__init__": "",
        "a": "from own.b import y\nx = 1",
        "b": "from own.c import z\ny = 1",
        "c": "z = 1",
    }.items():
        (package / f"{name}.py").write_text(text)
    assert circle(package) == []
    (package / "c.py").write_text(back)
    assert {*circle(package)} == {"own.a", "own.b", "own.c"}
