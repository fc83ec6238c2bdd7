"""Models beside measured tests."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from hjcamp.analyses.data import Data, Report, silent
from hjcamp.errors import UsageError

if TYPE_CHECKING:
    from hjcamp.analyses.plant_comparison import PlantComparison
    from hjcamp.plants.pump_joint.diagnosis.compare import Comparison as PumpComparison
    from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence


def check_models(names: Sequence[str]) -> None:
    """Refuse a model that is named twice."""
    if len(set(names)) < len(names):
        raise UsageError(f"--model {' --model '.join(names)}: each model once")


def compare_pump_joint(data: Data, names: Sequence[str], report: Report = silent) -> PumpComparison:
    """Return saved models of the pump joint on its tests (`hjcamp.plants.pump_joint.diagnosis.compare`)."""
    from hjcamp.effects import load_effects
    from hjcamp.plants.pump_joint.diagnosis.compare import compare
    from hjcamp.plants.pump_joint.diagnosis.models.saved import saved_model

    check_models(names)
    models = {name: saved_model(name) for name in names}
    report("reading the tests", 0.02)
    calibrated = calibrated_on(names[-1], data.evidence)
    return compare(data.evidence, tuple(load_effects().values()), models, calibrated, report)


def compare_plant(data: Data, names: Sequence[str], report: Report = silent) -> PlantComparison:
    """Return saved models of any plant on its tests (`hjcamp.prediction.comparison`), and without each of their effects."""
    from hjcamp.analyses.plant_comparison import with_lesser
    from hjcamp.effects import load_effects
    from hjcamp.prediction.comparison import compared
    from hjcamp.prediction.model_file import load_model

    check_models(names)
    library = load_effects(plant=data.measured.plant)
    models = {name: load_model(name, data.measured.plant, library) for name in names}
    report("compiling, once for these models", 0.05)
    return with_lesser(compared(data.measured, library, models, report), models)


def calibrated_on(model: str, evidence: Evidence) -> bool:
    """Return whether the base parameters of a saved model were fitted on any of these very logs."""
    from hjcamp.configuration.composer import Composer
    from hjcamp.configuration.saved_model import log_hashes

    origin = Composer().model(model).get("provenance") or {}
    fitted = origin.get("logs_sha256") if isinstance(origin, dict) else None
    return isinstance(fitted, dict) and bool(set(fitted.values()) & set(log_hashes(test.log.path for test in evidence.tests).values()))
