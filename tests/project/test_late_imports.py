"""An import stands in a function for one reason: it loads something that its module does not load otherwise."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest
from test_circles import PACKAGE, modules

Import = ast.Import | ast.ImportFrom
FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
ENTRY = "hjcamp.cli"
#: Packages that the command line calls: when they are imported, its entry is loaded already.
CALLED = (".commands.", ".answers.")
#: Late though nothing is saved, by module and what it imports.
NEEDLESS = {
    ("hjcamp.commands.hunting.any_plant", "hjcamp.configuration.composer"): "a test replaces it",
    ("hjcamp.commands.any_plant.calls", "time"): "its one function has the name of a value",
    ("hjcamp.notebook.diagnosis", "hjcamp.notebook.models"): "a value has the same name",
    ("hjcamp.plants.pump_joint.answers.effects", "hjcamp.plants.pump_joint"): "the package gives its equations late",
    ("hjcamp.plants.pump_joint.answers.hunt", "hjcamp.configuration.composer"): "a test replaces it",
    ("hjcamp.plants.pump_joint.answers.next_work", "hjcamp.plants.pump_joint.diagnosis.diagnose"): "a value has the same name",
    ("hjcamp.plants.pump_joint.answers.tables", "hjcamp.plants.pump_joint.tables.diagnosis"): "a function has the same name",
    ("hjcamp.plants.pump_joint.answers.tables", "hjcamp.workers.pool"): "a test replaces it",
    ("hjcamp.plants.pump_joint.commands.tour", "hjcamp.commands"): "a test replaces it",
    ("hjcamp.plants.pump_joint.diagnosis.residuals.views", "hjcamp.effects"): "goes with the joint's own engine",
    ("hjcamp.plants.pump_joint.rig.check", "hjcamp.plants.pump_joint.rig.connection"): "a test replaces it",
}


def loaded_by(node: Import, known: Mapping[str, object]) -> set[str]:
    """The modules that an import loads."""
    if isinstance(node, ast.Import):
        return {one.name for one in node.names}
    return {str(node.module), *(own for one in node.names if (own := f"{node.module}.{one.name}") in known)}


def at_once(node: ast.AST) -> Iterator[Import]:
    """Yield the imports that run with the module itself: not those of functions, nor those for types."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, Import):
            yield child
        elif not isinstance(child, FUNCTIONS) and not (
            isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test)
        ):
            yield from at_once(child)


def late(node: ast.AST) -> Iterator[Import]:
    """Yield the imports that stand in functions."""
    functions = (one for one in ast.walk(node) if isinstance(one, FUNCTIONS))
    yield from (one for function in functions for one in ast.walk(function) if isinstance(one, Import))


def loaded_with(name: str, loads: Mapping[str, set[str]]) -> set[str]:
    """Every module that is loaded once this one is, packages above it too."""
    found: set[str] = set()
    waiting = {name}
    while waiting:
        parts = waiting.pop().split(".")
        new = {".".join(parts[: count + 1]) for count in range(len(parts))} - found
        found |= new
        waiting |= {other for one in new for other in loads.get(one, ())} - found
    return found


def needless(package: Path, entry: str = ENTRY) -> set[tuple[str, str]]:
    """The late imports that load nothing, by module and what is imported."""
    trees = modules(package)
    loads = {name: {other for node in at_once(tree) for other in loaded_by(node, trees)} for name, tree in trees.items()}
    entered = loaded_with(entry, loads) - {entry}
    return {
        (name, node.module or "" if isinstance(node, ast.ImportFrom) else node.names[0].name)
        for name, tree in trees.items()
        for there in [loaded_with(name, loads) | (entered if any(part in f"{name}." for part in CALLED) else set())]
        for node in late(tree)
        if loaded_by(node, trees) <= there
    }


def test_a_late_import_loads_something() -> None:
    assert needless(PACKAGE) == set(NEEDLESS)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("import numpy\ndef f():\n    import numpy", {"numpy"}),
        ("def f():\n    import numpy", set()),
        ("import numpy\ndef f():\n    import numpy.linalg", set()),
        ("def f():\n    from own.light import x", set()),
        ("from own import light\ndef f():\n    from own.light import x", {"own.light"}),
        ("from own.heavy import y\nclass A:\n    async def f(self):\n        from own import light", {"own"}),
        ("from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import numpy\ndef f():\n    import numpy", set()),
        ("try:\n    import numpy\nexcept ImportError:\n    pass\ndef f():\n    import numpy", {"numpy"}),
        ("def f():\n    import json\ndef g():\n    import json", set()),
    ],
)
def test_a_needless_one_is_found(tmp_path: Path, text: str, found: set[str]) -> None:
    package = tmp_path / "own"
    package.mkdir()
    for name, content in {
        "__init__": "",
        "cli": "",
        "light": "x = 1",
        "heavy": "from own.light import x\ny = x",
        "a": text,
    }.items():
        (package / f"{name}.py").write_text(content)
    assert needless(package, "own.cli") == {("own.a", module) for module in found}


@pytest.mark.parametrize(
    ("call", "own", "foreign"),
    [
        ("import hjcamp", 1, set()),
        ("from hjcamp import cli; cli.run(['--help'])", 11, {"typer", "typing_extensions", "annotated_doc", "shellingham"}),
    ],
    ids=["import hjcamp", "hjcamp --help"],
)
def test_what_is_loaded_before_anything_is_asked(call: str, own: int, foreign: set[str]) -> None:
    code = f"import sys; before = set(sys.modules); {call}; print(*sorted(set(sys.modules) - before))"
    done = subprocess.run([sys.executable, "-c", code], cwd=PACKAGE.parent, capture_output=True, text=True, check=True)
    loaded = [name for name in done.stdout.splitlines()[-1].split() if name.partition(".")[0] not in sys.stdlib_module_names]
    assert len([name for name in loaded if name.partition(".")[0] == "hjcamp"]) <= own
    assert {name.partition(".")[0] for name in loaded} - {"hjcamp"} <= foreign


def test_a_plan_loads_nothing_that_it_does_not_need(tmp_path: Path) -> None:
    code = "import sys; from hjcamp import cli; cli.run(['plan', 'campaign=robustness_vertical']); print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    loaded = {name.partition(".")[0] for name in done.stdout.splitlines()[-1].split()}
    assert "hydra" in loaded and not loaded & {"pint", "scipy", "numba", "polars", "matplotlib", "mcap", "joblib"}
