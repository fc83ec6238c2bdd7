"""A plant that was written in a cell of a notebook, as a file of ./plants, from which logs and models know it."""

from __future__ import annotations

import ast
import linecache
import re
import types
from pathlib import Path
from typing import Any

from hjcamp.errors import UsageError
from hjcamp.model.declare.plant import Plant
from hjcamp.storage import check_place, write_whole

FROM_CELL = "# Written from a cell of a notebook, which writes it again; change it there."


def write_class(plant: type, folder: Path) -> Path:
    """Write the file of a class: its lines as they stand in the cell, after the imports that it needs; returns the path.

    A file that an earlier run of the cell wrote is replaced, any other is left. ``UsageError`` for what is no plant with
    ``equations`` of its own, and for a class whose lines are not known.
    """
    from hjcamp.model.files.template_file import check_user_name

    if not issubclass(plant, Plant) or "equations" not in vars(plant):
        raise UsageError(f"{plant.__name__} is no class of a plant with equations of its own: class {plant.__name__}(Plant)")
    name = re.sub(r"(?<!^)(?=[A-Z])", "_", plant.__name__).lower()
    check_user_name("plant", name, "linear_axis")
    path = folder / f"{name}.py"
    check_place(path)
    if path.exists() and FROM_CELL not in path.read_text(encoding="utf-8", errors="replace").splitlines()[:3]:
        raise UsageError(f"{path} exists, and no cell of a notebook wrote it; it is left as it is")
    lines = _lines_of(plant)
    title = (plant.__doc__ or plant.__name__).strip().splitlines()[0]
    write_whole(path, f"{title!r}\n{FROM_CELL}\n\n{_imports(plant, lines)}\n\n\n{lines}\n")
    return path


def _lines_of(plant: Any) -> str:
    """Return the lines of a class; Python asks a file for them, and a cell is none, but its functions know the cell."""
    cell = "".join(linecache.getlines(plant.equations.__code__.co_filename))
    for node in ast.parse(cell).body:
        if isinstance(node, ast.ClassDef) and node.name == plant.__name__:
            return ast.get_source_segment(cell, node) or ""
    raise UsageError(f"the lines of {plant.__name__} are not known: write it in a cell of a notebook, or as plants/NAME.py")


def _imports(plant: Any, lines: str) -> str:
    """Return the imports of what the lines name: words of `hjcamp.plant`, and modules that the notebook imported."""
    import hjcamp.plant

    around = plant.equations.__globals__
    named = {node.id for node in ast.walk(ast.parse(lines)) if isinstance(node, ast.Name)}
    words = sorted(named.intersection(hjcamp.plant.__all__), key=lambda one: (one.casefold(), one))
    modules = sorted((one.__name__, name) for name in named if isinstance(one := around.get(name), types.ModuleType))
    ours = [f"from hjcamp.plant import {', '.join(words)}"] if words else []
    return "\n".join([*(f"import {module} as {name}" for module, name in modules), *ours])
