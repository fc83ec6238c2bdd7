"""The plant, the motion and the rig file that the tests of rigs share."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from hjcamp.commands.shared.plant_template import TEMPLATE

#: The carriage of the template; a reading has a noise of 2 um.
AXIS = TEMPLATE.format(title="Axis1").replace(
    'Measured("encoder", of="position")', 'Measured("encoder", of="position", noise=2e-6)'
)
#: A motion of 0.4 s under a PID, on any rig.
MOTION = (
    "plant=axis1", "controller=plain_pid", "controller.kp=400", "controller.kd=30", "trajectory=cycloid",
    "trajectory.amplitude_m=0.005", "trajectory.rise_time=0.3", "trajectory.duration=0.4",
)  # fmt: skip
RIG = '''"""A bench."""
from hjcamp.rigs.rig import Channel, Rig

class Bench(Rig):
    """The axis on my bench."""
    plant = "axis1"
    channels = (Channel("position_m", range=(-1.0, 1.0)), Channel("voltage", range=(-10.0, 10.0)))
    def read(self):
        return [0.0]
    def write(self, values):
        pass
'''
Made = Callable[..., dict[str, Any]]
