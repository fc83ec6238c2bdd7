"""Find what the model of a machine leaves out, from a file of its equations and two recordings of it.

In Python and in notebooks: ``load``, ``simulate``, ``compare``, ``diagnose``, ``add``, ``calibrate``, ``effects``, ``plants``
and the others of ``dir(hjcamp)``; each does what the command of that name does, and is imported when it is first used.
"""

import importlib
import sys
import types
from collections.abc import Callable
from typing import cast

__version__ = "0.1.0"
_NOTEBOOK = "hjcamp.notebook"
#: What there is in Python besides the modules: functions of ``hjcamp.notebook``.
_FUNCTIONS = (
    "add", "budget", "calibrate", "command", "compare", "diagnose", "diff", "effects", "explain", "export", "history", "import_logs",
    "load", "new_effect", "new_plant", "next", "paper", "plan", "plants", "report", "resume", "run", "runs", "simulate", "tune",
)  # fmt: skip


#: Those of them that are packages as well: the package is called.
_PACKAGES = ("effects", "plants", "report")


def __getattr__(name: str) -> object:
    if name in _PACKAGES:
        return importlib.import_module(f"{__name__}.{name}")
    if name not in _FUNCTIONS:
        raise AttributeError(f"module 'hjcamp' has no attribute {name!r}; it has {', '.join(_FUNCTIONS)}")
    return getattr(importlib.import_module(_NOTEBOOK), name)


def __dir__() -> list[str]:
    own = {name for name in globals() if name.startswith("__") or isinstance(globals()[name], _CalledModule)}
    return sorted({*own, *_FUNCTIONS})


class _CalledModule(types.ModuleType):
    """A package that shares its name with a function, such as ``hjcamp.effects``: called, it is the function."""

    def __call__(self, *words: object, **options: object) -> object:
        return _function_of(self)(*words, **options)

    @property
    def __doc__(self) -> str | None:  # type: ignore[override]
        return _function_of(self).__doc__

    @property
    def __signature__(self) -> object:
        from inspect import signature

        return signature(_function_of(self))


def _function_of(package: types.ModuleType) -> Callable[..., object]:
    return cast("Callable[..., object]", getattr(importlib.import_module(_NOTEBOOK), package.__name__.rpartition(".")[2]))


class _Package(types.ModuleType):
    """This package: lets its own packages be called where a function has the same name."""

    def __setattr__(self, name: str, value: object) -> None:
        if name in _PACKAGES and type(value) is types.ModuleType:
            value.__class__ = _CalledModule
        super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
