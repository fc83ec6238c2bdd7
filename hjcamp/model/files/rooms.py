"""What a plant may do for itself: the rooms that it may have, and what a module must hold to be one."""

from __future__ import annotations

import importlib
from pathlib import Path
from types import ModuleType

from hjcamp.errors import UsageError
from hjcamp.model.files.user_file import load_module

#: Instead of what is done for any plant: commands, answers in Python, a simulated test, the report of a run, its words.
ROOMS: dict[str, tuple[str, ...]] = {
    "compare": ("compare",),
    "diagnose": ("diagnose",),
    "add": ("add",),
    "calibrate": ("calibrate",),
    "next": ("propose",),
    "hunt": ("judged",),
    # the plant in elements and inputs alone, as the common diagnosis takes it
    "common": ("PLANT",),
    "python": (
        "OVER_NOISE_FLOOR", "compared", "comparison_sentences", "comparison_drawn", "comparison_page", "diagnosed",
        "diagnosis_sentences",
        "diagnosis_drawn", "diagnosis_page", "added", "calibrated",
    ),
    "simulation": ("run_test", "kernel_texts"),
    "nidaqmx": ("run_test",),
    "watches": ("rig_watches",),
    "rig": ("serve", "check"),
    "effects": ("configured", "draw", "paint", "checks"),
    "curve": ("begun",),
    "tune": ("stability_method", "tune_campaign"),
    "run": ("pictures", "note", "next_commands"),
    # asked of the usual plant alone
    "tables": ("diagnose_tables", "compare_tables", "add_table", "is_answer"),
    "kernels": ("warm", "missing"),
    "configuration": ("check_test", "check_model"),
    "indicators": ("INDICATORS", "FURTHER", "error_indicators", "line_indicators"),
    "panels": ("PANELS", "SIGNALS"),
    "published": ("CONDITION", "MEASURED_WITH", "CAMPAIGNS", "cell_key", "published_cells", "standing", "against_refit"),
}  # fmt: skip


def open_room(name: str, module: str, plant_file: Path, plant: str) -> ModuleType:
    """Return the module of a room: by its name, or a file (``calibrate.py``) next to that of the plant.

    Raises ``UsageError`` for a file that cannot be loaded, and for a module without what the room must hold.
    """
    found = load_module(plant_file.with_name(module)) if module.endswith(".py") else importlib.import_module(module)
    for wanted in ROOMS[name]:
        if not hasattr(found, wanted):
            raise UsageError(f"plant {plant}, room '{name}': {module} has no '{wanted}'; it must hold {', '.join(ROOMS[name])}")
    return found
