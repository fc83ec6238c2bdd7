"""The test log in memory: one repetition, its fields by name, its metadata and attachments."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import ClassVar

import numpy as np

from hjcamp.errors import UsageError
from hjcamp.known_plants import usual_plant
from hjcamp.model.language.field_table import FieldTable
from hjcamp.records.of_plant import PERIOD_KEY, PLANT_KEY, period_of, table_of

TOPIC = "/test/sample"
COMMAND_PHASE = 3.0
SIMULATION = "simulation"
PHASES = {0: "preload", 1: "pressure adjustment", 2: "rest", 3: "command and control", 4: "release"}


# What tells two tests apart where a log names no condition.
_USUAL = usual_plant()
CHOICES: tuple[str, ...] = (
    "campaign", "trajectory", "controller", *_USUAL.setups, *_USUAL.rig, "backend", "preload_mpa",
)  # fmt: skip
# What differs between repetitions of a test, or is the same in all of them.
BOOKKEEPING = {PLANT_KEY, PERIOD_KEY, "repetition", "seed", "started_at", "model", "config_sha256", "git", "version"}


@dataclass(frozen=True, eq=False)
class TestLog:
    """One repetition of a test.

    ``columns`` maps field names to float64 arrays of shape (samples,), in the units of the field names;
    an optional field that was not logged is absent. ``metadata`` is the record ``hjcamp.test``.
    """

    __test__: ClassVar[bool] = False  # pytest would collect a class of this name

    columns: dict[str, np.ndarray]
    metadata: dict[str, str] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    path: Path | None = None

    @property
    def samples(self) -> int:
        """Number of samples."""
        return len(self.columns["time_s"])

    @property
    def table(self) -> FieldTable:
        """The fields that logs of its plant have; raises ``UsageError`` for a plant that is not known."""
        return table_of(self.metadata, self._where)

    @property
    def period(self) -> float:
        """Time between two samples, s; raises ``UsageError`` where the metadata give none that can be."""
        return period_of(self.metadata, self._where)

    @property
    def _where(self) -> str:
        return str(self.path or "this log")

    @property
    def duration(self) -> float:
        """Time that the samples cover, one period each, in s."""
        return self.samples * self.period

    @cached_property
    def command_phase(self) -> dict[str, np.ndarray]:
        """The columns in phase 3 (command and control) alone; all rows where the log has no ``phase``.

        Raises ``UsageError`` where the phase is no single stretch.
        """
        if "phase" not in self.columns:
            return dict(self.columns)
        if fault := parted(self.columns):
            raise UsageError(f"{self._where}: {fault}")
        rows = np.flatnonzero(self.columns["phase"] == COMMAND_PHASE)
        return {name: values[rows[0] : rows[-1] + 1] if len(rows) else values[:0] for name, values in self.columns.items()}

    @property
    def condition_key(self) -> str:
        """Equal for repetitions of one test: ``condition``, else the choices, else the name of the file alone."""
        return condition_key(self.metadata, self.path)


def parted(columns: Mapping[str, np.ndarray]) -> str:
    """Return in words that the command phase is no single stretch of time; empty where it is, or where there are no phases."""
    phase, time = columns.get("phase"), columns["time_s"]
    if phase is None:
        return ""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], phase == COMMAND_PHASE, [0]])))
    first, last = edges[::2], edges[1::2] - 1
    if len(first) < 2:
        return ""
    shown = [f"{time[a]:.6g} to {time[b]:.6g} s" for a, b in zip(first[:3], last[:3], strict=True)]
    more = f" and {len(first) - 3} more" if len(first) > 3 else ""
    return (
        f"the command phase (phase 3) comes in {len(first)} stretches ({', '.join(shown)}{more}), which are several tests "
        "or one with a hole; make one log of each stretch (hjcamp log export, then hjcamp import of its rows)"
    )


def condition_key(metadata: Mapping[str, str], path: Path | None = None) -> str:
    """Return the name that repetitions of one test share."""
    if condition := metadata.get("condition"):
        return condition
    # A test of another plant is told apart by whatever its metadata say of it, such as a mass or a supply.
    choices = tuple(sorted(set(metadata) - BOOKKEEPING)) if metadata.get(PLANT_KEY) else CHOICES
    if any(metadata.get(name) for name in choices):
        return " ".join(f"{name}={metadata[name]}" for name in choices if metadata.get(name))
    return path.stem if path is not None else "unnamed"


def observed(logs: Iterable[TestLog]) -> str:
    """Return what the readings of logs are called: ``simulated`` where a simulation made all of them, else ``measured``."""
    return "simulated" if {log.metadata.get("backend") for log in logs} == {SIMULATION} else "measured"
