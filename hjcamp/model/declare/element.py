"""Elements of a plant's equations: one line that stands for a place of a known kind and its marked lines."""

from __future__ import annotations

import ast
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

from hjcamp.errors import UsageError, unknown
from hjcamp.model.declare.port import KINDS, Port

OPTIONS = ("name", "group", "subsystem")
ABSENT = ("", "0", "0.0")


@dataclass(frozen=True)
class Line:
    """One marked line of an element: its name after the element's own, mark, expression, unit and meaning.

    Braces hold arguments of the element, ``{name}`` the element's own name; ``unit`` is a product of arguments.
    """

    suffix: str
    mark: str
    expression: str
    unit: str
    text: str


@dataclass(frozen=True)
class Element:
    """What an element takes and becomes: ``offers`` maps names of its kind to its lines, in the words of ``Line``.

    ``reads`` are arguments that an effect may read; ``rate`` is the line that is the rate of a state, empty where the
    element is a quantity of its own. ``hints`` says which argument gives a name that is not called like one.
    """

    name: str
    needs: tuple[str, ...]
    takes: tuple[str, ...]
    reads: tuple[str, ...]
    lines: tuple[Line, ...]
    offers: Mapping[str, str]
    rate: str = ""
    hints: Mapping[str, str] = field(default_factory=dict)

    @property
    def arguments(self) -> tuple[str, ...]:
        """Names of all arguments, in order."""
        return (*self.needs, *self.takes, *self.reads)


CONTACT = Element(
    "contact",
    ("velocity",),
    ("push", "coulomb", "viscous", "static"),
    ("travel", "load", "mass", "dither"),
    (
        Line("_push", "signal", "{push}", "push", "force before friction"),
        Line("_forward", "signal", "1.0 if {direction} > 0.0 or ({direction} == 0.0 and {name}_push > 0.0) else 0.0", "1",
             "1 where the friction of the positive direction applies"),
        Line("_speed", "signal", "abs({velocity})", "velocity", "speed without sign"),
        Line("_static", "slot", "drive.friction_scatter * ({static})", "push", "static friction"),
        Line("_coulomb", "slot", "drive.friction_scatter * ({coulomb})", "push", "Coulomb friction"),
        Line("_viscous", "slot", "{viscous}", "push/velocity", "viscous friction"),
        Line("_locks", "slot", "{locks}", "1", "0 where friction passes rest without a leap, and holds nothing"),
        Line("", "slot", "{direction} * {name}_coulomb + {name}_viscous * {velocity}", "push", "friction"),
    ),
    {"static": "{name}_static", "coulomb": "{name}_coulomb", "viscous": "{name}_viscous", "locks": "{name}_locks",
     "friction": "{name}", "velocity": "{velocity}", "speed": "{name}_speed", "push": "{name}_push",
     "direction": "{direction}", "breakaway": "{breakaway}"},
    hints={"breakaway": "static"},
)  # fmt: skip
BODY = Element(
    "body",
    ("force", "mass"),
    ("load",),
    ("position", "angle"),
    (
        Line("_force", "signal", "{force}", "force", "force on the mass"),
        Line("_mass", "slot", "{mass}", "mass", "moving mass"),
        Line("_acceleration", "signal", "{name}_force / {name}_mass", "force/mass", "acceleration"),
    ),
    {"force": "{load}", "mass": "{name}_mass", "velocity": "{state}", "acceleration": "{name}_acceleration",
     "push": "{name}_force"},
    rate="{name}_acceleration",
    hints={"force": "load"},
)  # fmt: skip
PUSHED_BODY = replace(
    BODY,
    lines=(
        Line("_load", "slot", "0.0", "force", "outside force"),
        Line("_force", "signal", "({force}) + {name}_load", "force", "force on the mass"),
        *BODY.lines[1:],
    ),
    offers={**BODY.offers, "force": "{name}_load"},
)
STORE = Element(
    "store",
    ("inflow",),
    ("capacity", "stiffness"),
    (),
    (
        Line("_inflow", "signal", "{inflow}", "inflow", "net flow in"),
        Line("_loss", "slot", "0.0", "inflow", "flow lost"),
        Line("_capacity", "slot", "{capacity}", "capacity", "what flows in for one unit of level"),
        Line("_rate", "signal", "({name}_inflow - {name}_loss) / {name}_capacity", "inflow/capacity", "rate of the level"),
    ),
    {"loss": "{name}_loss", "capacity": "{name}_capacity", "level": "{state}", "inflow": "{name}_inflow"},
    rate="{name}_rate",
)
STIFF_STORE = Element(
    "store",
    STORE.needs,
    STORE.takes,
    STORE.reads,
    (
        *STORE.lines[:2],
        Line("_stiffness", "slot", "{stiffness}", "stiffness", "rise of the level for each unit of what flows in"),
        Line(
            "_rate",
            "signal",
            "{name}_stiffness * ({name}_inflow - {name}_loss)",
            "inflow*stiffness",
            "rate of the level",
        ),
    ),
    {"loss": "{name}_loss", "stiffness": "{name}_stiffness", "level": "{state}", "inflow": "{name}_inflow"},
    rate="{name}_rate",
)
PATH = Element(
    "path",
    ("flow",),
    (),
    ("upstream", "downstream"),
    (Line("_free", "signal", "{flow}", "flow", "flow by the published law"), Line("", "slot", "{name}_free", "flow", "flow")),
    {"flow": "{name}"},
)
LINE = Element(
    "line",
    ("level", "flow"),
    (),
    (),
    (
        Line("_near", "signal", "{level}", "level", "level at its near end"),
        Line("_flow", "signal", "{flow}", "flow", "flow towards its far end"),
        Line("", "slot", "{name}_near", "level", "level at its far end"),
    ),
    {"far": "{name}", "level": "{name}_near", "flow": "{name}_flow"},
)
ACTUATOR = Element(
    "actuator",
    ("command",),
    (),
    ("supply",),
    (
        Line("_demand", "signal", "{command}", "command", "what is commanded"),
        Line("", "slot", "{name}_demand", "command", "what the actuator delivers"),
    ),
    {"command": "{name}", "demand": "{name}_demand"},
)
TRANSMISSION = Element(
    "transmission",
    ("output",),
    (),
    ("torque", "driven"),
    (
        Line("_input", "signal", "{output}", "output", "motion without play or stretch"),
        Line("", "slot", "{name}_input", "output", "motion that is passed on"),
    ),
    {"output": "{name}", "input": "{name}_input"},
)
SENSOR = Element(
    "sensor",
    ("true",),
    (),
    (),
    (
        Line("_true", "signal", "{true}", "true", "true value"),
        Line("", "slot", "{name}_true", "true", "reading"),
    ),
    {"reading": "{name}", "true": "{name}_true"},
)
ELEMENTS = {one.name: one for one in (CONTACT, BODY, STORE, PATH, LINE, ACTUATOR, TRANSMISSION, SENSOR)}
assert all(set(one.offers) | set(one.reads) <= set(KINDS[one.name].names) for one in ELEMENTS.values())


