"""The source of every function of a kernel that comes from the equations: rates, contacts, limiters, readings, memory."""

from __future__ import annotations

import re
from collections.abc import Sequence

from hjcamp.model.compile.compose import Composition, term_functions
from hjcamp.model.compile.source_text import copied_function, function_source, names_in
from hjcamp.model.declare.table import interpolated, rooted, table_of


def rates_source(composition: Composition) -> str:
    """Return the source of ``rates(limits, time, direction, z, u, p, f)``: the rates of the states that are present.

    ``limits`` is the code of what every limiter is to do, as `limiting` returns it; negative: what its value says.
    """
    blocks: list[tuple[str, list[str]]] = [("", [])]
    for index, name in enumerate(composition.states):
        gate = composition.gate(name)
        if gate != blocks[-1][0]:
            blocks.append((gate, []))
        blocks[-1][1].append(f"f[{index}] = {composition.rate(name)}")
    lines, gated = blocks[0][1], blocks[1:]
    if gated:
        # One test for all of them: most models have no effect with states.
        inside = [line for gate, own in gated for line in (f"if {gate}:", *(f"    {one}" for one in own))]
        lines = [*lines, f"if {composition.any_gate}:", *(f"    {line}" for line in inside)]
    body = [re.sub(r"\blimited\(", "bounded(limits, ", line) for line in composition.body(lines)]
    return function_source("rates(limits, time, direction, z, u, p, f)", body)


def contact_source(composition: Composition) -> str:
    """Return the source of ``contact(k, time, direction, z, u, p)``: push, limit and locks of contact k; of ``locking``,
    the last alone; and of ``facing`` and ``faced``, which read and set the side that it is on.
    """
    wanted = [f"return {one.push}, {one.limit}, {one.locks}" for one in composition.contacts] or ["return 0.0, 0.0, 0.0"]
    locks = [f"return 1.0 * {one.locks}" for one in composition.contacts] or ["return 0.0"]
    return (
        _of_each(composition, "contact(k, time, direction, z, u, p)", wanted)
        + _of_each(composition, "locking(k, time, direction, z, u, p)", locks)
        + _of_each(composition, "facing(direction, k)", [f"return {side}" for side in composition.sides] or ["return 0.0"])
        + _of_each(
            composition,
            "faced(direction, k, side)",
            [f"return direction + {3**k}.0 * (side - {side})" for k, side in enumerate(composition.sides)]
            if len(composition.contacts) > 1
            else ["return side"],
        )
    )


def _of_each(composition: Composition, signature: str, last: Sequence[str]) -> str:
    """Return the source of a function that returns for contact ``k`` what the k-th line says."""
    lines = []
    for k, one in enumerate(last[:-1]):
        lines += [f"if k == {k}:", *(f"    {line}" for line in composition.body([one]))]
    return function_source(signature, [*lines, *composition.body([last[-1]])])


def limiting_source(composition: Composition) -> str:
    """Return the source of ``limiting(time, direction, z, u, p)``: the code of what the limiters do.

    It is the sum over the limiters of 3^k, twice that where a limiter holds its high end.
    """
    lines = [f"return {' + '.join(_limiters(composition)) or '0'}"]
    if composition.vocabulary.limits:
        # Hardly ever does any of them act; what is no number goes on to the sum, and is 0 there.
        lines = [f"if {' and '.join(map(_within, composition.vocabulary.limits))}:", "    return 0", *lines]
    return function_source("limiting(time, direction, z, u, p)", composition.body(lines))


def _limiters(composition: Composition) -> list[str]:
    return [
        f"(({3**k} if {value} < {low} else 0) + ({2 * 3**k} if {value} > {high} else 0))"
        for k, (value, low, high) in enumerate(composition.vocabulary.limits)
    ]


def _within(limit: tuple[str, str, str]) -> str:
    value, low, high = limit
    return f"abs({value}) <= {high}" if low == f"-{high}" else f"{low} <= {value} <= {high}"


def limits_vary(composition: Composition) -> bool:
    """Whether what a limiter does can change between two samples, while the states stay: it depends on an input."""
    last = [f"return {' + '.join(_limiters(composition))}"] if _limiters(composition) else []
    return any(name.startswith("u_") for name in names_in("\n".join(composition.body(last))))


def readings_source(composition: Composition) -> str:
    """Return the source of ``readings(time, direction, z, u, p, out)``: what the sensors see, in channel order."""
    lines = [f"out[{index}] = {signal}" for index, signal in enumerate(composition.measured)]
    return function_source("readings(time, direction, z, u, p, out)", composition.body(lines))


def limits_kept(composition: Composition) -> bool:
    """Whether no state changes but in steps, so that what the limiters did at the end of one they do at the next one's start."""
    return not composition.cut.driven and not any(composition.update(name) for name in composition.states)


def balance_source(composition: Composition) -> str:
    """Return the source of ``balance(time, direction, z, u, p, out)``: the plant's force balance."""
    lines = [f"out[{index}] = {name}" for index, name in enumerate(composition.plant.balance)]
    return function_source("balance(time, direction, z, u, p, out)", composition.body(lines))


def signals_source(composition: Composition) -> str:
    """Return the source of ``signals(time, direction, z, u, p, out)``: every slot and signal, in order."""
    lines = [f"out[{index}] = {name}" for index, name in enumerate(composition.vocabulary.signals)]
    return function_source("signals(time, direction, z, u, p, out)", composition.body(lines))


def memory_source(composition: Composition) -> str:
    """Return the source of ``begin`` and ``renew`` (starts of all own states, of those known from the observed ones)
    and ``remember`` (their once-per-sample updates)."""
    kinds: dict[str, dict[int, str]] = {"begin": {}, "renew": {}, "remember": {}}
    for index, name in enumerate(composition.states):
        start, update = composition.start(name), composition.update(name)
        if start:
            kinds["begin"][index] = start
        if start and composition.states[name].known:
            kinds["renew"][index] = start
        if update:
            kinds["remember"][index] = update
    parts = []
    for name, found in kinds.items():
        # all are computed before any is stored, since they may use each other
        lines = [_where_open(composition, index, f"next_{index} = {value}") for index, value in found.items()]
        lines += [_where_open(composition, index, f"z[{index}] = next_{index}") for index in found]
        parts.append(function_source(f"{name}(time, direction, z, u, p)", composition.body(lines)))
    return "".join(parts)


def _where_open(composition: Composition, index: int, line: str) -> str:
    gate = composition.gate(list(composition.states)[index])
    return f"if {gate}: {line}" if gate else line


def terms_source(composition: Composition) -> str:
    """Return the source of every effect's functions, copied so that the kernel's hash sees their text."""
    functions = term_functions(composition.effects)
    if any(table_of(term.function) for effect in composition.effects for term in effect.terms.values()):
        functions |= {one.__name__: one for one in (interpolated, rooted)}
    return "\n".join(copied_function(name, function) for name, function in functions.items())
