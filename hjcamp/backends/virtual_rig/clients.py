"""The rigs that need no file: a plant simulated in this process, and one that is served on this computer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from hjcamp.backends.plant_simulation import apart, law_of, law_values, model_of, plant_in, prepare
from hjcamp.backends.rig.fault import RigUnavailable
from hjcamp.backends.virtual_rig.server import ticket_path
from hjcamp.backends.virtual_rig.stepping import VirtualPlant
from hjcamp.controllers.fit import input_field
from hjcamp.json_text import read_json
from hjcamp.model.language.field_unit import unit_of_field
from hjcamp.rigs.fit import channels_of_plant
from hjcamp.rigs.rig import Rig
from hjcamp.rigs.serial_line import SerialRig

SLOW_S = 30.0  # a virtual rig may have to compile its kernel first


def shipped_rig(name: str, config: Mapping[str, Any]) -> Rig:
    """Return the rig that needs no file, ``simulated`` or ``virtual``, for the plant of a configuration."""
    return simulated(config) if name == "simulated" else served(config)


def simulated(config: Mapping[str, Any]) -> Rig:
    """Return the plant of a configuration, simulated in this process: the tests are those of ``backend=simulation``."""
    plant = plant_in(config)

    class Simulated(Rig):
        """The plant itself, one sample for each read."""

        name, real, lockstep, paced = "simulated", False, True, True
        channels = channels_of_plant(plant)
        deadline_s = SLOW_S
        _plant: VirtualPlant

        def open(self) -> None:
            test = prepare(config, self.seed).test
            law, _ = law_of(config)
            values = apart(model_of(config, plant)[1])[0]
            known = {one: item.default for one, item in plant.parameters.items()} | values
            brought = law.begin(law_values(config, law), known)
            self._plant = VirtualPlant(config, self.seed, len(test.inputs), test.first, brought)
            self._put = dict.fromkeys((one.name for one in self.given), 0.0)
            self._out = [unit_of_field(input_field(plant, one.name), plant.name).scale for one in self.given]
            self._in = [unit_of_field(one.name, plant.name).scale for one in self.measured]

        def read(self) -> Sequence[float]:
            seen = self._plant.advance(self._put)
            self.sample = self._plant.sample
            return [float(value * scale) for value, scale in zip(seen, self._in, strict=True)]

        def write(self, values: Sequence[float]) -> None:
            told = zip(self.given, values, self._out, strict=True)
            self._put = {one.name: value / scale for one, value, scale in told}

    return Simulated()


def served(config: Mapping[str, Any]) -> Rig:
    """Return the rig that ``hjcamp rig serve`` serves for the plant of a configuration; raises ``RigUnavailable`` without one."""
    plant = plant_in(config)
    try:
        told = read_json(ticket_path(plant.name))
        where, word, rate = str(told["port"]), str(told["token"]), told["rate"]
    except (OSError, ValueError, KeyError, TypeError):
        raise RigUnavailable(
            f"no virtual rig of plant {plant.name} is served on this computer; start one with: hjcamp rig serve plant={plant.name}"
        ) from None

    class Virtual(SerialRig):
        """A plant that is served on this computer."""

        name, real, lockstep = "virtual", False, rate is None
        channels = channels_of_plant(plant)
        port, token = where, word or "-"
        deadline_s = 2.0

    return Virtual()
