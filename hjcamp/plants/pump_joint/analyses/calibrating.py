"""The constants of a joint from its own tests, saved as a model and a rig."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from hjcamp.analyses.data import Data, joined
from hjcamp.errors import UsageError

if TYPE_CHECKING:
    from hjcamp.plants.pump_joint.calibrate.identify import Calibration


@dataclass(frozen=True)
class Identified:
    """The constants of a pump joint, and the files of its model and its rig."""

    found: Calibration
    model: Path
    rig: Path


def identify_joint(
    data: Data, name: str, only: Mapping[str, str], conf: Path = Path("conf"), replace: bool = False
) -> Identified:
    """Identify every constant that these tests of a pump joint support; write model and rig of that name."""
    from hjcamp.configuration.saved_model import check_name
    from hjcamp.configuration.setups import configuration_for
    from hjcamp.plants.pump_joint.calibrate.configuration_file import write_configuration
    from hjcamp.plants.pump_joint.calibrate.identify import identify, one_rig
    from hjcamp.plants.pump_joint.calibrate.identify import only as select
    from hjcamp.records.find import refuse_unanalysed

    check_name(name, conf, replace)
    logs = select(data.logs, only)
    refuse_unanalysed(logs, "calibrate")
    one_rig(logs)
    try:
        found = identify(logs, configuration_for)
    except UsageError as error:
        raise UsageError(
            f"{error}; here constants are read off parts of tests that are made for them: hjcamp diagnose {joined(data.paths)} "
            "estimates them from whole tests of any motion ('calibrated first')"
        ) from error
    origin = {"command": " ".join(["hjcamp calibrate", *map(str, data.paths), f"--as {name}"])}
    model, rig = write_configuration(name, found, configuration_for(tuple(found.hardware.items())), conf, origin)
    return Identified(found, model, rig)


def pairs(lines: Sequence[str]) -> dict[str, str]:
    """Return KEY=VALUE lines of ``--only`` as a mapping."""
    found = {}
    for line in lines:
        key, equals, value = line.partition("=")
        if not equals or not key or not value:
            raise UsageError(f"--only {line}: KEY=VALUE is needed, for example pump=pump2")
        found[key] = value
    return found
