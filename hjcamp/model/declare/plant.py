"""The base class of all plants: states, parameters, inputs, channels and one function of marked equations."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from difflib import get_close_matches
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, ClassVar

from hjcamp.errors import UsageError, shown, unknown
from hjcamp.model.declare.field import Field, Phase, check_phases
from hjcamp.model.declare.instance import Instance
from hjcamp.model.declare.law import Law
from hjcamp.model.declare.own_names import refuse_own_names
from hjcamp.model.declare.parameter import Channel, Cut, Input, Measured, Parameter, State, declared, finite_number
from hjcamp.model.declare.port import Port
from hjcamp.model.declare.scatter import FrictionScatter
from hjcamp.model.files.cached import cached
from hjcamp.model.files.docstring import docstring_equation, docstring_sentence
from hjcamp.model.files.rooms import ROOMS, open_room

if TYPE_CHECKING:
    from hjcamp.model.declare.course import Course
    from hjcamp.schema import Group

# Whose controller holds the measured motion: one in the tests themselves, or somebody else's.
LOOPS = ("own", "foreign")
# What a user's file says of its plant beside states, inputs, parameters and readings.
SETTABLE = ("phases_before", "phases_after", "period", "loop", "controlled", "one_of", "subsystems", "labels", "rooms")
# What every plant's equations may use: the regime of its contact, the time, and what friction scatters by.
# Of several contacts each has a regime of its own, ``drive.direction_NAME``.
ALWAYS = {
    "friction_scatter": Input("1", 1.0, "factor on static and Coulomb friction at this instant", name="friction_scatter"),
    "direction": Input("1", text="friction regime: 0 held, +1 and -1 moving", name="direction"),
    "time": Input("s", text="time since the start of the command phase", name="time"),
}


class Plant:
    """A machine whose equations effects may extend; a subclass is one file.

    ``period`` is the usual time between samples of its logs, s: the unit of what effects call a ``period``.
    ``instances`` are the generic effects that have names and numbers of their own here: such an effect then acts at
    their places only. ``covers`` says of a generic effect why the plant needs none: what holds it already.
    ``loop`` is "foreign" where a controller outside the equations holds the measured motion: tests are then judged in short
    windows alone, never simulated whole, and `hjcamp next` proposes motions instead of inputs.
    A test follows ``controlled``, a measured field (the first one unless named), with ``choices`` of groups where nothing
    else is said; ``actuation`` is the law between what a controller returns and the inputs. What differs from test to test:
    friction by ``friction_varies``, starts by the ``scatter`` of a state, the ``drawn`` parameters.
    Lines that occur twice are written once, as a function: ``NAME = part(FUNCTION, ...)`` (see `hjcamp.model.declare.marks.part`).
    ``phases_before`` and ``phases_after`` the motion of a test say what is commanded there (`hjcamp.model.declare.field.Phase`).
    ``fields`` of its logs follow from what is measured and given, unless it names them; ``one_of`` them a log must have.
    ``rooms`` are modules that do for this plant alone what the program does for any (`hjcamp.model.files.rooms`): what is done ->
    the module's name, or a file next to the plant's.
    """

    name: ClassVar[str] = ""
    loop: ClassVar[str] = "own"
    period: ClassVar[float] = 1e-3
    subsystems: ClassVar[tuple[str, ...]] = ()
    channels: ClassVar[tuple[Channel, ...]] = ()
    balance: ClassVar[tuple[str, ...]] = ()
    cuts: ClassVar[tuple[Cut, ...]] = ()
    observed: ClassVar[dict[str, tuple[str, str | None]]] = {}
    base_parameters: ClassVar[tuple[str, ...]] = ()
    uncertain: ClassVar[dict[str, float]] = {}
    # Channel: the channel that moves it, and by how much for one unit of that one (SI) where nothing gives way.
    geared: ClassVar[dict[str, tuple[str, float]]] = {}
    states: ClassVar[dict[str, State]] = {}
    parameters: ClassVar[dict[str, Parameter]] = {}
    inputs: ClassVar[dict[str, Input]] = {}
    measured: ClassVar[dict[str, Measured]] = {}
    ports: ClassVar[dict[str, Port]] = {}
    instances: ClassVar[tuple[type[Instance], ...]] = ()
    covers: ClassVar[Mapping[str, str]] = {}
    fields: ClassVar[tuple[Field, ...]] = ()
    one_of: ClassVar[tuple[str, ...]] = ()
    controlled: ClassVar[str] = ""
    choices: ClassVar[Mapping[str, str]] = {}
    actuation: ClassVar[type[Law] | None] = None
    friction_varies: ClassVar[FrictionScatter] = FrictionScatter()
    drawn: ClassVar[tuple[str, ...]] = ()
    # Phases of every test before its motion and after it.
    phases_before: ClassVar[tuple[Phase, ...]] = ()
    phases_after: ClassVar[tuple[Phase, ...]] = ()
    # Configuration groups whose choices name the machine on which a log was made.
    rig: ClassVar[tuple[str, ...]] = ()
    # Those that say how the machine was set up for a test.
    setups: ClassVar[tuple[str, ...]] = ()
    # How people read the names of its channels and parameters, where it is not the name itself.
    labels: ClassVar[Mapping[str, str]] = {}
    rooms: ClassVar[Mapping[str, str]] = {}

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if (finite_number(cls.period) or 0.0) <= 0.0:
            raise UsageError(f"{cls.__name__}: period is {shown(cls.period)}; the seconds between two samples are needed")
        for name in vars(cls):
            meant = [] if hasattr(Plant, name) else get_close_matches(name, SETTABLE, n=1, cutoff=0.75)
            if meant and isinstance(getattr(cls, name), str | int | float | tuple | dict):
                raise UsageError(f"{cls.__name__}: a plant has no '{name}'; did you mean '{meant[0]}'?")
        if cls.loop not in LOOPS:
            raise unknown("loop", str(cls.loop), LOOPS, cls.__name__)
        for name in cls.rooms:
            if name not in ROOMS:
                raise unknown("room", str(name), ROOMS, f"{cls.__name__}, rooms")
        # all are read before any is set: one may be called as these are
        found = (
            declared(cls, State),
            declared(cls, Parameter),
            declared(cls, Input),
            declared(cls, Measured),
            declared(cls, Port),
        )
        cls.states, cls.parameters, cls.inputs, cls.measured, cls.ports = found
        cls.inputs = {**cls.inputs, **{name: item for name, item in ALWAYS.items() if name not in cls.inputs}}
        for name, item in cls.inputs.items():
            sources = [other for other, one in cls.inputs.items() if one.hold == "linear"]
            if item.rate_of and item.rate_of not in sources:
                raise unknown("input that runs on (hold='linear')", item.rate_of, sources, f"{cls.__name__}.{name}, rate_of")
        for name in (*cls.states, *cls.parameters, *cls.inputs, *cls.measured):
            if hasattr(Plant, name):
                raise UsageError(f"{cls.__name__}: '{name}' is a name that every plant has for itself; call this one otherwise")
        check_phases(cls.phases_before, cls.phases_after, tuple(cls.given_inputs()), cls.period, cls.__name__)
        if (cls.phases_before or cls.phases_after) and cls.actuation is not None:
            raise UsageError(f"{cls.__name__}: phases command inputs, which its actuation does already; leave one of them out")
        refuse_own_names((*cls.states, *cls.parameters, *cls.inputs), cls.parameters, cls.__name__)
        if not cls.base_parameters:
            cls.base_parameters = tuple(name for name, item in cls.parameters.items() if item.base)

    @classmethod
    def sampled(cls, period: float) -> type[Plant]:
        """Return the plant with another usual time between samples, s: itself where that is its own."""
        return cls if period == cls.period else _sampled(cls, period)

    @classmethod
    def sentence(cls) -> str:
        """Return the first sentence of the docstring."""
        return docstring_sentence(cls)

    @classmethod
    def equation(cls) -> str:
        """Return the equation of the docstring (the text of its ``.. math::`` block), or an empty string."""
        return docstring_equation(cls)

    @classmethod
    def settings(cls) -> Mapping[str, type[Group]]:
        """Return the configuration groups that describe its hardware and procedure; most plants have parameters alone."""
        return {}

    @classmethod
    def check_settings(cls, config: Mapping[str, Any]) -> None:
        """Raise ``UsageError`` for a configuration of its ``settings`` that cannot be."""

    @classmethod
    def configured(cls, config: Mapping[str, Any]) -> dict[str, float]:
        """Return the parameters, SI, that a configuration of its ``settings`` gives."""
        return {}

    @classmethod
    def told_by(cls, metadata: Mapping[str, str]) -> dict[str, float]:
        """Return the parameters, SI, that a log's metadata tell in words of the plant's own: the choices of its hardware."""
        return {}

    @classmethod
    def blocked(cls, config: Mapping[str, Any]) -> bool:
        """Return whether a configuration of its ``settings`` holds fast what is ``geared``; most plants cannot."""
        return False

    @classmethod
    def courses(cls) -> Mapping[str, Course]:
        """Return the tests on which an effect is tried out; without any its places are looked at one by one."""
        return {}

    @classmethod
    def room_of(cls, name: str) -> ModuleType | None:
        """Return the plant's own module for what is called ``name``, None where that of any plant does it."""
        return open_room(name, cls.rooms[name], Path(inspect.getfile(cls)), cls.name) if name in cls.rooms else None

    @classmethod
    def own_room(cls, name: str) -> ModuleType:
        """Return the plant's own module for what no other plant has; refuse a plant without one."""
        found = cls.room_of(name)
        if found is None:
            raise UsageError(f"plant {cls.name} has no {name}")
        return found

    @classmethod
    def given_inputs(cls) -> dict[str, Input]:
        """Return the inputs that the plant declares itself: what every plant has is not in its logs, nor is the rate of an input."""
        return {name: item for name, item in cls.inputs.items() if name not in ALWAYS and not item.rate_of}

    @classmethod
    def rates_of_inputs(cls) -> dict[str, str]:
        """Return for each input that is the rate of another one that other one."""
        return {name: item.rate_of for name, item in cls.inputs.items() if item.rate_of}

    @classmethod
    def sampled_inputs(cls) -> tuple[str, ...]:
        """Return the inputs that are given from sample to sample, in order: all but the time and the regime."""
        return tuple(name for name in cls.inputs if name not in ("time", "direction"))

    @classmethod
    def cut(cls, name: str) -> Cut:
        """Return the cut called ``name``."""
        return next(cut for cut in cls.cuts if cut.name == name)


@cached
def _sampled(plant: type[Plant], period: float) -> type[Plant]:
    own = {"period": period, "__doc__": plant.__doc__, "__module__": plant.__module__}
    return type(plant.__name__, (plant,), own)
