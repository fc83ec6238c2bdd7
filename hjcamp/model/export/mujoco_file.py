"""A composed model as MJCF: for each body a joint with its actuators and sensors, and a comment on what they cannot express."""

from __future__ import annotations

import xml.etree.ElementTree as ET

from hjcamp.model.export.joint_values import Joint, Mapped
from hjcamp.model.export.python_file import Exported

# A slide has some inertia and a hinge some mass, which does not matter.
LITTLE = "1e-9"
# Of the friction constraint: rest is held to a ten-thousandth.
HARD = "0.9999 0.9999 0.001 0.5 2"
NOTES = (
    "the mass of a slide, the inertia of a hinge is all that moves: where your links have a part of it, armature is the rest.",
    "frictionloss is a soft constraint: at rest a joint creeps a little.",
    "gainprm is the force (N, N m) for one SI unit of the input that the actuator is named after.",
)


def mujoco_file(exported: Exported, found: Mapped) -> str:
    """Return the text of the file: a model that MuJoCo runs by itself, each joint by itself, without gravity."""
    root = ET.Element("mujoco", model=exported.composition.plant.name)
    source = " ".join(str(dict(exported.source)).split())
    lines = [f"{exported.title}; from {source}", *NOTES, *(f"not expressed: {one}" for one in found.lost)]
    root.append(ET.Comment(" " + "\n     ".join(_within_a_comment(one) for one in lines) + " "))
    ET.SubElement(root, "compiler", angle="radian", autolimits="true")
    period = exported.composition.plant.period
    ET.SubElement(root, "option", timestep=repr(period), integrator="implicitfast", gravity="0 0 0")
    world, actuators = ET.SubElement(root, "worldbody"), ET.Element("actuator")
    for one in found.joints:
        body = ET.SubElement(world, "body", name=one.name)
        inertia = _number(one.inertia)  # not as armature, which MuJoCo leaves out where it sets how hard friction holds
        mass, turning = (inertia, LITTLE) if one.kind == "slide" else (LITTLE, inertia)
        ET.SubElement(body, "inertial", pos="0 0 0", mass=mass, diaginertia=" ".join([turning] * 3))
        ET.SubElement(body, "joint", _joint(one, period))
        for attributes in _actuators(one, len(found.joints) > 1):
            ET.SubElement(actuators, "general", attributes)
    if len(actuators):
        root.append(actuators)
    if found.readings:
        sensors = ET.SubElement(root, "sensor")
        for name, (joint, speed) in found.readings.items():
            ET.SubElement(sensors, "jointvel" if speed else "jointpos", name=name, joint=joint)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def _joint(one: Joint, period: float) -> dict[str, str]:
    values = {"damping": max(one.damping, 0.0), "frictionloss": one.frictionloss}
    if one.stiffness > 0.0:
        values |= {"stiffness": one.stiffness, "springref": one.offset / one.stiffness}
    words = {"name": one.name, "type": one.kind, "axis": "1 0 0"} | {name: _number(value) for name, value in values.items()}
    return words | ({"solreffriction": f"{2.0 * period!r} 1", "solimpfriction": HARD} if one.frictionloss else {})


def _actuators(one: Joint, several: bool) -> list[dict[str, str]]:
    """Return the actuators of a joint; a constant force, and what pushes away, is one without a command."""
    found = []
    for drive in one.drives:
        name = drive.given + (f"_of_{one.name}" if several else "") + ("_lagged" if drive.lag else "")
        lag = {"dyntype": "filterexact", "dynprm": _number(drive.lag)} if drive.lag else {}
        found.append({"name": name, "joint": one.name, "gainprm": _number(drive.gain), **lag})
    away = [0.0 if one.stiffness > 0.0 else one.offset, max(0.0 - one.stiffness, 0.0), max(0.0 - one.damping, 0.0)]
    if any(away):
        bias = " ".join(map(_number, away))
        found.append(
            {"name": f"own_force_of_{one.name}", "joint": one.name, "gainprm": "0", "biastype": "affine", "biasprm": bias}
        )
    return found


def _number(value: float) -> str:
    """Return a value without the rounding of its regression."""
    return f"{value:.8g}"


def _within_a_comment(text: str) -> str:
    while "--" in text:
        text = text.replace("--", "- -")
    return text
