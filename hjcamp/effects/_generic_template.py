"""The template of a user's own effect for any plant: a small law on one kind of place, to be changed."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from hjcamp.errors import UsageError, unknown
from hjcamp.model.declare.plant import Plant
from hjcamp.model.declare.port import KINDS, Kind
from hjcamp.model.files.template_file import class_name, write_user_file
from hjcamp.model.language.vocabulary import read_vocabulary

TEMPLATE = '''"""{about}"""

from __future__ import annotations

from hjcamp.effect import Effect, Parameter

{names}


class {title}(Effect):
    r"""{sentence} (Say here what is missing in the model.)

    .. math:: {equation}

    Seen as: how a test shows it.
    Not for: what looks similar, and is not it.
    Source: where the equation comes from.
    """

    acts_on = "{kind}"
    {parameter} = Parameter("{unit}", 0.1, (0.0, 2.0), text="{text}", off=0.0)

    @staticmethod
    def {slot}({arguments}):
        """{result}."""
        return {expression}
'''
MEANINGS = {
    "static": "force up to which it holds", "coulomb": "friction at any speed", "viscous": "friction for each unit of speed",
    "locks": "0: it holds nothing, and friction has the sign of the velocity", "friction": "the whole friction",
    "velocity": "positive and negative",
    "speed": "without sign", "push": "force before friction", "direction": "0 held, +1 and -1 moving",
    "travel": "position along it", "load": "what presses on it", "mass": "what moves", "breakaway": "static friction of its own",
    "dither": "what shakes it", "angle": "how far it is turned", "far": "level at the far end",
    "force": "outside force", "position": "of the mass", "acceleration": "of the mass", "loss": "flow lost",
    "loss_below": "flow lost by the store below", "loss_beyond": "flow lost by the other store", "level_beyond": "of the other store",
    "capacity": "inflow for one unit of level", "stiffness": "1 / capacity", "level": "what it holds", "inflow": "net, before losses",
    "flow": "what passes", "upstream": "level there", "downstream": "level there", "head": "upstream, less downstream",
    "reading": "what it shows",
    "true": "true value", "command": "what is delivered", "demand": "what is asked", "supply": "what it draws on",
    "output": "motion passed on", "input": "motion given", "torque": "what it carries", "driven": "where what it drives is",
    "twist": "input, less driven",
}  # fmt: skip


@dataclass(frozen=True)
class Example:
    """A law of one term for the template of a kind."""

    sentence: str
    equation: str
    slot: str
    arguments: str
    expression: str
    parameter: str
    unit: str
    text: str
    result: str


EXAMPLES = {
    "contact": Example(
        "A fluid brakes the contact.", "f \\mathrel{+}= d\\,v\\,|v|", "friction", "velocity, speed, drag",
        "drag * velocity * speed", "drag", "friction/speed**2", "force for each square of the speed", "Drag",
    ),
    "body": Example(
        "A cable pulls the body back.", "F \\mathrel{+}= -k\\,x", "force", "position, pull", "-pull * position", "pull",
        "force/position", "force for each unit of travel", "Force of the cable",
    ),
    "store": Example(
        "A store leaks.", "q \\mathrel{+}= G\\,h", "loss", "level, leak", "leak * level", "leak", "loss/level",
        "flow lost for each unit of level", "Flow lost",
    ),
    "path": Example(
        "A path is partly blocked.", "q \\leftarrow q\\,(1 - b)", "flow", "flow, blocked", "flow * (1.0 - blocked)", "blocked",
        "1", "share of the flow that is held back", "Flow that is left",
    ),
    "line": Example(
        "A line narrows.", "p_2 = p_1 - R\\,q", "far", "flow, resistance", "-resistance * flow", "resistance", "far/flow",
        "drop for each unit of flow", "What the far end lacks",
    ),
    "partition": Example(
        "A piston leaks.", "q \\mathrel{+}= G\\,(p_1 - p_2)", "loss", "level, level_beyond, leak", "leak * (level - level_beyond)",
        "leak", "loss/level", "flow for each unit of difference", "What the first store loses",
    ),
    "sensor": Example(
        "A sensor has a wrong scale.", "y_m = (1 + g)\\,y", "reading", "true, gain_error", "gain_error * true", "gain_error", "1",
        "scale error", "Error of the reading",
    ),
    "actuator": Example(
        "An actuator delivers less than is asked.", "u \\leftarrow (1 - w)\\,u", "command", "command, weakness",
        "command * (1.0 - weakness)", "weakness", "1", "share that is not delivered", "What is delivered",
    ),
    "transmission": Example(
        "A transmission has another ratio.", "y \\mathrel{+}= r\\,x", "output", "input, ratio_error", "ratio_error * input",
        "ratio_error", "1", "error of the ratio", "Motion added",
    ),
}  # fmt: skip
assert EXAMPLES.keys() == KINDS.keys()


def kind_for(plant: type[Plant] | None, on: str) -> Kind:
    """Return the kind for which a template is written; refuse an unknown one and one of which the plant has no place."""
    if on and on not in KINDS:
        raise unknown("kind of place", on, KINDS, "--on")
    if plant is None:
        return KINDS[on]
    found = [port.kind for port in read_vocabulary(plant).ports.values()]
    if not found:
        raise UsageError(f"plant {plant.name} has no place; write its equations with elements (contact, sensor, ...)")
    if on and on not in found:
        raise UsageError(f"plant {plant.name} has no {on}. It has: {', '.join(sorted(set(found)))}")
    return KINDS[on or ("contact" if "contact" in found else found[0])]


def write_generic(name: str, folder: Path, plant: type[Plant] | None, on: str, taken: Iterable[str]) -> Path:
    """Write the template as ``folder``/``name``.py and return its path; refuse a bad or taken name."""
    return write_user_file("effect", name, folder, generic_template(name, plant, on), taken, "arm_spring")


def generic_template(name: str, plant: type[Plant] | None, on: str) -> str:
    """Return the text of the file ``name``.py for effects on a kind of place; ``plant`` shows which places it has."""
    kind = kind_for(plant, on)
    one = EXAMPLES[kind.name]
    return TEMPLATE.format(
        about=f"{one.sentence} For every plant that has {kind.one}.",
        names="\n".join(_names(kind, plant)),
        title=class_name(name),
        kind=kind.name,
        **vars(one),
    )


def _names(kind: Kind, plant: type[Plant] | None) -> list[str]:
    lines = [
        *_wrapped(
            f"It acts on {kind.one}: {kind.text}. A method is named after the slot on which it acts. One that takes the "
            "slot's own name changes the slot, one that does not adds to it. Its other arguments are the names below, "
            "`time`, and the effect's own parameters and states."
        ),
        *_paragraph("Slots", kind.slots),
        *_paragraph("To read", kind.reads),
        "# Units are products of these names and of SI units; a `period` is the time between samples of the plant. Numbers are",
        '# multiples of what that usually is: 0.1 of "coulomb/load" adds a tenth of the usual friction at the usual load.',
        "# Methods that share lines take them from one function of this file: return part(FUNCTION, ...) (hjcamp.plant.part).",
        "# Own state z: z = State(unit) with d_z (rate) or next_z (new value each sample); start_z says where it begins.",
    ]
    if plant is not None:
        for port in read_vocabulary(plant).ports.values():
            if port.kind == kind.name:
                lines += _wrapped(f"{kind.name.capitalize()} '{port.name}' of {plant.name} offers {', '.join(port.names)}.")
    return lines


def _paragraph(heading: str, names: Iterable[str]) -> list[str]:
    return _wrapped(f"{heading}: {', '.join(f'{name} ({MEANINGS[name]})' for name in names)}.")


def _wrapped(text: str) -> list[str]:
    return textwrap.wrap(text, width=116, initial_indent="# ", subsequent_indent="#   ", break_on_hyphens=False)
