"""The template of an effect that begins with a curve: what a diagnosis found missing, as a table over its driver."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from hjcamp.effects._begun import Begun, Table
from hjcamp.effects._written import check_begun, check_effect_file
from hjcamp.model.files.template_file import check_user_name, class_name, write_user_file

FREE = 0.1
MOST = 5.0
TEMPLATE = '''"""{about}"""

from __future__ import annotations

from hjcamp.effect import Effect, Parameter{imports}

# Begun from {origin}.
# The tables are what that diagnosis found, in SI units; the methods hold them as shares of the largest value. Put a law in
# their place when you know it, a formula of the same arguments with parameters of its own; it is checked by
# `hjcamp effects test {name} --plant {plant}`.
{tables}


class {title}(Effect):
    r"""{sentence}

    .. math:: {equation}

    h is straight between the values of a table that a diagnosis found. (Say here what it is.)
    Seen as: {seen}
    Source: {origin}.
    """

    plant = "{plant}"
    subsystem = "{subsystem}"
{parameters}
{memory}
{methods}'''
REST = '''    rest_began = State("s", 1e-6, 1.0, text="time at which it came to rest")

    @staticmethod
    def next_rest_began(rest_began, {velocity}, time):
        """Keep the time while it rests, else take this one."""
        return rest_began if abs({velocity}) < 1e-5 else time
'''
METHOD = '''    @staticmethod
    def {slot}({arguments}):
        """{text}, {unit}."""
        at = {steps:.1f} * min(max(({expression} - first) / (last - first), 0.0), 1.0)
        return {factor}{amplitude} * (
{terms}
        )
'''


def even_steps(x: Sequence[float], y: Sequence[float | None], most: int) -> tuple[tuple[float, ...], float, float]:
    """Return values at ``most`` even steps or fewer, and the ends; what was not seen lies straight between what was.

    Knots that are evenly spaced already, ``most`` at most, stay as they are. Raises ValueError where nothing was seen.
    """
    seen = [(place, value) for place, value in zip(x, y, strict=True) if value is not None and np.isfinite(value)]
    if len(seen) < 2:
        raise ValueError("fewer than two values")
    places, values = np.array(seen).T
    gaps = np.diff(x)
    even = len(x) <= most and np.allclose(gaps, gaps[0], rtol=1e-6)
    steps = np.asarray(x, dtype=float) if even else np.linspace(places[0], places[-1], min(most, 11))
    return tuple(float(value) for value in np.interp(steps, places, values)), float(steps[0]), float(steps[-1])


def curve_template(name: str, begun: Begun) -> str:
    """Return the text of the file ``name``.py; raises ``UsageError`` for a text in ``begun`` that may not stand in Python."""
    check_begun(begun)
    tables = [one for one in begun.tables if any(one.values)]
    reach = FREE * (begun.last - begun.first)
    parameters = [_amplitude(one) for one in tables]
    parameters += [
        f'    {end} = Parameter("{begun.unit}", {at:.6g}, ({at - reach:.6g}, {at + reach:.6g}), text="{begun.driver} of the '
        f'{end} value")'
        for end, at in (("first", begun.first), ("last", begun.last))
    ]
    slots = sorted({slot for one in tables for slot in one.slots})
    return TEMPLATE.format(
        about=f"What a diagnosis found missing, over {begun.driver}.",
        imports=", State" if begun.rests else "",
        name=name,
        origin=begun.origin,
        tables="\n".join(_listed(begun, one) for one in tables),
        title=class_name(name),
        sentence=f"{', '.join(one.text for one in tables)}, over {begun.driver}.".capitalize(),
        equation=r",\quad ".join(rf"\Delta_{{\mathrm{{{one.amplitude}}}}} = A\,h(x)" for one in tables),
        seen=f"an error that depends on {begun.driver}, in {', '.join(slots)}.",
        plant=begun.plant,
        subsystem=begun.subsystem,
        parameters="\n".join(parameters),
        memory=REST.format(velocity=begun.rests) if begun.rests else "",
        methods="\n".join(_method(begun, one, slot) for one in tables for slot in one.slots),
    )


def write_from_curve(name: str, folder: Path, begun: Begun, taken: Iterable[str]) -> Path:
    """Write the file ``folder``/``name``.py and return its path; refuse a bad or taken name, and a file that exists."""
    check_user_name("effect", name, "arm_spring")
    text = curve_template(name, begun)
    check_effect_file(text)
    return write_user_file("effect", name, folder, text, taken, "arm_spring")


def _size(one: Table) -> float:
    return float(f"{max(abs(value) for value in one.values):.4g}")


def _amplitude(one: Table) -> str:
    size = _size(one)
    return (
        f'    {one.amplitude} = Parameter("{one.unit}", {size:.4g}, (0.0, {MOST * size:.4g}), text="largest value: {one.text}", '
        "off=0.0)"
    )


def _listed(begun: Begun, one: Table) -> str:
    """Return a table as comments, one line for each value."""
    places = np.linspace(begun.first, begun.last, len(one.values))
    head = f"# {begun.driver} ({begun.unit}), {one.text} ({one.unit}):"
    return "\n".join([head, *(f"#   {at: .5g}  {value: .4g}" for at, value in zip(places, one.values, strict=True))])


def _method(begun: Begun, one: Table, slot: str) -> str:
    size = _size(one)
    hats = ["1.0 - abs(at)", *(f"1.0 - abs(at - {k}.0)" for k in range(1, len(one.values)))]
    terms = [
        f"            {'+ ' if k else ''}{value / size:.4f} * max(0.0, {hat})"
        for k, (value, hat) in enumerate(zip(one.values, hats, strict=True))
    ]
    extra = [one.factor.split(" ")[0]] if one.factor[:1].isalpha() else []
    names = dict.fromkeys([*begun.arguments, *extra, one.amplitude, "first", "last"])
    return METHOD.format(
        slot=slot,
        arguments=", ".join(names),
        text=one.text.capitalize(),
        unit=one.unit,
        steps=len(one.values) - 1,
        expression=begun.expression,
        factor="-" if slot in one.against else one.factor,
        amplitude=one.amplitude,
        terms="\n".join(terms),
    )
