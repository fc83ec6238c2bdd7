"""The test log in memory: one repetition, its fields by name, its metadata and attachments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import ClassVar

import numpy as np

TOPIC = "/test/sample"
METADATA_NAME = "hjcamp.test"
SAMPLE_S = 0.001
COMMAND_PHASE = 3.0
PHASES = {0: "preload", 1: "pressure adjustment", 2: "rest", 3: "command and control", 4: "release"}


@dataclass(frozen=True)
class Field:
    """One field of a sample: name, unit as written in the log, whether every log must have it, meaning."""

    name: str
    unit: str
    required: bool
    text: str


# The position in this table is the protobuf field number: append only, at most 15.
FIELDS: tuple[Field, ...] = (
    Field("time_s", "s", True, "0 at the first sample of the command phase; negative before"),
    Field("phase", "1", False, "0 preload, 1 pressure adjustment, 2 rest, 3 command and control, 4 release"),
    Field("reference_deg", "deg", False, "desired arm angle"),
    Field("arm_deg", "deg", True, "arm encoder"),
    Field("pressure1_mpa", "MPa", True, "pressure of line 1, pump side, gauge"),
    Field("pressure2_mpa", "MPa", True, "pressure of line 2, pump side, gauge"),
    Field("pump_deg", "deg", False, "pump motor encoder; 360 deg = 1 mm of piston travel"),
    Field("command_deg", "deg", False, "command to the pump's own position loop"),
    Field("pid_deg", "deg", False, "feedback part of the command"),
    Field("feedforward_deg", "deg", False, "feedforward part of the command"),
    Field("dither_v", "V", False, "dither added to the pump motor voltage"),
)
FIELD_NAMES: tuple[str, ...] = tuple(entry.name for entry in FIELDS)
REQUIRED: tuple[str, ...] = tuple(entry.name for entry in FIELDS if entry.required)
ONE_OF: tuple[str, ...] = ("pump_deg", "command_deg")

# What tells two tests apart where a log names no condition.
CHOICES: tuple[str, ...] = (
    "campaign",
    "trajectory",
    "controller",
    "payload",
    "orientation",
    "pump",
    "amplifier",
    "tubing",
    "backend",
    "preload_mpa",
)


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
    def duration(self) -> float:
        """Time that the samples cover, one period each, in s."""
        return self.samples * SAMPLE_S

    @cached_property
    def command_phase(self) -> dict[str, np.ndarray]:
        """The columns in phase 3 (command and control) alone; all rows where the log has no ``phase``."""
        if "phase" not in self.columns:
            return dict(self.columns)
        rows = np.flatnonzero(self.columns["phase"] == COMMAND_PHASE)
        if len(rows) and rows[-1] - rows[0] + 1 == len(rows):
            return {name: values[rows[0] : rows[-1] + 1] for name, values in self.columns.items()}
        return {name: values[rows] for name, values in self.columns.items()}

    @property
    def condition_key(self) -> str:
        """Equal for repetitions of one test: ``condition``, else the choices, else the name of the file alone."""
        return condition_key(self.metadata, self.path)


def condition_key(metadata: Mapping[str, str], path: Path | None = None) -> str:
    """Return the name that repetitions of one test share."""
    if condition := metadata.get("condition"):
        return condition
    if any(metadata.get(name) for name in CHOICES):
        return " ".join(f"{name}={metadata[name]}" for name in CHOICES if metadata.get(name))
    return path.stem if path is not None else "unnamed"
