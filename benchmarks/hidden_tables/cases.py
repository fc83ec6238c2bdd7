"""Cases of the benchmark of tables: what hides in which rig, and the table of indicators that its bench would print."""

from __future__ import annotations

import csv
import io
import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from truth.pump_joint.case import Case, build_case, simulate_test
from truth.pump_joint.menu import Condition, cycloids, points, sine

from benchmarks.hidden_effects.cases import TAKEN_OUT

Array = NDArray[np.float64]
NULLS, OUTSIDE = 8, "stray_spring"
#: Development of the search of tables looked at the rigs 3 to 6, 101 to 108, 112 and some of 7000 to 7020.
FIRST_SEED = 8000
TESTS = 5
LAST = 4
INDICATORS = ("rmse1_deg", "rmse2_deg", "e_max_deg", "sse_deg")
PRELOADS_MPA = (0.35, 0.5)
#: What every line says of the bench: its integral sums the products (`tests/truth/pump_joint/controller.py`).
BENCH = {"controller": "pid", "controller.bumpless": "1.0"}
#: The seven trajectories of thesis 5.2.5 as its figures show them: shape of amplitude 1, amplitude in deg.
TRAJECTORIES = {
    "ramp_pos": (lambda: points((0, 0), (1, 1)), 120),
    "ramp_neg": (lambda: points((0, 0), (1, 1)), -120),
    "sine_0p5hz": (lambda: sine(0.5, 4), 60),
    "sine_1hz": (lambda: sine(1, 2), 60),
    "cycloid_pos": (lambda: cycloids((1, 1, 1)), 120),
    "cycloid_neg": (lambda: cycloids((1, 1, 1)), -120),
    "mixed": (lambda: cycloids((1, 1, 1), (-1, 1, 0.5), (0.5, 0.5, 0.5), (-0.5, 0.5, 1)), 120),
}


@dataclass(frozen=True)
class TableCase:
    """One case: the effect that hides (empty: nothing), its strength, the rig's seed."""

    kind: str
    effect: str
    strength: str
    seed: int

    @property
    def name(self) -> str:
        """The name in the ledger."""
        return f"{self.effect or 'nothing'}-{self.seed}"

    @property
    def verdict(self) -> str:
        """What is right to say of it."""
        return {"effect": "effect", "null": "nothing_missing", "outside": "outside_library"}[self.kind]


def plan(shift: int = 0) -> list[TableCase]:
    """Return the cases, each on a rig of its own, in an order drawn by chance, so that a part of them is a fair sample."""
    kinds = [("effect", name) for name in TAKEN_OUT] + [("outside", OUTSIDE)] + [("null", "")] * NULLS
    found = [
        TableCase(kind, name, "strong" if name else "", FIRST_SEED + shift + number)
        for number, (kind, name) in enumerate(kinds)
    ]
    return random.Random(FIRST_SEED).sample(found, len(found))


def conditions() -> list[tuple[str, float, Condition]]:
    """Return trajectory, preload (MPa) and test of each line of the table: PID as in thesis 5.2.5."""
    return [
        (name, preload, Condition(f"{name}_{preload:g}", name, shape, amplitude, preload, True, 1.2, 0.2))
        for preload in PRELOADS_MPA
        for name, (shape, amplitude) in TRAJECTORIES.items()
    ]


def table_of(case: TableCase, hidden: bool = True) -> list[dict[str, Any]]:
    """Return the lines of the table; without what is ``hidden``, of the same rig and the same draws."""
    effects = (case.effect,) if case.effect and hidden else ()
    lines = conditions()
    rig = build_case(effects, case.strength or "medium", case.seed, conditions=[one for _, _, one in lines])
    return [
        {**BENCH, "trajectory": name, "procedure.preload_mpa": preload, "tests": TESTS, **_row(rig, number)}
        for number, (name, preload, _) in enumerate(lines)
    ]


def _row(rig: Case, number: int) -> dict[str, float | None]:
    tests = np.array([_indicators(rig, number, repetition) for repetition in range(TESTS)])
    row: dict[str, float | None] = {}
    for place, name in enumerate(INDICATORS):
        values = tests[:, place]
        known = bool(np.isfinite(values).all())
        row[name] = float(values.mean()) if known else None
        row[f"{name}_deviation"] = float(values.std(ddof=1)) if known else None
    return row


def _indicators(rig: Case, number: int, repetition: int) -> list[float]:
    """Return RMSE, RMSE from 0.25 s on, largest error, and the mean error of the rest of a cycloid from 0.2 s on, deg."""
    rows = simulate_test(rig, number, repetition)
    error = rows[:, 2] - rows[:, 3]
    late = float("nan")
    if rig.conditions[number].trajectory.startswith("cycloid"):
        late = float(error[1200:].mean())  # the motion lasts 1 s
    return [
        float(np.sqrt(np.mean(error**2))),
        float(np.sqrt(np.mean(error[250:] ** 2))),
        float(np.abs(error).max()),
        late,
    ]


def text_of(lines: Sequence[dict[str, Any]]) -> str:
    """Return the table as a CSV file, rounded to a hundredth of a degree as a careful report would."""
    stream = io.StringIO()
    writer = csv.DictWriter(stream, list(lines[0]), lineterminator="\n")
    writer.writeheader()
    for line in lines:
        writer.writerow(
            {
                key: "" if value is None else f"{value:.2f}" if key.endswith(("_deg", "_deviation")) else value
                for key, value in line.items()
            }
        )
    return stream.getvalue()


def seen(with_it: Sequence[dict[str, Any]], without: Sequence[dict[str, Any]]) -> float:
    """Return how far the effect moves the table: root mean square of its shifts, in deviations of a test or a tenth."""
    shifts = []
    for one, other in zip(with_it, without, strict=True):
        for name in INDICATORS:
            if one[name] is None or other[name] is None:
                continue
            size = 0.1 if name == "sse_deg" else 0.1 * abs(other[name])
            shifts.append((one[name] - other[name]) / np.hypot(size, other[f"{name}_deviation"] / TESTS**0.5))
    return float(np.sqrt(np.mean(np.square(shifts))))
