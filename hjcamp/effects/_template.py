"""The template of a user's own effect: a spring on the arm, to be changed, and the names it may use."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from pathlib import Path

from hjcamp.model.declare.plant import Plant
from hjcamp.model.files.template_file import class_name, write_user_file
from hjcamp.model.language.vocabulary import read_vocabulary

TEMPLATE = '''"""A spring on the arm."""

from __future__ import annotations

from hjcamp.effect import Effect, Parameter

{names}


class {title}(Effect):
    r"""A spring pulls the arm back to angle 0. (Say here what is missing in the model.)

    .. math:: F_{{load}} = -k\\,\\theta_a

    Seen as: a force that depends on arm angle, the same in both directions.
    Source: where the equation comes from.
    """

    plant = "{plant}"
    subsystem = "joint"
    stiffness = Parameter("N/rad", 0.5, (0.0, 50.0), text="force on the sliders for each radian", off=0.0)

    @staticmethod
    def load_force(arm_angle, stiffness):
        """Force on the sliders, N."""
        return -stiffness * arm_angle
'''


def template(name: str, plant: type[Plant]) -> str:
    """Return the text of the file ``name``.py for effects on ``plant``."""
    return TEMPLATE.format(names=_names(plant), title=class_name(name), plant=plant.name)


def write_template(name: str, folder: Path, plant: type[Plant], taken: Iterable[str]) -> Path:
    """Write the template as ``folder``/``name``.py and return its path; refuse a bad or taken name."""
    return write_user_file("effect", name, folder, template(name, plant), taken, "arm_spring")


def _names(plant: type[Plant]) -> str:
    vocabulary = read_vocabulary(plant)
    slots = [f"{line.target} [{line.unit}]" for line in vocabulary.slots.values()]
    signals = [f"{line.target} [{line.unit}]" for name, line in vocabulary.signals.items() if name not in vocabulary.slots]
    given = [
        f"{name} [{item.unit}]"
        for group in (plant.states, plant.inputs)
        for name, item in group.items()
        if name not in vocabulary.signals
    ]
    constants = [f"{name} [{item.unit}]" for name, item in plant.parameters.items()]
    return "\n".join(
        [
            "# A method is named after the slot on which it acts. One that takes the slot's own name changes the slot,",
            "# one that does not adds to it. Its other arguments are named after what it uses: the effect's parameters",
            "# and own states, and the names below; of slots and signals, those that stand before its slot. SI units.",
            "# It may be named after a parameter of the plant that is no constant; then it uses states, inputs and parameters.",
            *_paragraph("Slots, in order", slots),
            *_paragraph("Signals, in order", signals),
            *_paragraph("States and inputs", given),
            *_paragraph("Parameters of the plant", constants),
            "# Own state z: z = State(unit, resolution, typical) with d_z (rate) or next_z (new value each sample).",
            "# Methods that share lines take them from one function of this file: return part(FUNCTION, ...) (hjcamp.plant.part).",
            "# Parameter(..., shape=True) enters non-linearly (a length, a time constant).",
        ]
    )


def _paragraph(heading: str, names: list[str]) -> list[str]:
    return textwrap.wrap(
        f"{heading}: {', '.join(names)}.",
        width=116,
        initial_indent="# ",
        subsequent_indent="#   ",
        break_on_hyphens=False,
    )
