"""The base class of all plants: states, parameters, inputs, channels and one function of marked equations."""

from __future__ import annotations

from typing import ClassVar

from hjcamp.model.parameter import Channel, Contact, Cut, Input, Parameter, State, declared


class Plant:
    """A machine whose equations effects may extend; a subclass is one file beside the chapter that it follows."""

    name: ClassVar[str] = ""
    subsystems: ClassVar[tuple[str, ...]] = ()
    channels: ClassVar[tuple[Channel, ...]] = ()
    contact: ClassVar[Contact]
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

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        cls.states = declared(cls, State)
        cls.parameters = declared(cls, Parameter)
        cls.inputs = declared(cls, Input)

    @classmethod
    def cut(cls, name: str) -> Cut:
        """Return the cut called ``name``."""
        return next(cut for cut in cls.cuts if cut.name == name)
