"""Base parameters of a rig from its own tests, saved as a model."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.analyses.data import Data, Report, joined, silent
from hjcamp.errors import counted

if TYPE_CHECKING:
    from hjcamp.diagnosis.calibration.analysis import Analysis


@dataclass(frozen=True)
class Fitted:
    """The base parameters of any plant: the analysis, rows for programs, the model's file."""

    analysis: Analysis
    rows: dict[str, dict[str, Any]]
    model: Path


def fit_plant(data: Data, name: str, report: Report = silent) -> Fitted:
    """Fit the base parameters of any plant to these tests and save them as ``conf/model/NAME.yaml``."""
    from hjcamp.configuration.saved_model import check_new_name, log_hashes, write_model
    from hjcamp.diagnosis.calibration.analysis import calibrated
    from hjcamp.diagnosis.results.calibration_rows import calibration
    from hjcamp.diagnosis.results.model_file import savable

    path = check_new_name(name)
    measured = data.measured
    report("compiling, once for this plant", 0.05)
    analysis = calibrated(measured, {}, report=report, unknowns=False)
    comment = [f"base parameters of plant {measured.plant.name}, fitted to {counted(len(measured.tests), 'test')}"]
    hashes = log_hashes(test.log.path for test in measured.tests)
    origin = {"command": f"hjcamp calibrate {joined(data.paths)} --as {name}", "logs_sha256": hashes}
    write_model(path, savable(analysis.base.fitted.candidate), comment, origin, measured.plant)
    return Fitted(analysis, calibration(analysis), path)
