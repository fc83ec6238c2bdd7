"""Whether a rig fits a plant: which channel shows what, which commands what, and how its numbers become SI."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.controllers.fit import input_field, measured_fields
from hjcamp.errors import UsageError, unknown
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.field_unit import unit_of_field
from hjcamp.rigs.rig import Channel, Rig, unit_of


@dataclass(frozen=True)
class Wire:
    """A channel of what the plant calls ``name``, a ``field`` of its logs; ``scale``: its driver's number for one SI unit."""

    channel: Channel
    name: str
    field: str
    unit: str
    scale: float

    def si(self, value: float) -> float:
        """Return a number of the channel's own unit in SI."""
        return float(value / abs(self.scale))


@dataclass(frozen=True)
class Wiring:
    """The channels of a rig for one plant: what is measured, in the order of the plant's readings; inputs that are ``read``.

    ``order`` says which number of `Rig.read` is which: first the readings, then the inputs that are read. What is ``given``
    stands in the rig's order.
    """

    plant: type[Plant]
    measured: tuple[Wire, ...]
    read: tuple[Wire, ...]
    given: tuple[Wire, ...]
    order: tuple[int, ...]

    @property
    def readings(self) -> tuple[Channel, ...]:
        """The channels of `Rig.read`, in its order."""
        wires = (*self.measured, *self.read)
        return tuple(wires[self.order.index(place)].channel for place in range(len(wires)))


def channels_of_plant(plant: type[Plant]) -> tuple[Channel, ...]:
    """Return what a rig of a plant must have: all that is measured, then all inputs, in the fields' units and without limits."""
    return tuple(Channel(name) for name in (*measured_fields(plant), *plant.given_inputs()))


def wired(rig: type[Rig] | Rig, plant: type[Plant], commanded: Iterable[str] = ()) -> Wiring:
    """Return how a rig's channels are those of a plant; ``commanded`` are the inputs that a controller commands.

    An input that no law commands may be one of the channels that are read: ``reads`` of the rig names them. Raises ``UsageError`` for a
    channel that the plant has not, a reading or an input that has no channel, and a unit of another kind.
    """
    where = f"rig '{rig.name}', plant {plant.name}"
    fields, inputs = measured_fields(plant), list(plant.given_inputs())
    by_field = {input_field(plant, name): name for name in inputs}
    reads = set(rig.reads)
    known: dict[str, Channel] = {}
    for channel in rig.channels:
        name = by_field.get(channel.name, channel.name) if channel.name not in fields else channel.name
        if name not in fields and name not in inputs:
            raise unknown("channel", channel.name, [*fields, *inputs], where)
        known[name] = channel
    if lost := [name for name in fields if name not in known]:
        raise UsageError(f"{where}: no channel shows {', '.join(lost)}, which the plant measures")
    if lost := [name for name in inputs if name not in known]:
        raise UsageError(f"{where}: no channel gives the input {', '.join(lost)} of the plant")
    if lost := sorted(reads & set(commanded)):
        raise UsageError(f"{where}: the controller commands {', '.join(lost)}, which the rig only reads")
    measured = tuple(_wire(known[name], name, name) for name in fields)
    read = tuple(_wire(known[name], name, input_field(plant, name)) for name in inputs if name in reads)
    given = tuple(
        _wire(one, name, input_field(plant, name)) for name, one in known.items() if name in inputs and name not in reads
    )
    names = [wire.channel.name for wire in (*measured, *read)]
    told = [one.name for one in rig.channels if one.name in names]
    return Wiring(plant, measured, read, given, tuple(told.index(name) for name in names))


def _wire(channel: Channel, name: str, field: str) -> Wire:
    usual = unit_of_field(field, f"channel '{channel.name}'")
    unit = unit_of(channel, usual)
    return Wire(channel, name, field, unit.shown, channel.sign * unit.scale)


def scales(wires: Iterable[Wire]) -> NDArray[np.float64]:
    """Return the driver's numbers for one SI unit of each quantity."""
    return np.array([wire.scale for wire in wires], dtype=np.float64)
