"""The commands in Python: what ``import hjcamp`` gives. Each answer has a frame (polars), a picture, and shows itself in a notebook."""

from hjcamp.notebook.adding import add
from hjcamp.notebook.any_command import FURTHER, Function, command
from hjcamp.notebook.campaigns import plan, report, resume, run, runs, simulate
from hjcamp.notebook.catalogue import effects, new_effect, new_plant, plants
from hjcamp.notebook.comparison import compare
from hjcamp.notebook.data import import_logs, load
from hjcamp.notebook.diagnosis import diagnose
from hjcamp.notebook.models import calibrate

__all__ = [
    "add", "calibrate", "command", "compare", "diagnose", "effects", "import_logs", "load", "new_effect", "new_plant", "plan",
    "plants", "report", "resume", "run", "runs", "simulate",
]  # fmt: skip


def __getattr__(name: str) -> Function:
    if name not in FURTHER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return FURTHER[name]
