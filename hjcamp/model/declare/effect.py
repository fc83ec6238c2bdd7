"""The base class of all physical effects: one effect is one class in one file."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from hjcamp.errors import UsageError, unknown
from hjcamp.model.declare.parameter import Parameter, State, declared
from hjcamp.model.declare.port import KINDS
from hjcamp.model.files.docstring import docstring_equation, docstring_sentence

RESERVED = ("subsystem", "same_as", "examples", "acts_on", "together", "plant", "only_in", "behind", "instead")


@functools.cache
def parameters_of(function: Callable[..., float]) -> tuple[str, ...]:
    """Return the names of a function's arguments in order."""
    return tuple(inspect.signature(function).parameters)


@dataclass(frozen=True)
class Term:
    """A function of an effect; ``names`` maps its arguments to names of the plant where they differ."""

    function: Callable[..., float]
    names: tuple[tuple[str, str], ...] = ()

    @cached_property
    def arguments(self) -> tuple[str, ...]:
        """The names of the plant or effect that it is called with, in order."""
        other = dict(self.names)
        return tuple(other.get(name, name) for name in parameters_of(self.function))

    def on(self, names: Mapping[str, str]) -> Term:
        """Return the term with the names of a place in a plant."""
        return Term(self.function, tuple(names.items()))


def _used(functions: Iterable[Term]) -> set[str]:
    """Return the names of all arguments."""
    return {name for term in functions for name in term.arguments}


class Effect:
    """A physical effect that a plant's published equations leave out.

    A subclass declares its ``subsystem``, its parameters and its own states as class attributes, and one static
    method per slot that it acts on. The method's name is the slot; its arguments are named after the signals, states,
    inputs and parameters that it uses. A term that takes its slot's own name transforms it, otherwise it adds.
    ``d_z`` gives the rate of the own state ``z``, ``next_z`` its new value once a sample, ``start_z`` where it starts.

    A generic effect ``acts_on`` a kind of place (``hjcamp.model.declare.port.KINDS``) instead: its slots and arguments are the
    names of that kind, the units of its parameters and states products of them ("loss/level"), and their numbers
    multiples of what these usually are. It is bound to each such place of a plant; where it is declared ``together``,
    to all places of a group at once, with a parameter for ``each`` of them where it names that.
    ``only_in`` gives the units that a name of the place must have one of.

    ``instead`` maps a name that not every such place offers to the own state that stands for it there; where the place has it, the
    state is left out.

    ``behind`` names a slot that it changes last: in all its methods that slot is what the other effects have made of it.

    Methods that share lines take them from one function: ``NAME = part(FUNCTION, ...)`` or ``return part(FUNCTION, ...)``.

    An effect in the names of one plant says so: ``plant`` is its name.
    """

    subsystem: ClassVar[str] = ""
    acts_on: ClassVar[str] = ""
    together: ClassVar[bool] = False
    # Parameters of which each place of a group has its own.
    each: ClassVar[tuple[str, ...]] = ()
    only_in: ClassVar[Mapping[str, tuple[str, ...]]] = {}
    plant: ClassVar[str] = ""
    name: ClassVar[str] = ""
    parameters: ClassVar[dict[str, Parameter]] = {}
    states: ClassVar[dict[str, State]] = {}
    # Effects that some setting of this one equals: always fitted as rivals.
    same_as: ClassVar[tuple[str, ...]] = ()
    # Parameter, a deflection for each unit of force or a speed, of which every contact has a little: its form, no effect.
    granted: ClassVar[str] = ""
    # A slot that it brings: it is bound where the plant itself has nothing in it, not where a base parameter would take its place.
    brings: ClassVar[str] = ""
    # A slot that it works on: it is bound where the plant has something in it, or a base parameter would put it there.
    works_on: ClassVar[str] = ""
    # A slot to which it adds a constant: it is bound where no base parameter is in that, which would take its place.
    without_base: ClassVar[str] = ""
    # A slot that it changes last: to its methods that is what all others make of it. It is looked for where one of them bends it.
    behind: ClassVar[str] = ""
    # Own states that stand for names of the place which not every one has.
    instead: ClassVar[Mapping[str, str]] = {}
    # Whether a diagnosis may name it; if not, it is the form of a contact within what is granted, and nothing beyond.
    claimed: ClassVar[bool] = True
    # Drivers in which the law is exact: where what it leaves still depends on one, it was not this effect.
    exact_in: ClassVar[tuple[str, ...]] = ()
    terms: ClassVar[dict[str, Term]] = {}
    rates: ClassVar[dict[str, Term]] = {}
    updates: ClassVar[dict[str, Term]] = {}
    starts: ClassVar[dict[str, Term]] = {}

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        where = f"effect {cls.__name__}"
        if cls.acts_on and cls.acts_on not in KINDS:
            raise unknown("kind of place", cls.acts_on, KINDS, f"{where}, acts_on")
        if not cls.acts_on and not cls.subsystem:
            raise UsageError(
                f"{where}: write subsystem = ..., the part of the plant that it belongs to, or acts_on = ..., "
                f"a kind of place ({', '.join(KINDS)})"
            )
        cls.parameters = declared(cls, Parameter)
        cls.states = declared(cls, State)
        for name in cls.each:
            if name not in cls.parameters:
                raise unknown("parameter", name, cls.parameters, f"{where}, each")
        if "terms" in vars(cls):
            return
        cls.terms, cls.rates, cls.updates, cls.starts = {}, {}, {}, {}
        groups = {"d_": cls.rates, "next_": cls.updates, "start_": cls.starts}
        for name, value in vars(cls).items():
            if name.startswith("__") or name in RESERVED or isinstance(value, Parameter | State):
                continue
            if not isinstance(value, staticmethod):
                if callable(value):
                    raise UsageError(f"{where}: '{name}' must be a static method (write @staticmethod above it)")
                continue
            function = Term(value.__func__)
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
        for name, state in cls.instead.items():
            if state not in cls.states:
                raise unknown("own state", state, cls.states, f"{where}, instead of {name}")
        if cls.behind and cls.behind not in cls.terms:
            raise unknown("slot", cls.behind, cls.terms, f"{where}, behind")
        if cls.behind and cls.behind not in cls.terms[cls.behind].arguments:
            raise UsageError(f"{where}: '{cls.behind}' must take {cls.behind}, which it changes last (behind)")
        if not cls.parameters:
            raise UsageError(f"{where}: no Parameter; an effect needs at least one")
        for parameter in cls.parameters.values():
            if parameter.each_test and (cls.subsystem not in ("", "lines") or parameter.name not in _used(cls.starts.values())):
                raise UsageError(
                    f"{where}: {parameter.name} is marked each_test, which is for what a state of the lines starts with; "
                    "the lines' pressures tell it, nothing else"
                )

    @classmethod
    def sentence(cls) -> str:
        """Return the first sentence of the docstring."""
        return docstring_sentence(cls)

    @classmethod
    def equation(cls) -> str:
        """Return the equation of the docstring (the text of its ``.. math::`` block), or an empty string."""
        return docstring_equation(cls)

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
