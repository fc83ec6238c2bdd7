"""Bind generic effects to the places of a plant: one ordinary effect for each place that offers all names it uses."""

from __future__ import annotations

import copyreg
import re
from collections.abc import Mapping, Sequence
from typing import Any, cast

from hjcamp.errors import UsageError, unknown
from hjcamp.model.declare.effect import Effect, Term
from hjcamp.model.declare.element import ELEMENTS
from hjcamp.model.declare.instance import Instance
from hjcamp.model.declare.plant import Plant
from hjcamp.model.declare.port import KINDS, Port
from hjcamp.model.files.cached import cached
from hjcamp.model.language.amount import dimension
from hjcamp.model.language.effect_names import check_effect
from hjcamp.model.language.effect_units import check_units
from hjcamp.model.language.quantities import Quantities, in_lines, is_nothing, units_of
from hjcamp.model.language.vocabulary import read_vocabulary

EVERYWHERE = ("time",)


class Unfit(UsageError):  # noqa: N818 - it says what an effect is, not that somebody made a mistake
    """A generic effect has no place in a plant, or none that offers what it uses; nothing is wrong with its file."""


class Bound(type):
    """The type of an effect that was made for places of a plant: ``made_of`` says of what, for other processes."""

    made_of: tuple[Any, ...]


@cached
def bind(effect: type[Effect], plant: type[Plant]) -> tuple[type[Effect], ...]:
    """Return the effect bound to each place of its kind, to each group of places where it is declared ``together``.

    Raises ``Unfit`` where the plant has no such place, none that offers the names which the effect uses, or none of
    fitting units, and ``UsageError`` where the file itself is wrong.
    """
    where = f"effect {effect.name or effect.__name__}"
    wanted = wanted_names(effect)
    ports = [port for port in read_vocabulary(plant).ports.values() if port.kind == effect.acts_on]
    if not ports:
        raise Unfit(f"{where}: needs {KINDS[effect.acts_on].one} ({KINDS[effect.acts_on].text}); plant {plant.name} has none")
    able = [port for port in ports if not port.lacks(wanted)]
    if not able:
        least = min(ports, key=lambda port: len(port.lacks(wanted)))
        raise Unfit(f"{where}: {_lacking(least, least.lacks(wanted))}")
    if effect.brings:
        able = [port for port in able if is_nothing(plant, port.names[effect.brings])]
        if not able:
            raise Unfit(f"{where}: plant {plant.name} has {effect.brings} of its own in each such place")
    if effect.works_on:
        able = [port for port in able if not is_nothing(plant, port.names[effect.works_on])]
        if not able:
            raise Unfit(f"{where}: plant {plant.name} has no {effect.works_on} in any such place")
    if effect.without_base:
        able = [port for port in able if not _base_in(plant, port.names[effect.without_base])]
        if not able:
            raise Unfit(f"{where}: a base parameter of plant {plant.name} is the {effect.without_base} in each such place")
    problems: list[UsageError] = []
    groups: dict[str, list[Port]] = {}
    for port in able:
        try:
            _check_place(effect, plant, port)
        except UsageError as problem:
            problems.append(problem)
            continue
        groups.setdefault(port.group if effect.together and port.group else port.name, []).append(port)
    if not groups:
        raise Unfit(f"{problems[0]}, at {able[0].kind} '{able[0].name}' of plant {plant.name}")
    found = []
    for place, chosen in groups.items():
        name = effect.name if len(groups) == 1 else f"{effect.name}_at_{place}"
        found.append(_bound(effect, plant, chosen, name, None))
    return tuple(found)


@cached
def bind_instance(instance: type[Instance], effect: type[Effect], plant: type[Plant]) -> type[Effect]:
    """Return a generic effect at the places, and by the names, of the plant's ``instance`` of it."""
    where = f"effect {instance.name}, plant {plant.name}"
    if not effect.acts_on:
        raise UsageError(f"{where}: '{effect.name}' is no generic effect, it has no acts_on")
    wanted = wanted_names(effect)
    known = read_vocabulary(plant).ports
    ports = []
    for place, names in instance.at.items():
        if place not in known:
            raise unknown("place", place, known, where)
        if known[place].kind != effect.acts_on:
            raise UsageError(
                f"{where}: '{effect.name}' acts on {KINDS[effect.acts_on].one}, but '{place}' is {KINDS[known[place].kind].one}"
            )
        ports.append(known[place].but(names))
        if lacks := ports[-1].lacks(wanted):
            raise UsageError(f"{where}: {_lacking(ports[-1], lacks)}")
    return _bound(effect, plant, ports, instance.name, instance)


def wanted_names(effect: type[Effect]) -> set[str]:
    """Return the names that a generic effect needs of its place; refuse one that its kind does not have."""
    where = f"effect {effect.name or effect.__name__}"
    kind = KINDS[effect.acts_on]
    own = {*effect.parameters, *effect.states}
    terms = (*effect.terms.values(), *effect.rates.values(), *effect.updates.values(), *effect.starts.values())
    used = {name for term in terms for name in term.arguments} - own - {*EVERYWHERE}
    for name in effect.terms:
        if name not in kind.slots:
            raise unknown("slot", name, kind.slots, f"{where}, on {kind.one}")
    for name in sorted(own & {*kind.names, *EVERYWHERE}):
        raise UsageError(f"{where}: '{name}' is a name of every {kind.name}; give the parameter or state another one")
    for name in sorted(used):
        if name not in kind.names:
            raise unknown("name", name, {*kind.names, *own, *EVERYWHERE}, f"{where}, on {kind.one}")
    items: list[Any] = [*effect.parameters.values(), *effect.states.values()]
    for item in items:
        used |= set(re.findall(r"\b[A-Za-z_]\w*", item.unit)) & set(kind.names)
    return (used | set(effect.terms)) - set(effect.instead)


