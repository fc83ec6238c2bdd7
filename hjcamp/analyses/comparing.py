"""Models compared with measured tests."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from hjcamp.analyses.data import Data, Report, silent
from hjcamp.errors import UsageError

if TYPE_CHECKING:
    from hjcamp.analyses.plant_comparison import PlantComparison


def check_models(names: Sequence[str]) -> None:
    """Refuse a model that is named twice."""
    if len(set(names)) < len(names):
        raise UsageError(f"--model {' --model '.join(names)}: each model once")


def compare_plant(data: Data, names: Sequence[str], report: Report = silent) -> PlantComparison:
    """Return saved models of any plant on its tests (`hjcamp.diagnosis.results.comparison`), and without each of their effects."""
    from hjcamp.analyses.plant_comparison import with_lesser
    from hjcamp.diagnosis.results.comparison import compared
    from hjcamp.diagnosis.results.model_file import load_model
    from hjcamp.effects import load_effects

    check_models(names)
    library = load_effects(plant=data.measured.plant)
    models = {name: load_model(name, data.measured.plant, library) for name in names}
    report("compiling, once for these models", 0.05)
    return with_lesser(compared(data.measured, library, models, report), models)
