"""Channels and optional inputs that some logs of a set have and others lack: which logs an analysis takes, and with which channels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from hjcamp.errors import counted
from hjcamp.records.log import TestLog
from hjcamp.records.of_plant import plant_of
from hjcamp.records.sets.glance import Glance, glance_at, optional_inputs


@dataclass(frozen=True)
class Incomplete:
    """A log that lacks a ``field`` which others of its set have, and whether an analysis leaves it out for that."""

    log: TestLog
    field: str
    text: str
    left_out: bool


def complete_logs(logs: Sequence[TestLog]) -> tuple[list[TestLog], list[Incomplete]]:
    """Return the logs that an analysis takes together, and what `incomplete` says of the others."""
    found = incomplete([glance_at(log) for log in logs])
    left_out = {id(one.log) for one in found if one.left_out}
    return [log for log in logs if id(log) not in left_out], found


def incomplete(logs: Sequence[Glance]) -> list[Incomplete]:
    """Return the logs of one plant that lack what others have.

    A log that lacks an optional input is left out where half of the logs or more have it and it is not at its default in them: the
    default need not be what acted. Where fewer have it, the default counts, as the plant declares it. Of the channels, those
    of most samples first, as many count as keep most readings, and a log that lacks one of these is left out.
    """
    plant = plant_of(logs[0].log.metadata, str(logs[0].log.path))
    inputs = optional_inputs(plant)
    found: dict[tuple[int, str], Incomplete] = {}
    kept, before = list(logs), -1
    while len(kept) != before:  # what is left out changes what most of the others have
        before = len(kept)
        for field in inputs:
            if any(field in log.moved for log in kept) and 2 * sum(field in log.fields for log in kept) >= len(kept):
                kept = _divided(field, kept, found, "an analysis leaves {} out: its default need not be what acted here")
        if not plant.channels:
            kept = _with_most_readings(list(plant.measured), kept, found)
    for channel in plant.channels:
        _divided(channel.field, kept, found, "it is computed from the command there", left_out=False)
    for field, given in inputs.items():
        _divided(field, kept, found, f"it is taken as its default there, {given.default:g} SI", left_out=False)
    return list(found.values())


def _with_most_readings(names: Sequence[str], logs: list[Glance], found: dict[tuple[int, str], Incomplete]) -> list[Glance]:
    """Return the logs with which most readings are kept, each of all channels that count: of equals those of more channels."""
    samples = {name: sum(log.samples for log in logs if name in log.fields) for name in names}
    ranked = sorted((name for name in names if samples[name]), key=lambda name: -samples[name])
    choices = [[log for log in logs if log.fields.issuperset(ranked[:k])] for k in range(1, len(ranked) + 1)]
    if not choices:
        return logs
    most = max(range(len(choices)), key=lambda k: ((k + 1) * sum(log.samples for log in choices[k]), k))
    for name in ranked[: most + 1]:
        _divided(name, logs, found, "an analysis leaves {} out")
    for name in ranked[most + 1 :]:
        all_of = "an analysis leaves this channel out of all, which keeps most readings"
        _divided(name, choices[most], found, all_of, left_out=False)
    return choices[most]


def _divided(
    field: str, logs: list[Glance], found: dict[tuple[int, str], Incomplete], then: str, *, left_out: bool = True
) -> list[Glance]:
    """Return the logs that have a field, where any has it, and put those that lack it into what was ``found``."""
    having, lacking = ([log for log in logs if (field in log.fields) is has] for has in (True, False))
    if not having or not lacking:
        return logs
    more = f", and so in {counted(len(lacking) - 1, 'more log')}" if len(lacking) > 1 else ""
    there = f"{counted(len(having), 'log')} of the set {'has' if len(having) == 1 else 'have'} it"
    text = f"'{field}' is missing here{more}, while {there}; {then.format('it' if len(lacking) == 1 else 'them')}"
    for one in lacking:
        found.setdefault((id(one.log), field), Incomplete(one.log, field, text, left_out))
    return having