@dataclass(frozen=True)
class Place:
    """An element written out: its lines by name, its port, what it was given, and the signal that is a state's rate."""

    lines: tuple[tuple[str, Line], ...]
    port: Port
    given: Mapping[str, str]
    rate: str


def called(node: ast.AST) -> str:
    """Return the name of the element or mark that ``node`` calls; empty where it is no call of a plain name."""
    return node.func.id if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) else ""


def expand(
    call: ast.Call, target: str, state: str, several: bool, where: str, plain: Collection[str] = (), pushed: bool = True
) -> Place:
    """Return the lines and the port that an element stands for.

    ``target`` is what it is called if it has no ``name``; ``state`` the state whose rate it is assigned to, empty for
    a plain name; with ``several`` contacts each has a regime of its own; the lines in ``plain`` are not for effects. Where no contact
    is ``pushed`` by a force of the equations, a body without a load has one of its own.
    Raises ``UsageError`` for an unknown, missing or repeated argument and for an element assigned to the wrong thing.
    """
    element = ELEMENTS[called(call)]
    if bool(element.rate) != bool(state):
        form = "rate.STATE = " if element.rate else "NAME = "
        more = "; lines below may read it as rate.STATE" if element.rate else ""
        raise UsageError(f"{where}: write {form}{element.name}(...){more}")
    given, options = _given(element, call, where)
    name = options.get("name", target)
    pieces = dict.fromkeys(element.arguments, "") | given
    direction = f"drive.direction_{name}" if several else "drive.direction"
    pieces |= {"name": name, "direction": direction, "state": f"state.{state}" if state else ""}
    if element is CONTACT:
        _complete_contact(pieces, where)
    if state and pieces[element.needs[0]] == f"state.{state}":
        raise UsageError(
            f"{where}: {element.name}(...) takes {', '.join(element.arguments)}; the first is {element.needs[0]}, not the state: "
            f"rate.{state} says whose rate it is"
        )
    element = _variant(element, pieces, where, pushed)
    lines, names = [], {}
    for read in (*element.reads, "head", "twist"):
        if pieces.get(read):
            own = bare_name(pieces[read])
            names[read] = own if own and own not in plain else f"{name}_{read}"
            if names[read] != own:
                lines.append((f"{name}_{read}", Line("", "signal", pieces[read], read, f"{name}: {read}")))
    for line in element.lines:
        text = Line("", line.mark, line.expression.format_map(pieces), line.unit, f"{name}: {line.text}")
        lines.append((name + line.suffix, text))
    for local, template in element.offers.items():
        if text_of := template.format_map(pieces):
            names[local] = bare_name(text_of) or ""
            if not names[local]:
                raise UsageError(
                    f"{where}: '{local}' of {element.name} '{name}' is the expression '{text_of}'; it must be a name"
                )
    port = Port(
        element.name,
        name=name,
        group=options.get("group", ""),
        subsystem=options.get("subsystem", ""),
        like={},
        **names,
    )
    return Place(tuple(lines), port, pieces, element.rate.format_map(pieces))


