"""One field of a plant's logs, and the two that every plant has."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

from hjcamp.errors import UsageError, shown, unknown
from hjcamp.model.declare.parameter import finite_number


@dataclass(frozen=True)
class Field:
    """One field of a sample: name, unit as written in the log, whether every log must have it, meaning.

    ``also`` are units of another quantity in which it may be imported, each with its size in the field's unit.
    """

    name: str
    unit: str
    required: bool
    text: str
    also: tuple[tuple[str, float], ...] = ()


TIME = Field("time_s", "s", True, "0 at the first sample of the command phase; negative before")
PHASE = Field("phase", "1", False, "0 preload, 1 pressure adjustment, 2 rest, 3 command and control, 4 release")


@dataclass(frozen=True)
class Phase:
    """A phase of every test before or after its motion: in ``seconds`` commanded inputs go straight ``to`` values (SI), others stay.

    A plant lists them in ``phases_before`` (two at most: the log has numbers 0 and 1 for them) and ``phases_after`` (one: number 4).
    """

    name: str
    seconds: float
    to: Mapping[str, float] = field(default_factory=dict)


def check_phases(before: Sequence[Phase], after: Sequence[Phase], inputs: Collection[str], period: float, where: str) -> None:
    """Raise ``UsageError`` for phases that no test can have; ``inputs`` are those of the plant, ``period`` is in s."""
    for listed, name, most in ((before, "phases_before", 2), (after, "phases_after", 1)):
        if not isinstance(listed, tuple) or not all(isinstance(one, Phase) for one in listed) or len(listed) > most:
            form = f"a tuple (Phase(NAME, SECONDS, {{INPUT: VALUE}}),) of {most} at most"
            raise UsageError(f"{where}: {name} is {shown(listed)}; {form} is needed")
    names = [one.name for one in (*before, *after)]
    for one in (*before, *after):
        if (
            not isinstance(one.name, str)
            or not one.name.isidentifier()
            or names.count(one.name) > 1
            or one.name in ("rest", "command")
        ):
            raise UsageError(f"{where}: a phase is called {shown(one.name)}; a name of its own is needed, such as preload")
        if (finite_number(one.seconds) or 0.0) < period:
            least = f"at least a sample, {period:g} s, is needed"
            raise UsageError(f"{where}, phase '{one.name}': it takes {shown(one.seconds)} s; {least}")
        for name, value in one.to.items():
            if name not in inputs:
                raise unknown("input", str(name), inputs, f"{where}, phase '{one.name}'")
            if finite_number(value) is None:
                raise UsageError(f"{where}, phase '{one.name}': {name} is {shown(value)}; a number is needed")
