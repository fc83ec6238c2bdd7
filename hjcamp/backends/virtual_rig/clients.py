"""The rigs that need no file: a plant simulated in this process, and one that is served on this computer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from hjcamp.backends.plant_simulation import apart, law_of, law_values, model_of, plant_in, prepare
from hjcamp.backends.rig.fault import RigUnavailable
from hjcamp.backends.virtual_rig.device import sensed, wiring_of_plant
from hjcamp.backends.virtual_rig.server import ticket_path
from hjcamp.backends.virtual_rig.stepping import VirtualPlant
from hjcamp.json_text import read_json
from hjcamp.rigs.fit import Wiring, channels_of_plant
from hjcamp.rigs.rig import Rig
from hjcamp.rigs.serial_line import SerialRig

SLOW_S = 30.0  # a virtual rig may have to compile its kernel first


def shipped_rig(name: str, config: Mapping[str, Any]) -> Rig:
    """Return the rig that needs no file, ``simulated`` or ``virtual``, for the plant of a configuration."""
    return simulated(config) if name == "simulated" else served(config)


def plant_of_test(config: Mapping[str, Any], seed: int) -> VirtualPlant:
    """Return the plant of a test with the draws of ``backend=simulation``, brought to where the law begins."""
    plant, test = plant_in(config), prepare(config, seed).test
    law, _ = law_of(config)
    known = {one: item.default for one, item in plant.parameters.items()} | apart(model_of(config, plant)[1])[0]
    return VirtualPlant(config, seed, len(test.inputs), test.first, law.begin(law_values(config, law), known))


class Stepped(Rig):
    """A rig whose plant is simulated in this process: one sample for each read."""

    real, lockstep, paced = False, True, True
    config: ClassVar[Mapping[str, Any]] = {}
    wiring: ClassVar[Wiring]
    deadline_s = SLOW_S

    def open(self) -> None:
        """Put the plant to the start of the test."""
        self._stepping = plant_of_test(self.config, self.seed)
        self.put: list[float] = [one.sign * one.safe for one in self.given]

    def read(self) -> Sequence[float]:
        """Return the next sample."""
        found = sensed(self._stepping, self.wiring, self.put)
        self.sample = self._stepping.sample
        return found

    def write(self, values: Sequence[float]) -> None:
        """Set the outputs."""
        self.put = list(values)


def simulated(config: Mapping[str, Any]) -> Rig:
    """Return the plant of a configuration, simulated in this process: the tests are those of ``backend=simulation``."""
    wiring = wiring_of_plant(plant_in(config))
    own = {"config": config, "wiring": wiring, "channels": channels_of_plant(wiring.plant), "name": "simulated"}
    return type("Simulated", (Stepped,), own)()


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
