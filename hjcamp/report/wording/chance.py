"""How probable a gain is by chance, in words: a count of replicates shows no p-value below its own resolution."""

from __future__ import annotations

from hjcamp.report.wording.units import plain


def p_words(p_value: float, replicates: int) -> str:
    """Return ``p = 0.12``, or ``p <= 0.04`` where no replicate of so many gained as much: the count shows no less than 1 / (n + 1)."""
    return f"p {'<=' if at_resolution(p_value, replicates) else '='} {plain(p_value, 2)}"


def at_resolution(p_value: float, replicates: int) -> bool:
    """Return whether a p-value is the least that a count over so many replicates can show."""
    return replicates > 0 and p_value * (replicates + 1) < 1.5
