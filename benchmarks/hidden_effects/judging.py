"""What one result of the hidden-effect benchmark is worth: detectable or not, right or not, and how it went wrong."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from benchmarks.hidden_effects.cases import EFFECT, NOTHING, ONE_OF, OUTSIDE, similar
from benchmarks.hidden_effects.detectable import DETECTABLE

Line = Mapping[str, Any]
# How a case of the library ends, in the order of the tables.
OUTCOMES = ("right", "one of", "half", "nothing", "outside", "cannot tell", "wrong", "failed")


def verdict_of(line: Line) -> str:
    """Return the verdict, or "failed" where the diagnosis broke off."""
    return str(line["answer"]["verdict"]) if "answer" in line else "failed"


def named(line: Line) -> list[str]:
    """Return the effects that the answer names, with certainty or as one of several."""
    return list(line["answer"]["effects"]) if "answer" in line else []


def visible(line: Line) -> float:
    """Return how visible the hidden effect is; of two effects, the less visible one."""
    return min((float(value) for value, _ in line["visibility"].values()), default=0.0)


def detectable(line: Line) -> bool:
    """Whether everything that is hidden can be seen in these tests."""
    return visible(line) >= DETECTABLE


def is_true(name: str, line: Line, groups: bool) -> bool:
    """Whether a name is that of a hidden effect, or of one that is the same thing where ``groups``."""
    if line["kind"] in ("outside", "taken_out"):
        return False
    return any(name == effect or (groups and name in similar(effect)) for effect in line["effects"])


def matched(line: Line, groups: bool) -> bool:
    """Whether the names given are those hidden, each once."""
    names, left = named(line), list(line["effects"])
    for name in names:
        found = next((one for one in left if name == one or (groups and name in similar(one))), None)
        if found is None:
            return False
        left.remove(found)
    return not left


def first_is_true(line: Line, groups: bool) -> bool:
    """Whether the first candidate is a hidden effect."""
    candidates = line["answer"]["candidates"] if "answer" in line else []
    return bool(candidates) and is_true(candidates[0]["effect"], line, groups)


def right(line: Line, groups: bool = True) -> bool:
    """Whether the verdict is exactly right.

    Strictly: the effects hidden and no others, nothing on a null, outside where it is. With ``groups`` also: the other
    name of the same thing, one of a group of the same thing, and nothing where the hidden effect is not detectable.
    """
    verdict, kind = verdict_of(line), line["kind"]
    if kind == "null":
        return verdict == NOTHING
    if groups and verdict == NOTHING and not detectable(line):
        return True
    if kind in ("outside", "taken_out"):
        return verdict == OUTSIDE
    if verdict == EFFECT:
        return matched(line, groups)
    names = named(line)
    return (
        groups
        and verdict == ONE_OF
        and len(line["effects"]) == 1
        and line["effects"][0] in names
        and set(names) <= similar(line["effects"][0])
    )


def outcome(line: Line) -> str:
    """Return how a case with effects of the library ended: one of ``OUTCOMES``."""
    verdict = verdict_of(line)
    plain = {"failed": "failed", NOTHING: "nothing", OUTSIDE: "outside", "cannot_tell": "cannot tell"}
    if verdict in plain:
        return plain[verdict]
    names = named(line)
    if verdict == ONE_OF:
        return "one of" if any(is_true(name, line, True) for name in names) else "wrong"
    if matched(line, True):
        return "right"
    return "half" if len(line["effects"]) > 1 and all(is_true(name, line, True) for name in names) else "wrong"


def said(line: Line) -> str:
    """Return the verdict in a few words, with the names or drivers it gives."""
    verdict = verdict_of(line)
    if verdict == EFFECT:
        return " + ".join(named(line))
    if verdict == ONE_OF:
        return "one of " + " / ".join(named(line))
    if verdict == OUTSIDE:
        return "outside: " + (", ".join(line["answer"]["drivers"][:2]) or "no driver")
    return verdict.replace("_", " ")
