"""Writes the test to the disk while it runs, from a thread of its own: the loop only fills an array."""

from __future__ import annotations

import os
import threading
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hjcamp.backends.recording import Recording, Samples, Writer, part_of

Array = NDArray[np.float64]
WRITE_EVERY_S = 0.05
SAMPLES_AT_ONCE = 100


class Journal:
    """The rows of one test: ``rows`` (samples, fields, SI in the order of ``scales``), ``count`` of them are filled.

    ``scales`` are the fields of the log, each with its number for one SI unit; ``period`` is the time between samples, s.

    Before the command phase the first sample's time is unknown; those rows go to ``NAME.before.mcap.part``. Once it
    is known ``NAME.mcap.part`` is written from the start with the right times. A power cut costs what was not
    written yet: 50 ms or 100 samples. ``problem`` is what prevented writing.
    """

    def __init__(self, recording: Recording | None, longest: int, scales: Mapping[str, float], period: float) -> None:
        self.rows: Array = np.zeros((longest, len(scales)))
        self.count = 0
        self.first = -1
        self.missed = 0
        self.problem: Exception | None = None
        self._recording, self._scales, self._period = recording, dict(scales), period
        self._written = 0
        self._wake = threading.Event()
        self._ended = False
        self._writer: Writer | None = None
        self._early: Writer | None = None
        self._thread: threading.Thread | None = None
        if recording is not None:
            keep_stopped(recording.path)
            early = recording.path.with_name(f"{recording.path.stem}.before{recording.path.suffix}")
            self._early = recording.open_writer(early, self._names())
            self._thread = threading.Thread(target=self._run, name="test log", daemon=True)
            self._thread.start()

    def add(self, held: int) -> None:
        """Take over the row at ``count``, after ``held`` repetitions of the row before for samples that were missed."""
        if held:
            row = self.rows[self.count].copy()
            self.rows[self.count : self.count + held] = self.rows[max(0, self.count - 1)]
            self.count += held
            self.missed += held
            self.rows[self.count] = row
        self.count += 1
        if self.count - self._written >= SAMPLES_AT_ONCE:
            self._wake.set()

    def columns(self, start: int, end: int) -> dict[str, Array]:
        """Return some rows as columns of a log."""
        first = max(self.first, 0)
        columns: dict[str, Array] = {"time_s": np.asarray((np.arange(start, end) - first) * self._period, dtype=np.float64)}
        for place, (name, scale) in enumerate(self._scales.items()):
            columns[name] = self.rows[start:end, place] * scale
        return columns

    def close(self) -> None:
        """Write the rest and end the thread; ``NAME.mcap.part`` stays until the final log is whole."""
        if self._thread is None:
            return
        self._ended = True
        self._wake.set()
        self._thread.join(10.0)
        self._thread = None
        with suppress(Exception):
            if self._writer is not None:
                self._writer.abort()
            if self._early is not None and self._recording is not None:
                os.replace(self._early.abort(), part_of(self._recording.path))
        self._writer = self._early = None

    def _run(self) -> None:
        try:
            while not self._ended:
                self._wake.wait(WRITE_EVERY_S)
                self._wake.clear()
                self._write()
            self._write()
        except Exception as error:
            self.problem = error

    def _write(self) -> None:
        assert self._recording is not None
        end = self.count
        if self._recording.look is not None and end > self._written:
            # Who looks on must not stop a test.
            with suppress(Exception):
                shown = self.columns(self._written, end)
                self._recording.look(Samples(shown, self._written, self.first, self.missed))
        if self._early is not None and self.first >= 0:
            self._writer = self._recording.open_writer(self._recording.path, self._names())
            self._writer.append_many(self.columns(0, end))
            self._early.abort().unlink(missing_ok=True)
            self._early = None
            self._written = end
        elif end > self._written:
            writer = self._early or self._writer
            assert writer is not None
            writer.append_many(self.columns(self._written, end))
            self._written = end

    def _names(self) -> list[str]:
        return ["time_s", *self._scales]


def keep_stopped(path: Path) -> None:
    """Put the part of an earlier, stopped attempt aside as ``NAME.stopped_N.mcap.part``."""
    early = path.with_name(f"{path.stem}.before{path.suffix}")
    for part in (part_of(path), part_of(early)):
        if part.exists():
            number = 1
            while (aside := part_of(path.with_name(f"{path.stem}.stopped_{number}{path.suffix}"))).exists():
                number += 1
            os.replace(part, aside)
