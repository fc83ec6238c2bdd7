from pathlib import Path

from hjcamp.notebook import add as add
from hjcamp.notebook import calibrate as calibrate
from hjcamp.notebook import command as command
from hjcamp.notebook import compare as compare
from hjcamp.notebook import diagnose as diagnose
from hjcamp.notebook import effects as effects
from hjcamp.notebook import import_logs as import_logs
from hjcamp.notebook import load as load
from hjcamp.notebook import new_effect as new_effect
from hjcamp.notebook import new_plant as new_plant
from hjcamp.notebook import plan as plan
from hjcamp.notebook import plants as plants
from hjcamp.notebook import report as report
from hjcamp.notebook import resume as resume
from hjcamp.notebook import run as run
from hjcamp.notebook import runs as runs
from hjcamp.notebook import simulate as simulate
from hjcamp.notebook.any_command import Said as _Said

__version__: str

def budget(*words: str | Path, **options: object) -> _Said: ...
def diff(*words: str | Path, **options: object) -> _Said: ...
def explain(*words: str | Path, **options: object) -> _Said: ...
def export(*words: str | Path, **options: object) -> _Said: ...
def history(*words: str | Path, **options: object) -> _Said: ...
def next(*words: str | Path, **options: object) -> _Said: ...
def paper(*words: str | Path, **options: object) -> _Said: ...
def tune(*words: str | Path, **options: object) -> _Said: ...
