"""The proposed tests as the content of a campaign."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from hjcamp.plants.pump_joint.diagnosis.design.menu import Choice


def allowed_by(choices: Sequence[Choice], fixed: Mapping[str, Any]) -> list[Choice]:
    """Return the tests of the menu that do not contradict what the user has fixed."""
    return [one for one in choices if all(one.settings.get(key, value) == value for key, value in fixed.items())]


def campaign_content(
    name: str, description: str, fixed: Mapping[str, Any], choices: Sequence[Choice], repetitions: int
) -> dict[str, Any]:
    """Return the content of the campaign's file; a key that any test sets itself is given to every test."""
    own = {key for one in choices for key in one.settings}
    shared = {key: value for key, value in fixed.items() if key not in own}
    given = {key: value for key, value in fixed.items() if key in own}
    cases = {one.name: {**given, **one.settings} for one in choices}
    return {
        "name": name,
        "description": description,
        "fixed": shared,
        "vary": {"test": cases},
        "repetitions": repetitions,
        "tables": [],
    }
