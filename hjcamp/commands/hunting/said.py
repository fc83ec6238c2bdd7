"""How a hunt stands, in words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

VERDICTS = {
    "effect": "effect: {names}",
    "one_of": "one of: {names}",
    "nothing_missing": "nothing is missing",
    "outside_library": "something outside the library",
    "cannot_tell": "these tests cannot tell",
}
REASONS = {
    "verdict": "One verdict stands.",
    "no_test": "No test within the limits could tell more.",
    "budget": "The budget is spent.",
}
STATES = {"running": "The hunt is at work.", "interrupted": "The hunt was interrupted.", "stopped": "The hunt was stopped."}


def said_verdict(found: Mapping[str, Any]) -> str:
    """Return the verdict of a diagnosis with its names."""
    if not found:
        return "no diagnosis yet"
    joined = " + " if found["verdict"] == "effect" else ", "
    return VERDICTS.get(found["verdict"], str(found["verdict"])).format(names=joined.join(found["effects"]))


def not_ruled_out(found: Mapping[str, Any]) -> str:
    """Return the models that the tests do not rule out, and the effects that they would not show."""
    sets = [" + ".join(one) or "nothing" for one in found.get("not_ruled_out", ())]
    hidden = list(found.get("hidden", ()))
    parts = [", ".join(sets)] if sets else []
    parts += [f"not visible at their usual size: {', '.join(hidden)}"] if hidden else []
    return "; ".join(parts) or "-"
