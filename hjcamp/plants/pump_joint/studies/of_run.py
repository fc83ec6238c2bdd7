"""What is said at the end of a run of this joint, and the pictures of its report."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.calibrate.string_slip import string_warning as note

if TYPE_CHECKING:
    from hjcamp.campaign.files.run_folder import RunFolder
    from hjcamp.records.log import TestLog
    from hjcamp.report.build import Report

__all__ = ["next_commands", "note", "pictures"]
#: The campaigns whose logs `hjcamp calibrate` reads.
IDENTIFIED = ("pump_step", "compliance", "leakage", "friction")


def pictures(logs: Sequence[TestLog]) -> dict[str, tuple[str, str]]:
    """Return heading -> (SVG, caption) of every further picture that the logs of a run give."""
    from hjcamp.plants.pump_joint.studies.study_pictures import study_pictures

    return study_pictures(logs)


def next_commands(folder: RunFolder, report: Report) -> list[str]:
    """Return what helps now, each command whole and fit to be run: the tests of one rig, and no check that must fail."""
    from hjcamp.report.check import check

    hardware = PumpJoint.rig
    run = shlex.quote(str(folder.path))
    conditions = folder.plan.conditions
    rigs = {tuple((group, one.choices.get(group)) for group in hardware): None for one in conditions}
    first = next(iter(rigs))
    if folder.plan.campaign in IDENTIFIED:
        only = [f" --only {group}={name}" for group, name in first if len({dict(rig)[group] for rig in rigs}) > 1]
        return [f"hjcamp calibrate {run} --as {_free_model()}{''.join(only)}"]
    paths = [run]
    if len(rigs) > 1:
        own = [one.name for one in conditions if tuple((group, one.choices.get(group)) for group in hardware) == first]
        there = [folder.path / "logs" / name for name in own]
        paths = [shlex.quote(str(path)) for path in there if path.is_dir()]
    commands = ["hjcamp tour"] if report.refitted is not None and not Path("tour").exists() else []
    commands += [f"hjcamp compare {' '.join(paths)}"] if paths else []
    try:
        passes = not check(report.comparison)
    except UsageError:
        return commands
    return [*commands, f"hjcamp report {run} --check default"] if passes else commands


def _free_model() -> str:
    names = (f"my_rig{number}" for number in ("", *range(2, 1000)))
    places = [Path("conf") / group for group in ("model", "rig")]
    return next(name for name in names if not any((place / f"{name}.yaml").exists() for place in places))
