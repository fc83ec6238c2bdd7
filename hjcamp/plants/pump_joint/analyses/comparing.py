"""Models compared with measured tests of the joint."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from hjcamp.analyses.comparing import check_models
from hjcamp.analyses.data import Data, Report, silent
from hjcamp.plants.pump_joint.analyses.evidence import evidence_in

if TYPE_CHECKING:
    from hjcamp.plants.pump_joint.diagnosis.compare import Comparison
    from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence


def compare_joint(data: Data, names: Sequence[str], report: Report = silent) -> Comparison:
    """Return saved models of the joint on its tests (`hjcamp.plants.pump_joint.diagnosis.compare`)."""
    from hjcamp.effects import load_effects
    from hjcamp.plants.pump_joint.diagnosis.compare import compare
    from hjcamp.plants.pump_joint.diagnosis.models.saved import saved_model

    check_models(names)
    models = {name: saved_model(name) for name in names}
    report("reading the tests", 0.02)
    evidence = evidence_in(data)
    calibrated = calibrated_on(names[-1], evidence)
    return compare(evidence, tuple(load_effects().values()), models, calibrated, report)


def calibrated_on(model: str, evidence: Evidence) -> bool:
    """Return whether the base parameters of a saved model were fitted on any of these very logs."""
    from hjcamp.configuration.composer import Composer
    from hjcamp.configuration.saved_model import log_hashes

    origin = Composer().model(model).get("provenance") or {}
    fitted = origin.get("logs_sha256") if isinstance(origin, dict) else None
    return isinstance(fitted, dict) and bool(
        set(fitted.values()) & set(log_hashes(test.log.path for test in evidence.tests).values())
    )
