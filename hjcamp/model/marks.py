"""Marks with which a plant's equations say where an effect may act; in plain Python each is an ordinary function."""

from __future__ import annotations


def slot(value: float, unit: str, text: str) -> float:
    """Return ``value`` unchanged: a quantity that an effect may add to or transform."""
    return value


def signal(value: float, unit: str, text: str) -> float:
    """Return ``value`` unchanged: a quantity that an effect may read but not change."""
    return value


def limited(value: float, low: float, high: float) -> float:
    """Return ``value`` held between ``low`` and ``high``."""
    return min(max(value, low), high)
