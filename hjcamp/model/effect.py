"""The base class of all physical effects: one effect is one class in one file."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable, Mapping
from typing import ClassVar

from hjcamp.errors import UsageError, unknown
from hjcamp.model.parameter import Parameter, State, declared

SUBSYSTEMS = ("pump", "lines", "joint", "sensors")
RESERVED = ("subsystem", "same_as", "examples")


@functools.cache
def arguments(function: Callable[..., float]) -> tuple[str, ...]:
    """Return the names of a function's arguments in order."""
    return tuple(inspect.signature(function).parameters)


def _used(functions: Iterable[Callable[..., float]]) -> set[str]:
    """Return the names of all arguments."""
    return {name for function in functions for name in arguments(function)}


class Effect:
    """A physical effect that a plant's published equations leave out.

    A subclass declares its ``subsystem``, its parameters and its own states as class attributes, and one static
    method per slot that it acts on. The method's name is the slot; its arguments are named after the signals, states,
    inputs and parameters that it uses. A term that takes its slot's own name transforms it, otherwise it adds.
    ``d_z`` gives the rate of the own state ``z``, ``next_z`` its new value once a sample, ``start_z`` where it starts.
    """

    subsystem: ClassVar[str] = ""
    name: ClassVar[str] = ""
    parameters: ClassVar[dict[str, Parameter]] = {}
    states: ClassVar[dict[str, State]] = {}
    # Effects that some setting of this one equals: always fitted as rivals.
    same_as: ClassVar[tuple[str, ...]] = ()
    # Drivers in which the law is exact: where what it leaves still depends on one, it was not this effect.
    exact_in: ClassVar[tuple[str, ...]] = ()
    terms: ClassVar[dict[str, Callable[..., float]]] = {}
    rates: ClassVar[dict[str, Callable[..., float]]] = {}
    updates: ClassVar[dict[str, Callable[..., float]]] = {}
    starts: ClassVar[dict[str, Callable[..., float]]] = {}

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        where = f"effect {cls.__name__}"
        if cls.subsystem not in SUBSYSTEMS:
            raise unknown("subsystem", cls.subsystem, SUBSYSTEMS, where)
        cls.parameters = declared(cls, Parameter)
        cls.states = declared(cls, State)
        cls.terms, cls.rates, cls.updates, cls.starts = {}, {}, {}, {}
        groups = {"d_": cls.rates, "next_": cls.updates, "start_": cls.starts}
        for name, value in vars(cls).items():
            if name.startswith("__") or name in RESERVED or isinstance(value, Parameter | State):
                continue
            if not isinstance(value, staticmethod):
                if callable(value):
                    raise UsageError(f"{where}: '{name}' must be a static method (write @staticmethod above it)")
                continue
            function = value.__func__
            for prefix, group in groups.items():
                if name.startswith(prefix):
                    owned = name.removeprefix(prefix)
                    if owned not in cls.states:
                        raise unknown("own state", owned, cls.states, f"{where}, method '{name}'")
                    group[owned] = function
                    break
            else:
                cls.terms[name] = function
        for owned in cls.states:
            if (owned in cls.rates) == (owned in cls.updates):
                raise UsageError(f"{where}: state '{owned}' needs exactly one of d_{owned} and next_{owned}")
        if not cls.terms:
            raise UsageError(f"{where}: no term; write one static method named after a slot")
        if not cls.parameters:
            raise UsageError(f"{where}: no Parameter; an effect needs at least one")
        for parameter in cls.parameters.values():
            if parameter.each_test and (cls.subsystem != "lines" or parameter.name not in _used(cls.starts.values())):
                raise UsageError(
                    f"{where}: {parameter.name} is marked each_test, which is for what a state of the lines starts with; "
                    "the lines' pressures tell it, nothing else"
                )

    @classmethod
    def sentence(cls) -> str:
        """Return the first sentence of the docstring."""
        return " ".join(inspect.cleandoc(cls.__doc__ or "").partition("\n\n")[0].split())

    @classmethod
    def equation(cls) -> str:
        """Return the equation of the docstring (the text of its ``.. math::`` block), or an empty string."""
        lines = inspect.cleandoc(cls.__doc__ or "").splitlines()
        text: list[str] = []
        inside = False
        for line in lines:
            if line.startswith(".. math::"):
                inside = True
                text.append(line.removeprefix(".. math::").strip())
            elif inside and line.startswith("   "):
                text.append(line.strip())
            elif inside and line.strip():
                break
        return " ".join(part for part in text if part)

    @classmethod
    def defaults(cls) -> dict[str, float]:
        """Return the default value of every parameter, in SI units."""
        return {name: parameter.default for name, parameter in cls.parameters.items()}

    @classmethod
    def checked(cls, values: Mapping[str, float], where: str = "effects") -> dict[str, float]:
        """Return ``values`` completed by the defaults; refuse unknown names and values that are not within bounds.

        ``where`` is the path of the mapping of effects that ``values`` come from.
        """
        full = cls.defaults()
        for name, value in values.items():
            if name not in cls.parameters:
                raise unknown("parameter", name, cls.parameters, f"{where}.{cls.name}")
            full[name] = cls.parameters[name].checked(value, f"{where}.{cls.name}.{name}")
        return full
