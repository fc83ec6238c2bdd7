"""Places of a known kind in a plant's equations, on which a generic effect may act: a contact, a store, a sensor."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from hjcamp.errors import unknown


@dataclass(frozen=True)
class Kind:
    """A kind of place: the names that an effect may change (``slots``) or read, and what is of equal size to what.

    ``sizes`` maps a slot that is 0 without effects (a loss, an outside force) to the name that has its usual size.
    """

    name: str
    text: str
    slots: tuple[str, ...]
    reads: tuple[str, ...]
    sizes: Mapping[str, str] = field(default_factory=dict)

    @property
    def one(self) -> str:
        """The kind as a sentence calls one of it."""
        return f"{'an' if self.name[0] in 'aeiou' else 'a'} {self.name}"

    @property
    def names(self) -> tuple[str, ...]:
        """Every name that an effect on this kind may use."""
        return (*self.slots, *self.reads)


KINDS: dict[str, Kind] = {
    kind.name: kind
    for kind in (
        Kind(
            "contact",
            "dry friction between two bodies",
            ("static", "coulomb", "viscous", "locks", "friction"),
            ("velocity", "speed", "push", "direction", "travel", "load", "mass", "breakaway", "dither"),
            {"speed": "velocity"},
        ),
        Kind(
            "body",
            "a mass that forces move",
            ("force", "mass"),
            ("position", "angle", "velocity", "acceleration", "push"),
            {"force": "push"},
        ),
        Kind(
            "store",
            "what holds a volume",
            ("loss", "loss_below", "capacity", "stiffness"),
            ("level", "inflow"),
            {"loss": "inflow", "loss_below": "inflow"},
        ),
        # the head is the level upstream, less that downstream where one is given
        Kind("path", "what a flow passes", ("flow",), ("upstream", "downstream", "head")),
        # the flow is that towards the far end
        Kind("line", "what carries the level of a store to where it acts", ("far",), ("level", "flow")),
        Kind(
            "partition",
            "what parts two stores of one quantity that no path joins: a piston, a wall",
            ("loss", "loss_beyond"),
            ("level", "level_beyond"),
        ),
        Kind("sensor", "what is measured", ("reading",), ("true",)),
        Kind("actuator", "what a command drives", ("command",), ("demand", "supply")),
        # the twist is the input less where what is driven stands, where that is a motion of its own
        Kind("transmission", "what turns one motion into another", ("output",), ("input", "torque", "driven", "twist")),
    )
}


class Port:
    """One place of a plant: its kind, and the plant's name for each name of the kind that it offers.

    Declared as a class attribute, ``seal = Port("contact", velocity="slider_velocity", ...)``, or made by an element
    of the equations. Ports of one ``group`` are similar (two lines of one make): an effect that is declared ``together``
    acts on all of them with one set of parameters. ``like`` maps a slot that is 0 without effects to a name of the plant
    that has its usual size.
    """

    def __init__(
        self,
        kind: str,
        *,
        name: str = "",
        group: str = "",
        subsystem: str = "",
        like: Mapping[str, str] | None = None,
        **names: str,
    ) -> None:
        if kind not in KINDS:
            raise unknown("kind of port", kind, KINDS)
        for local in names:
            if local not in KINDS[kind].names:
                raise unknown("name", local, KINDS[kind].names, f"a port of the kind '{kind}'")
        self.kind, self.name, self.group, self.subsystem = kind, name, group, subsystem
        self.names: Mapping[str, str] = names
        self.like: Mapping[str, str] = like or {}

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = self.name or name

    def but(self, names: Mapping[str, str]) -> Port:
        """Return this place with some of its names for others of the plant."""
        changed = {local: name for local, name in names.items() if local in KINDS[self.kind].names}
        return Port(
            self.kind,
            name=self.name,
            group=self.group,
            subsystem=self.subsystem,
            like=self.like,
            **{**self.names, **changed},
        )

    def size_of(self, local: str) -> str:
        """Return the plant's name that has the usual size of a name of this place."""
        other = KINDS[self.kind].sizes.get(local, local)
        return self.like.get(local) or self.names.get(other) or self.names[local]

    def lacks(self, wanted: set[str]) -> set[str]:
        """Return those of the wanted names that this place does not offer."""
        return wanted - set(self.names)

    def __repr__(self) -> str:
        return f"Port({self.kind} {self.name})"
