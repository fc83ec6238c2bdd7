"""What a non-parametric term of a diagnosis is, in words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def described_term(row: Mapping[str, Any]) -> str:
    """Return what a non-parametric term adds, where, and what it depends on."""
    if row["quantity"] in ("gain", "value"):
        return f"{row['quantity']} of {row['port'].replace('_', ' ')} that depends on {row['driver'].replace('_', ' ')}"
    place, driver = row["port"], local_driver(row["driver"].rpartition("_")[2])
    if driver == "difference":
        return f"leak from {' to '.join(row['signal'].replace('_', ' ').split(' - '))} that depends on their difference"
    if driver == "time":
        changes = "otherwise with time in each condition" if row["apart_s"] else "with time"
        return f"{row['quantity']} at {place.replace('_', ' ')} that changes {changes}"
    at = "" if place in (driver, row["quantity"]) else f" at {place.replace('_', ' ')}"
    return f"{row['quantity']}{at} that depends on {state_of(row) or ('the ' if place == driver else 'its ') + driver}"


def state_of(row: Mapping[str, Any]) -> str:
    """Return the state that drives a non-parametric term, in words, where it is called otherwise than what drives it at its place."""
    local, signal = row["driver"].rpartition("_")[2], row["signal"]
    named = (
        local in ("position", "velocity", "travel", "level") and signal != local and not signal.startswith(f"{row['port']}_")
    )
    return signal.replace("_", " ") if named and signal != row["port"] else ""


def local_driver(driver: str) -> str:
    """Return what drives a law at its own place, in words."""
    return "true value" if driver == "true" else driver


def with_article(words: str, begins: bool = False) -> str:
    """Return words with their indefinite article, as a sentence has them, or begins with them."""
    said = f"{'an' if words[:1] in 'aeiou' else 'a'} {words}"
    return said[:1].upper() + said[1:] if begins else said