def _variant(element: Element, pieces: dict[str, str], where: str, pushed: bool) -> Element:
    """Return the element as its arguments want it, such as a store with a stiffness; completes ``pieces``."""
    if element is STORE and pieces["stiffness"]:
        if pieces["capacity"]:
            raise UsageError(f"{where}: give store '{pieces['name']}' a capacity or a stiffness, which is 1 over it, not both")
        element = STIFF_STORE
    elif element is STORE:
        pieces["capacity"] = pieces["capacity"] or "1.0"
    if element is BODY and pieces["load"] in ABSENT:
        element = BODY if pieces["load"] or pushed else PUSHED_BODY
        pieces["load"] = ""
    if element is PATH and pieces["upstream"]:
        both = f"{pieces['upstream']} - ({pieces['downstream']})"
        pieces["head"] = both if pieces["downstream"] else pieces["upstream"]
    if element is TRANSMISSION and pieces["driven"]:
        pieces["twist"] = f"({pieces['output']}) - ({pieces['driven']})"
    return element


def _given(element: Element, call: ast.Call, where: str) -> tuple[dict[str, str], dict[str, str]]:
    place = f"{where}: {element.name}(...)"
    if len(call.args) > len(element.arguments):
        raise UsageError(f"{place} takes at most {len(element.arguments)} arguments: {', '.join(element.arguments)}")
    found = dict(zip(element.arguments, map(ast.unparse, call.args), strict=False))
    options: dict[str, str] = {}
    for keyword in call.keywords:
        key = str(keyword.arg)
        if key not in (*element.arguments, *OPTIONS):
            raise unknown("argument", key, (*element.arguments, *OPTIONS), f"{where}, {element.name}(...)")
        if key in found or key in options:
            raise UsageError(f"{place} gets '{key}' twice")
        if key in OPTIONS:
            value = keyword.value.value if isinstance(keyword.value, ast.Constant) else None
            if not isinstance(value, str) or not value.isidentifier():
                raise UsageError(f"{place}: {key} must be a name in quotes, not {ast.unparse(keyword.value)}")
            options[key] = value
        else:
            found[key] = ast.unparse(keyword.value)
    for need in element.needs:
        if need not in found:
            raise UsageError(f"{place} lacks '{need}'; it takes {', '.join(element.arguments)}")
    return found, options


def _complete_contact(pieces: dict[str, str], where: str) -> None:
    name = pieces["name"]
    if not pieces["velocity"].startswith("state."):
        raise UsageError(f"{where}: the velocity of contact '{name}' must be a state (state.NAME), not {pieces['velocity']}")
    if not pieces["push"]:
        # what it needs to be held is found from the rates; its unit is that of its friction, or of what moves its mass
        if pieces["coulomb"] not in ABSENT:
            pieces["push"] = _first(pieces["coulomb"])
        elif pieces["viscous"] not in ABSENT:
            pieces["push"] = f"({_first(pieces['viscous'])}) * {pieces['velocity']}"
        elif pieces["mass"]:
            pieces["push"] = f"{pieces['mass']} * {pieces['velocity']} / max(drive.time, 1.0)"
        else:
            raise UsageError(
                f"{where}: contact '{name}' has no friction that would tell the unit of a push: "
                "give coulomb or viscous other than 0, the push that it holds against, or its mass"
            )
    # a turn is an event where friction leaps or has a kink: one that is steady and viscous has neither
    nodes = list(ast.walk(ast.parse(pieces["viscous"] or "0.0", mode="eval").body))
    steady = not isinstance(nodes[0], ast.Tuple) and all(one.id == "parameter" for one in nodes if isinstance(one, ast.Name))
    pieces["locks"] = "0.0" if steady and pieces["coulomb"] in ABSENT and pieces["static"] in ABSENT else "1.0"
    if pieces["coulomb"] in ABSENT:
        # no dry friction: a zero in the unit of a push
        pieces["coulomb"] = f"0.0 * ({pieces['push']})"
    pieces["breakaway"] = f"{name}_static" if pieces["static"] else ""
    pieces["static"] = pieces["static"] or pieces["coulomb"]
    pieces["viscous"] = pieces["viscous"] or "0.0"
    for key in ("static", "coulomb", "viscous"):
        node = ast.parse(pieces[key], mode="eval").body
        if isinstance(node, ast.Tuple):
            if len(node.elts) != 2:
                raise UsageError(f"{where}: {key} of contact '{name}': give one value, or two: (positive, negative)")
            positive, negative = map(ast.unparse, node.elts)
            pieces[key] = f"{positive} if {name}_forward > 0.0 else {negative}"


def _first(text: str) -> str:
    """Return the value, or the first of two."""
    node = ast.parse(text, mode="eval").body
    return ast.unparse(node.elts[0]) if isinstance(node, ast.Tuple) and node.elts else text


def bare_name(text: str) -> str | None:
    """Return the name that ``state.x``, ``parameter.x``, ``drive.x`` or ``x`` stands for, None for an expression."""
    for space in ("state.", "parameter.", "drive."):
        text = text.removeprefix(space)
    return text if text.isidentifier() else None
