"""The errors a user may meet: each says what is wrong, where, what is allowed, and the nearest match."""

from __future__ import annotations

import difflib
import math
import re
import unicodedata
from collections.abc import Iterable

LONGEST_SHOWN = 80
LONGEST_LIST = 1000  # characters of names of which all are said
FEW_NAMED = 12
NUMBER = re.compile(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?")


class HjcampError(Exception):
    """The work failed (exit code 1)."""

    exit_code = 1


class UsageError(HjcampError):
    """The call or the data are unusable (exit code 2)."""

    exit_code = 2


class RigStopped(HjcampError):  # noqa: N818 - it is a state of the rig, not a mistake of the caller
    """The rig was made safe and the run stopped (exit code 3)."""

    exit_code = 3


class Interrupted(HjcampError):  # noqa: N818 - the user asked for it
    """The user stopped the work at a safe point (exit code 130)."""

    exit_code = 130


def nearest(name: str, allowed: Iterable[str]) -> str | None:
    """Return the allowed name most like ``name``, or None when nothing is near."""
    matches = difflib.get_close_matches(str(name), sorted(map(str, allowed)), n=1, cutoff=0.5)
    return matches[0] if matches else None


def unknown(kind: str, name: str, allowed: Iterable[str], where: str = "") -> UsageError:
    """Return the error for a name that is not among the allowed ones.

    ``kind`` is what the name stands for ("effect"), ``where`` the place it was read from.
    """
    names = sorted(map(str, allowed))
    number = len(names)
    if len(", ".join(names)) > LONGEST_LIST:
        names = sorted(difflib.get_close_matches(str(name), names, n=FEW_NAMED, cutoff=0.0))
    name = name if len(name) <= LONGEST_SHOWN else f"{name[:LONGEST_SHOWN]}..."
    match = nearest(name, names)
    hint = f"; did you mean '{match}'?" if match else "."
    place = f" in {where}" if where else ""
    more = f", and {number - len(names)} that are less like it" if len(names) < number else ""
    return UsageError(f"unknown {kind} '{name}'{place}{hint} Allowed: {', '.join(names) or 'none'}{more}")


def shown(value: object) -> str:
    """Return a value as a message shows it: as YAML writes it, and never longer than a line."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, int) and abs(value) >= 10**30:
        return f"a number of about {int(value.bit_length() * math.log10(2)) + 1} digits"
    text = repr(value)
    return text if len(text) <= LONGEST_SHOWN else f"{text[:LONGEST_SHOWN]}... ({len(text)} characters)"


def without_numbers(text: str) -> str:
    """Return a message with ``#`` for each number, so that two that differ in their values alone are equal."""
    return NUMBER.sub("#", text)


def visible(text: str) -> str:
    """Return a text without what a terminal would obey: other characters than printed ones stand as escapes."""
    if text.isprintable():
        return text
    kept = ("\n", "\t", "\r")
    return "".join(
        one if one in kept or unicodedata.category(one)[0] != "C" else one.encode("unicode_escape").decode() for one in text
    )


def text_of(problem: BaseException) -> str:
    """Return what an exception says, also where it cannot say it."""
    try:
        return str(problem)
    except Exception:
        return "its own text fails"


def counted(number: int, one: str, many: str = "") -> str:
    """Return a number with its word: ``1 test``, ``3 tests``; ``many`` is the plural where no s makes it."""
    return f"{number} {one if number == 1 else many or f'{one}s'}"


def plain(number: float, digits: int = 3) -> str:
    """Return a number with so many digits, without an exponent where it is neither very large nor very small."""
    if number and math.isfinite(number) and 1e-6 <= abs(number) < 1e7:
        places = max(digits - 1 - math.floor(math.log10(abs(number))), 0)
        text = f"{number:.{places}f}"
        return text.rstrip("0").rstrip(".") if "." in text else text
    return f"{number:.{digits}g}"
