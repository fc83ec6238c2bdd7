"""Base parameters of a rig from its own tests, saved as a model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.analyses.data import Data, Report, joined, silent
from hjcamp.errors import counted

if TYPE_CHECKING:
    from hjcamp.plants.pump_joint.calibrate.identify import Calibration
    from hjcamp.prediction.analysis import Analysis


@dataclass(frozen=True)
class Identified:
    """The constants of a pump joint, and the files of its model and its rig."""

    found: Calibration
    model: Path
    rig: Path


@dataclass(frozen=True)
class Fitted:
    """The base parameters of any plant: the analysis, rows for programs, the model's file."""

    analysis: Analysis
    rows: dict[str, dict[str, Any]]
    model: Path


def identify_pump_joint(
    data: Data, name: str, only: Mapping[str, str], conf: Path = Path("conf"), replace: bool = False
) -> Identified:
    """Identify every constant that these tests of a pump joint support; write model and rig of that name."""
    from hjcamp.configuration.setups import configuration_for
    from hjcamp.plants.pump_joint.calibrate.configuration_file import check_name, write_configuration
    from hjcamp.plants.pump_joint.calibrate.identify import identify
    from hjcamp.plants.pump_joint.calibrate.identify import only as select
    from hjcamp.records.find import refuse_unanalysed

    check_name(name, conf, replace)
    logs = select(data.logs, only)
    refuse_unanalysed(logs, "calibrate")
    found = identify(logs, configuration_for)
    origin = {"command": " ".join(["hjcamp calibrate", *map(str, data.paths), f"--as {name}"])}
    model, rig = write_configuration(name, found, configuration_for(tuple(found.hardware.items())), conf, origin)
    return Identified(found, model, rig)


def fit_plant(data: Data, name: str, report: Report = silent) -> Fitted:
    """Fit the base parameters of any plant to these tests and save them as ``conf/model/NAME.yaml``."""
    from hjcamp.configuration.saved_model import check_new_name, log_hashes, write_model
    from hjcamp.prediction.analysis import calibrated
    from hjcamp.prediction.answer import calibration
    from hjcamp.prediction.model_file import savable

    path = check_new_name(name)
    measured = data.measured
    report("compiling, once for this plant", 0.05)
    analysis = calibrated(measured, {}, report=report, unknowns=False)
    comment = [f"base parameters of plant {measured.plant.name}, fitted to {counted(len(measured.tests), 'test')}"]
    hashes = log_hashes(test.log.path for test in measured.tests)
    origin = {"command": f"hjcamp calibrate {joined(data.paths)} --as {name}", "logs_sha256": hashes}
    write_model(path, savable(analysis.base.fitted.candidate), comment, origin, measured.plant)
    return Fitted(analysis, calibration(analysis), path)


def pairs(lines: Sequence[str]) -> dict[str, str]:
    """Return KEY=VALUE lines of ``--only`` as a mapping."""
    from hjcamp.errors import UsageError

    found = {}
    for line in lines:
        key, equals, value = line.partition("=")
        if not equals or not key or not value:
            raise UsageError(f"--only {line}: KEY=VALUE is needed, for example pump=pump2")
        found[key] = value
    return found
