"""The template of an effect that is a formula: what a diagnosis proposed for the curve that it found, in the place of its knots."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from hjcamp.effects._begun import Begun
from hjcamp.effects._curve_template import REST
from hjcamp.effects._forms import CALLED, Form
from hjcamp.effects._written import check_begun, check_effect_file
from hjcamp.model.files.template_file import check_user_name, class_name, write_user_file

MOST = 5.0
TEMPLATE = '''"""{words}, over {driver}: what a diagnosis found missing."""

from __future__ import annotations
{mathematics}
from hjcamp.effect import Effect, Parameter{imports}


class {title}(Effect):
    r"""{sentence}

    .. math:: {equation}

    for x, {driver}. Values are those that the diagnosis found{left}.
    Checked by `hjcamp effects test {name} --plant {plant}`. (Say here what it is.)
    Seen as: an error that depends on {driver}, in {slots}.
    Source: {origin}.
    """

    plant = "{plant}"
    subsystem = "{subsystem}"
{parameters}
{memory}
{methods}'''
METHOD = '''    @staticmethod
    def {slot}({arguments}):
        """{text}, {unit}."""
        return {formula}
'''


@dataclass(frozen=True)
class Formula:
    """A form with the value, the unit and the 95 % interval of each parameter, SI; ``reference`` is the place where a power is 1."""

    form: Form
    values: Mapping[str, tuple[float, str, tuple[float, float]]]
    reference: float = 1.0
    taken: float | None = None


def formula_template(name: str, begun: Begun, formula: Formula) -> str:
    """Return the text of the file ``name``.py; raises ``UsageError`` for a text in ``begun`` that may not stand in Python."""
    check_begun(begun)
    [table] = begun.tables
    form, written = formula.form, formula.form.written(begun.expression)
    called = [one for one in CALLED if f"{one}(" in written]
    parameters = [_parameter(form, one, *row) for one, row in formula.values.items()]
    if form.reference:
        at = formula.reference
        parameters.append(
            f'    reference = Parameter("{begun.unit}", {at:.6g}, ({0.999 * at:.6g}, {1.001 * at:.6g}), text="{begun.driver} '
            'at which the power is 1; kept")'
        )
    own = [*formula.values, *(["reference"] if form.reference else [])]
    factors = {slot: "-" if slot in table.against else table.factor for slot in table.slots}
    methods = [
        METHOD.format(
            slot=slot,
            arguments=", ".join(dict.fromkeys([*begun.arguments, *_factors(table.factor), *own])),
            text=table.text.capitalize(),
            unit=table.unit,
            formula=f"{factor}({written})" if factor else written,
        )
        for slot, factor in factors.items()
    ]
    share = (
        "" if formula.taken is None else f", with which it took {100.0 * formula.taken:.0f} % of the error above repeatability"
    )
    return TEMPLATE.format(
        words=form.words.capitalize(),
        driver=begun.driver,
        mathematics=f"\nfrom math import {', '.join(called)}\n" if called else "",
        imports=", State" if begun.rests else "",
        title=class_name(name),
        sentence=f"{table.text.capitalize()}: {form.words} over {begun.driver}.",
        equation=rf"\Delta = {form.latex}",
        left=share,
        name=name,
        plant=begun.plant,
        slots=", ".join(table.slots),
        origin=begun.origin,
        subsystem=begun.subsystem,
        parameters="\n".join(parameters),
        memory=REST.format(velocity=begun.rests) if begun.rests else "",
        methods="\n".join(methods),
    )


def write_from_formula(name: str, folder: Path, begun: Begun, formula: Formula, taken: Iterable[str]) -> Path:
    """Write the file ``folder``/``name``.py and return its path; refuse a bad or taken name, and a file that exists."""
    check_user_name("effect", name, "arm_spring")
    text = formula_template(name, begun, formula)
    check_effect_file(text)
    return write_user_file("effect", name, folder, text, taken, "arm_spring")


def _parameter(form: Form, name: str, value: float, unit: str, interval: tuple[float, float]) -> str:
    """Return the line of a parameter: its value, what it may be, and its interval in words."""
    wide = max(abs(value), abs(interval[0]), abs(interval[1])) * MOST or 1.0
    kind = form.shapes[name].kind if name in form.shapes else "amount"
    low, high = (-wide, wide)
    if kind in ("width", "threshold", "scale", "rate", "exponent"):
        low, high = value / MOST, value * MOST
    elif kind == "length":  # what divides is not 0
        low, high = sorted((value / MOST, value * MOST))
    elif kind in ("place", "pole"):  # it stays about where it is; what is at a pole is beyond what was visited
        reach = (0.9 if kind == "pole" else MOST) * abs(value - interval[0]) or abs(value) or 1.0
        low, high = value - reach, value + reach
    elif kind == "phase":
        low, high = -2.0 * math.pi, 2.0 * math.pi
    off = ", off=0.0" if kind == "amount" else ""
    bent = ", shape=True" if kind != "amount" else ""
    said = f"{kind} of the formula, 95 %: {interval[0]:.4g} to {interval[1]:.4g}"
    return f'    {name} = Parameter("{unit}", {value:.6g}, ({low:.6g}, {high:.6g}), text="{said}"{bent}{off})'


def _factors(factor: str) -> list[str]:
    """Return the names in a factor: ``flow + flow * `` hands on what arrives."""
    return [word for word in factor.replace("*", " ").replace("+", " ").split() if word.isidentifier()]
