"""The tests of a plan as signals for a rig or a simulator that is not ours, and the map by which its recordings come back."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from hjcamp.backends.plant_simulation import followed_unit, input_field, law_of, model_of, reference_of
from hjcamp.backends.schedule import schedule_of
from hjcamp.controllers.fit import commanded, measured_fields
from hjcamp.errors import UsageError
from hjcamp.known_plants import plant_of
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.field_table import fields_of
from hjcamp.model.language.field_unit import unit_of_field
from hjcamp.records.elsewhere.map_schema import map_schema
from hjcamp.records.plan import Condition, Plan
from hjcamp.schema import editor_line
from hjcamp.storage import check_place, file_names, shown_path, write_whole

MAP = "map.yaml"
HEAD = """# Play each CSV of this folder, record these columns into a file of the same name elsewhere, then:
#   hjcamp import RECORDED/*.csv --map {map} --into logs
# A column that is called otherwise, or in another unit: change it here (hjcamp import --help).
"""


def write_signals(plan: Plan, folder: Path) -> list[Path]:
    """Write a CSV for each test (time, what is commanded or to be followed, units in the names) and the map; return the files.

    A plant whose tests are made in a room of its own has no such signals, and a file that exists stays: ``UsageError``.
    """
    plant = plant_of(plan.conditions[0].config)
    if any(plant_of(one.config) is not plant for one in plan.conditions):
        raise UsageError(f"--signals {shown_path(folder)}: the tests of this plan are of several plants; choose one")
    check_signals(plant, folder)
    names = file_names([f"{test.condition}_rep_{test.repetition:02d}" for test in plan.tests])
    paths = [folder / f"{name}.csv" for name in names]
    for path in (*paths, folder / MAP):
        if path.exists():
            raise UsageError(f"--signals {shown_path(folder)}: {path.name} is there already; give another folder")
    texts = {one.name: _table(one, plant) for one in plan.conditions}
    for path, test in zip(paths, plan.tests, strict=True):
        write_whole(path, texts[test.condition][1])
    columns = dict.fromkeys(column for columns, _ in texts.values() for column in columns)
    files = {
        path.name: _metadata(plan.condition(test.condition), plant, test.repetition)
        for path, test in zip(paths, plan.tests, strict=True)
    }
    write_whole(folder / MAP, _map(plant, list(columns), files, folder))
    return [*paths, folder / MAP]


def check_signals(plant: type[Plant], folder: Path) -> None:
    """Raise ``UsageError`` for a plant whose tests are made in a room of its own, and a folder that cannot be written."""
    if "simulation" in plant.rooms:
        raise UsageError(
            f"--signals {shown_path(folder)}: what plant {plant.name} is sent follows from its own loop and procedure while a test "
            "runs; there is no signal that could be played beforehand"
        )
    check_place(folder / MAP, "--signals")


def _table(condition: Condition, plant: type[Plant]) -> tuple[list[str], str]:
    """Return the columns of a condition's signals, and these as CSV: from the first sample to the last, s and units of the fields."""
    config = condition.config
    law, chosen = law_of(config)
    reference, _ = reference_of(config, plant)
    field, unit = followed_unit(config, plant)
    inputs = list(commanded(law, plant, chosen))
    times = schedule_of(config, plant, inputs, len(reference))
    rest, after = times.first, len(times.phases) - times.last
    followed = reference[:, 0] * unit.scale
    if law.results == ("given",):
        columns = [input_field(plant, name) for name in inputs]
        ends = 0.0, 0.0  # before and after nothing is commanded but by phases
        others = [name for name in plant.given_inputs() if name not in inputs]
    else:
        columns, ends, others = [f"reference_{field}"], (followed[0], followed[-1]), []
    values = np.concatenate([np.full(rest, ends[0]), followed, np.full(after, ends[1])])
    if law.results == ("given",) and inputs:
        values = times.along(values / unit.scale) * unit.scale
    time = np.arange(len(values)) * plant.period
    found = {"time_s": time, **dict.fromkeys(columns, values)}
    for name in others:
        column = input_field(plant, name)
        found[column] = np.full(len(values), plant.inputs[name].default * unit_of_field(column, plant.name).scale)
    text = io.StringIO()
    text.write(",".join(found) + "\n")
    np.savetxt(text, np.column_stack(list(found.values())), fmt="%.9g", delimiter=",")
    return list(found)[1:], text.getvalue()


def _metadata(condition: Condition, plant: type[Plant], repetition: int) -> dict[str, Any]:
    """Return what the map says of one test: its condition, and what the plant is given with each test, SI."""
    values = model_of(condition.config, plant)[1]
    given = {item.given: float(values.get(name, item.default)) for name, item in plant.parameters.items() if item.given}
    return {"condition": condition.name, "repetition": repetition, **given}


def _map(plant: type[Plant], columns: list[str], files: Mapping[str, Mapping[str, Any]], folder: Path) -> str:
    """Return the map: the plant's inputs and readings as columns of these names, and each file's condition."""
    table = fields_of(plant)
    inputs = [input_field(plant, name) for name in plant.given_inputs()]
    wanted = dict.fromkeys(["time_s", *[one for one in columns if one in table.names], *inputs, *measured_fields(plant)])
    fields = {
        name: {"column": name, "unit": "s" if name == "time_s" else unit_of_field(name, plant.name).shown} for name in wanted
    }
    content = {"plant": plant.name, "fields": fields, "files": {name: dict(one) for name, one in files.items()}}
    line = editor_line(folder / MAP, f"map_{plant.name}", map_schema(plant))
    head = line + HEAD.format(map=shown_path(folder / MAP))
    return head + yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=120, default_flow_style=None)
