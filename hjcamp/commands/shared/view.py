"""Show logs in Foxglove, PlotJuggler or Rerun: the layout is written, the viewer is begun where it is installed."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from hjcamp.errors import HjcampError, UsageError, unknown
from hjcamp.records.log import TOPIC, TestLog
from hjcamp.records.of_plant import plant_of
from hjcamp.storage import check_place, file_name

#: What each viewer's program may be called.
PROGRAMS = {
    "foxglove": ("foxglove-studio", "foxglove", "Foxglove"),
    "plotjuggler": ("plotjuggler",),
    "rerun": ("rerun",),
}
MOST = 20


@dataclass(frozen=True)
class View:
    """What was written for one viewer: what it opens, the command that does so, and what a person has to do."""

    viewer: str
    files: tuple[Path, ...]
    command: tuple[str, ...]
    installed: bool
    advice: str = ""


def prepare_view(logs: list[Path], viewer: str, into: Path) -> View:
    """Write what a viewer needs for some logs of one plant; raises ``UsageError`` for an unknown viewer or too many logs."""
    from hjcamp.live.describe import channels_of, phases_of
    from hjcamp.records.read import read_log
    from hjcamp.records.views.rerun_view import write_recording
    from hjcamp.records.views.viewer_layouts import write_layouts

    if viewer not in PROGRAMS:
        raise unknown("viewer", viewer, PROGRAMS, "--with")
    if len(logs) > MOST:
        raise UsageError(f"{len(logs)} logs; a viewer is given {MOST} at most: name those to look at")
    check_place(into, "--into", folder=True)
    read = [(path, read_log(path)) for path in logs]
    plants = {plant_of(log.metadata, str(path)) for path, log in read}
    if len(plants) > 1:
        raise UsageError(f"logs of {', '.join(sorted(one.name for one in plants))}; a layout is for one plant")
    plant = plants.pop()
    channels = channels_of(plant, read[0][1].table)
    there = {name for _, log in read for name in log.columns}
    panels: dict[str, dict[str, str]] = {}
    for one in channels:
        if one["name"] in there:
            unit = f" [{one['unit']}]" if one["unit"] else ""
            panels.setdefault(one["panel"] or "followed", {})[one["name"]] = f"{one['label']}{unit}"
    # a package's program lies beside this Python, whether or not its folder is on the path
    places = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    program = next(filter(None, (shutil.which(name, path=places) for name in PROGRAMS[viewer])), None)
    begin = program or PROGRAMS[viewer][0]
    if viewer == "rerun":
        phases = phases_of(read[0][1].table)
        made = [write_recording(into / f"{_stem(path, log)}.rrd", log, panels, phases) for path, log in read]
        return View(viewer, tuple(made), (begin, *map(str, made)), program is not None)
    states = {"phase": f"{TOPIC}.phase"} if "phase" in there else {}
    layouts = write_layouts(
        into,
        {title: [(TOPIC, name, label) for name, label in fields.items()] for title, fields in panels.items()},
        plant.name,
        states,
    )
    if viewer == "foxglove":
        advice = f"in Foxglove: Layouts, Import from file, {layouts[0]}"
        return View(viewer, (layouts[0],), (begin, *map(str, logs)), program is not None, advice)
    return View(viewer, (layouts[1],), (begin, "--datafile", str(logs[0]), "--layout", str(layouts[1])), program is not None,
                f"PlotJuggler opens one file: {logs[0]}" if len(logs) > 1 else "")  # fmt: skip


def begin_viewer(view: View) -> None:
    """Begin the viewer and leave it to itself; raises ``HjcampError`` where it cannot be begun."""
    try:
        subprocess.Popen(
            view.command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        ).returncode = 0
    except OSError as error:
        raise HjcampError(f"{view.command[0]} cannot be begun: {error.strerror or error}") from error


def _stem(path: Path, log: TestLog) -> str:
    names: Mapping[str, str] = log.metadata
    return file_name(f"{names.get('condition') or path.parent.name}_{path.stem}")
