"""The templates of a user's own rig: a driver of one's own, a serial line, a converter of National Instruments."""

from __future__ import annotations

from collections.abc import Iterable
from math import isfinite
from pathlib import Path

from hjcamp.controllers.fit import input_field, measured_fields
from hjcamp.model.declare.plant import Plant
from hjcamp.model.files.template_file import class_name, write_user_file
from hjcamp.model.language.field_unit import unit_of_field

HEAD = '''"""The rig of plant {plant}. (Say here what it is.) This file is a program: whoever runs a test on this rig runs it."""

from __future__ import annotations

{imports}


class {title}({base}):
    """Plant {plant} on my bench."""

    plant = "{plant}"
    # One line for each quantity. range: what the sensor shows or the output gives; limits: what makes the rig safe, as does a change
    # above fastest (per s); sign=-1: the driver counts the other way; unit="mm": its numbers are in mm; safe: the output when
    # anything is wrong; nudge: where `hjcamp rig check` puts an output for nudge_s seconds, to see that readings go the right way.
    channels = (
{channels}
    )
    # What makes the outputs safe when this computer no longer does: the device's own watchdog (s), or the name of a hardware
    # interlock; "none" says that nothing does and somebody stays at the emergency stop.
    watchdog_s = None
    interlock = None
'''
DRIVER = '''    deadline_s = 0.1  # of each call below
    paced = False  # True: read() waits for the device's next sample; False: the loop keeps the time

    def open(self):
        """Reach the device; nothing may move."""

    def read(self):
        """Return one number for each measured channel, in the order above."""
        raise OSError("say in this file how the sensors are read")

    def write(self, values):
        """Give each input its number, in the order above."""
        raise OSError("say in this file how the outputs are written")

    def close(self):
        """Let the device go."""
'''
SERIAL = """    port = "/dev/ttyACM0"  # COM3 on Windows
    baud = 115200
    # The protocol, with a sketch for an Arduino: docs/rig_protocol.md. The device names its channels as they are named above.
"""
DAQMX = """    period = {period:g}  # s, of the sample clock
"""


def write_rig_template(name: str, plant: type[Plant], kind: str, folder: Path, taken: Iterable[str]) -> Path:
    """Write the template of a ``kind`` ("driver", "serial", "daqmx") as ``folder``/``name``.py and return its path."""
    bases = {"driver": ("rig", "Rig"), "serial": ("serial_line", "SerialRig"), "daqmx": ("daqmx", "DaqmxRig")}
    module, base = bases[kind]
    imports = "from hjcamp.rigs.rig import Channel, Rig"
    if kind != "driver":
        lines = [f"from hjcamp.rigs.{module} import {base}", "from hjcamp.rigs.rig import Channel"]
        imports = "\n".join(sorted(lines))
    tail = {"driver": DRIVER, "serial": SERIAL, "daqmx": DAQMX.format(period=plant.period)}[kind]
    head = HEAD.format(plant=plant.name, title=class_name(name), base=base, imports=imports, channels=_channels(plant, kind))
    if kind == "serial":
        head = head.replace("    watchdog_s = None\n", "").replace(
            "the device's own watchdog (s), or the name", "the device, which says so, or the name"
        )
    return write_user_file("rig", name, folder, head + tail, taken, "my_bench")


def _channels(plant: type[Plant], kind: str) -> str:
    known = {one.field: one.plausible for one in plant.channels} | {one.name: one.plausible for one in plant.measured.values()}
    lines = []
    for place, field in enumerate(measured_fields(plant)):
        scale = unit_of_field(field, plant.name).scale
        size = (
            abs(plant.states[plant.measured[field].of].typical) if field in plant.measured and plant.measured[field].of else 1.0
        )
        low, high = (
            end * scale if isfinite(end) else sign * 10.0 * size * scale
            for end, sign in zip(known[field], (-1, 1), strict=True)
        )
        terminal = f', terminal="Dev1/ai{place}", scale=1.0' if kind == "daqmx" else ""
        lines.append(
            f'        Channel("{field}", range=({1.2 * low:.4g}, {1.2 * high:.4g}), limits=({low:.4g}, {high:.4g}){terminal}),'
        )
    for place, (name, given) in enumerate(plant.given_inputs().items()):
        scale = unit_of_field(input_field(plant, name), plant.name).scale
        ends = (
            end * scale if isfinite(end) else sign * 2.0 * given.typical * scale
            for end, sign in zip(given.plausible, (-1, 1), strict=True)
        )
        low, high = ends
        terminal = f', terminal="Dev1/ao{place}", scale=1.0' if kind == "daqmx" else ""
        lines.append(f'        Channel("{name}", range=({low:.4g}, {high:.4g}), safe=0.0, nudge=0.0{terminal}),')
    return "\n".join(lines)