def _lacking(port: Port, lacks: set[str]) -> str:
    """Return what a place does not offer, and how its element is told."""
    names = sorted(lacks)
    said = f"needs {', '.join(names)}, which {port.kind} '{port.name}' does not offer"
    if port.kind not in ELEMENTS:
        return said
    element = ELEMENTS[port.kind]
    given = {element.hints.get(name, name) for name in names}
    if given <= set(element.arguments):
        return f"{said}: write {port.kind}(..., {', '.join(f'{name}=...' for name in sorted(given))})"
    return said


def _base_in(plant: type[Plant], slot: str) -> set[str]:
    """Return the base parameters that stand in the line of a slot."""
    line = next((one.expression for one in read_vocabulary(plant).statements if one.target == slot), f"p_{slot}")
    return {name for name in plant.base_parameters if re.search(rf"\bp_{name}\b", line)}


def _check_place(effect: type[Effect], plant: type[Plant], port: Port) -> None:
    """Refuse a place with a unit that does not fit, or a name that is computed too late."""
    units = units_of(plant)
    for local, allowed in effect.only_in.items():
        dims = units.value(in_lines(units, port.names[local]), port.name).dims
        if dims not in [dimension(unit) for unit in allowed]:
            raise UsageError(f"effect {effect.name}: needs its {local} in {' or '.join(allowed)}, not {units.written(dims)}")
    trial = _bound(effect, plant, [port], effect.name, None)
    check_effect(trial, plant)
    check_units(trial, plant)


def _bound(
    effect: type[Effect], plant: type[Plant], ports: Sequence[Port], name: str, instance: type[Instance] | None
) -> type[Effect]:
    """Return an ordinary effect that acts on these places, by the names of the instance where there is one."""
    groups: dict[str, dict[str, Term]] = {"terms": {}, "rates": {}, "updates": {}, "starts": {}}
    body: dict[str, Any] = {
        "__doc__": (instance and instance.__doc__) or effect.__doc__,
        "__module__": effect.__module__,
        "subsystem": ports[0].subsystem or ports[0].kind,
        "same_as": instance.same_as if instance else effect.same_as,
        "claimed": effect.claimed,
        "exact_in": instance.exact_in if instance else effect.exact_in,
        **groups,
    }
    given, without = (instance.declared, instance.without) if instance else ({}, ())
    for slot in without:
        if slot not in effect.terms:
            raise unknown("slot", slot, effect.terms, f"effect {name}, without")
    terms = {slot: term for slot, term in effect.terms.items() if slot not in without}
    unread = {one for slot in without for one in effect.terms[slot].arguments} - _read_by(effect, terms)
    for port in ports:
        several = (*effect.states, *effect.each) if len(ports) > 1 else ()
        called = {own: f"{own}_{port.name}" if own in several else own for own in (*effect.parameters, *effect.states)}
        if instance:
            called |= {own: new for own, new in instance.at[port.name].items() if own in called}
        if effect.granted:
            body["granted"] = called[effect.granted]
        if effect.behind:
            body["behind"] = port.names[effect.behind]
        quantities = Quantities(plant, port)
        for parameter in (one for one in effect.parameters.values() if one.name not in unread):
            own = called[parameter.name]
            body.setdefault(own, given.get(own) or quantities.parameter(parameter))
        left_out = {state for name, state in effect.instead.items() if name in port.names}
        for state in (one for one in effect.states.values() if one.name not in left_out):
            own = called[state.name]
            body.setdefault(own, given.get(own) or quantities.state(state))
        names = {**{name: called[state] for name, state in effect.instead.items()}, **port.names, **called}
        taken = {port.names[local] for local in _read_by(effect, terms) & set(port.names)} & set(called.values())
        if taken:
            raise Unfit(
                f"effect {name}: its own '{sorted(taken)[0]}' is also a name of plant {plant.name}; call that otherwise"
            )
        groups["terms"] |= {port.names[slot]: term.on(names) for slot, term in terms.items()}
        for kind in ("rates", "updates", "starts"):
            own_terms = getattr(effect, kind).items()
            groups[kind] |= {called[state]: term.on(names) for state, term in own_terms if state not in left_out}
    if unused := set(given) - set(body):
        raise unknown("parameter or state", sorted(unused)[0], [*effect.parameters, *effect.states], f"effect {name}")
    bound = Bound(effect.__name__, (Effect,), body)
    bound.made_of = (effect, effect.name, plant, name, instance)
    made = cast("type[Effect]", bound)
    made.name = name
    return made


def _read_by(effect: type[Effect], terms: Mapping[str, Term]) -> set[str]:
    groups = (terms, effect.rates, effect.updates, effect.starts)
    return {name for group in groups for term in group.values() for name in term.arguments}


def _made_again(
    effect: type[Effect], file: str, plant: type[Plant], name: str, instance: type[Instance] | None
) -> type[Effect]:
    """Return the effect of that name in another process."""
    effect.name = effect.name or file
    if instance is not None:
        return bind_instance(instance, effect, plant)
    return next(one for one in bind(effect, plant) if one.name == name)


def _reduced(made: Any) -> tuple[Any, tuple[Any, ...]]:
    return _made_again, made.made_of


copyreg.pickle(Bound, _reduced)
