"""How probable a gain is by chance, in words: a count of replicates shows no p-value below its own resolution."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from hjcamp.report.wording.units import plain


def p_words(p_value: float, replicates: int) -> str:
    """Return ``p = 0.12``, or ``p <= 0.04`` where no replicate of so many gained as much: the count shows no less than 1 / (n + 1)."""
    return f"p {'<=' if at_resolution(p_value, replicates) else '='} {plain(p_value, 2)}"


def at_resolution(p_value: float, replicates: int) -> bool:
    """Return whether a p-value is the least that a count over so many replicates can show."""
    return replicates > 0 and p_value * (replicates + 1) < 1.5


def chance_words(p_value: float, gain: float, drawn: ArrayLike) -> str:
    """Return a p-value with its resolution and with the gain against those by chance (replicates,).

    ``p <= 0.04, the least that 24 replicates can show; gain 158 against at most 6``
    """
    gains = np.asarray(drawn, dtype=np.float64)
    least = f", the least that {len(gains)} replicates can show" if at_resolution(p_value, len(gains)) else ""
    most = f"; gain {plain(gain)} against at most {plain(float(gains.max()), 2)}" if len(gains) else ""
    return f"{p_words(p_value, len(gains))}{least}{most}"
