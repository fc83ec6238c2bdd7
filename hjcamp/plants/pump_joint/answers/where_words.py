"""Where the error comes from, in words: one sentence for each place, and bars that do not pretend to add up."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from hjcamp.report.wording.repeatability import NEAR, NO_NOISE_FLOOR

TELLING = 0.05
UNEVEN = 1.5
HOW = {
    "joint": "its force balance fails even with pressures and motion as measured",
    "lines": "their pressures are wrong even with pump and arm as measured",
    "pump": "it does not follow its command as its model says",
}
DIRECTIONS = {
    "positive": "moving in the positive direction",
    "negative": "moving in the negative direction",
    "at rest": "at rest",
}
VARIABLES = {
    "arm_velocity": "at {}",
    "arm_angle": "arm at {}",
    "pressure_sum": "sum of the pressures {}",
    "pump_velocity": "pump at {}",
    "time": "{} into the test",
    "time_at_rest": "breaking away after {} of rest",
}


class Place(Protocol):
    """A share of the error above repeatability and the conditions that show it."""

    @property
    def subsystem(self) -> str: ...
    @property
    def variable(self) -> str: ...
    @property
    def bin(self) -> str: ...
    @property
    def share(self) -> float: ...
    @property
    def shown(self) -> int: ...
    @property
    def conditions(self) -> int: ...
    @property
    def total(self) -> int: ...


def phrase(variable: str, label: str) -> str:
    """Return a bin in words: ``positive, 0 to 2 mm/s`` of arm_velocity is "moving ..., below 2 mm/s"."""
    if variable == "all":
        return ""
    if variable == "repetition":
        return f"repetition {label}"
    direction, _, span = label.partition(", ")
    said = DIRECTIONS.get(direction, direction)
    if not span:
        return said
    low, _, high = span.partition(" to ")
    if variable == "arm_velocity" and low == "0":
        return f"{said}, below {high}"
    return f"{said}, {VARIABLES.get(variable, '{}').format(span)}"


def where_sentences(places: Sequence[Place], over: float | None = None) -> list[str]:
    """Return the places as sentences: each subsystem, then where it is strongest.

    ``over`` is the error of the model over the floor, None without repetitions: where little is left, that is said first.
    """
    if not places and over is not None:
        return [f"The error is {over:.1f} x the noise floor: nothing stands out from what the repetitions differ by."]
    if not places:
        return [f"{NO_NOISE_FLOOR} Where the error is cannot be distinguished from chance."]
    whole = [place for place in places if place.variable == "all"]
    if over is not None and over <= NEAR:
        shares = ", ".join(f"{100 * place.share:.0f} % {place.subsystem}" for place in whole)
        return [f"The error is {over:.1f} x the noise floor: nothing stands out (of that little, {shares})."]
    said = []
    for number, place in enumerate(whole):
        if number == 0 or place.share > TELLING:
            said.append(f"{_share(place)}: {place.subsystem} ({HOW[place.subsystem]}).")
    for number, place in enumerate(strongest_cuts(places)[:2]):
        text = f"{_share(place)}: {place.subsystem}, {phrase(place.variable, place.bin)}"
        again = " (same error, grouped differently)" if number else ""
        said.append(f"{text}, in {_seen_in(place)}{again}.")
    return said


def _seen_in(place: Place) -> str:
    """Return in how many conditions a place is seen, of those that have such moments, and of all where these are not all."""
    whole = "" if place.conditions == place.total else f" with such moments ({place.total} in all)"
    return f"{place.shown} of {place.conditions} conditions{whole}"


def strongest_cuts(places: Sequence[Place]) -> list[Place]:
    """Return the largest bin of every variable and subsystem, largest first; repetitions only where they differ."""
    found: dict[tuple[str, str], list[Place]] = {}
    for place in places:
        if place.variable != "all":
            found.setdefault((place.subsystem, place.variable), []).append(place)
    return [
        bins[0] for (_, variable), bins in found.items() if variable != "repetition" or uneven([place.share for place in bins])
    ]


def uneven(shares: Sequence[float]) -> bool:
    """Return whether the largest share is well above what every bin would have of an even spread."""
    return len(shares) == 1 or max(shares) > UNEVEN * sum(shares) / len(shares)


def grouped_bars(rows: Sequence[Mapping[str, Any]], groups: int = 4, most: int = 3) -> list[tuple[str, str, float]]:
    """Return bars (group, label, share): the subsystems, then the variables with the largest bins, ``most`` bins each.

    Every group divides the same error anew, so groups do not add up.
    """
    bars = [("", str(row["subsystem"]), float(row["share"])) for row in rows if row["variable"] == "all"]
    divided: dict[str, list[tuple[str, str, float]]] = {}
    for row in rows:
        if row["variable"] != "all":
            group = f"{row['subsystem']}, by {str(row['variable']).replace('_', ' ')}"
            divided.setdefault(group, []).append((group, str(row["bin"]), float(row["share"])))
    telling = [cut for group, cut in divided.items() if not group.endswith("repetition") or uneven([bar[2] for bar in cut])]
    for cut in telling[:groups]:
        bars += cut[:most]
    return bars


def _share(place: Place) -> str:
    return f"{100 * place.share:.0f} % of the error above repeatability"
