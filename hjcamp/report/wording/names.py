"""Names of choices, conditions and tests as people read them, on pages and in papers."""

from __future__ import annotations

import re

from hjcamp.errors import visible
from hjcamp.model.language.field_unit import FIELD_UNITS

WORDS = {
    "pid": "PID", "pva": "PVA", "ffwd": "feedforward", "pos": "positive", "neg": "negative", "rmse1": "RMSE1", "rmse2": "RMSE2",
    "hz": "Hz", "none": "none", "ldpe": "LDPE", "hdpe": "HDPE",
}  # fmt: skip
NUMBER = re.compile(r"(?<![A-Za-z])(\d+)p(\d+)")
VALUE = re.compile(r"-?[\d.]+(e-?\d+)?")
UNITS = {**{one.suffix: one.shown.replace("^", "") for one in FIELD_UNITS.values()}, "hz": "Hz", "ratio": ""}


def readable(name: str) -> str:
    """Return a name of a choice, a condition, or one of its tests for people.

    ``sine_0p5hz__ffwd_pid/2`` is "sine 0.5 Hz, feedforward PID/2", ``frequency_hz=0.5__none`` is "frequency 0.5 Hz, none".
    """
    # a dollar begins a formula where it is drawn
    condition, slash, repetition = visible(name).replace("$", r"\$").partition("/")
    return ", ".join(map(_part, condition.split("__"))) + slash + repetition


def _part(part: str) -> str:
    # in earlier runs a value stood behind a "-"
    key, _, value = part.partition("=" if "=" in part else "-")
    if not (key[:1].isalpha() and VALUE.fullmatch(value)):
        return _words(NUMBER.sub(r"\1.\2", part.replace("_", " ")))
    suffix = max((one for one in UNITS if key.endswith(f"_{one}")), key=len, default="")
    words = _words(key.removesuffix(f"_{suffix}" if suffix else "").replace("_", " "))
    return f"{words} {value} {UNITS.get(suffix, '')}".rstrip()


def axis(parameter: str) -> str:
    """Return the full name of a parameter as the label of an axis: ``controller.dither.amplitude_v`` is "dither amplitude (V)".

    A parameter that carries no unit in its name stands without one.
    """
    *groups, name = parameter.split(".")
    suffix = max((one for one, unit in UNITS.items() if unit and name.endswith(f"_{one}")), key=len, default="")
    words = _words(" ".join([*groups[1:], name.removesuffix(f"_{suffix}" if suffix else "")]).replace("_", " "))
    return f"{words} ({UNITS[suffix]})" if suffix else words


def _words(text: str) -> str:
    text = re.sub(r"(\d)(hz|mm|g|s)\b", r"\1 \2", text)
    return " ".join(WORDS.get(word, word) for word in text.split())
