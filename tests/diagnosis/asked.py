"""A diagnosis as the command makes it, of tests in memory and of the effects that are asked for."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from hjcamp.diagnosis.calibration.analysis import Analysis, calibrated
from hjcamp.diagnosis.data.tests import Measured
from hjcamp.diagnosis.decision.verdict import Verdict, decided
from hjcamp.effects import load_effects


def analysed(measured: Measured, names: Iterable[str] = (), **how: Any) -> Analysis:
    """Return the analysis of tests with some effects of their plant's library."""
    library = load_effects(plant=measured.plant)
    return calibrated(measured, {name: library[name] for name in names}, **how)


def asked(measured: Measured, names: Iterable[str] = (), **how: Any) -> tuple[Analysis, Verdict]:
    """Return that analysis and its verdict."""
    analysis = analysed(measured, names, **how)
    return analysis, decided(analysis)
