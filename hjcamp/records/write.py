"""Write test logs: a whole one at once, or sample by sample while a test runs."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from datetime import UTC, datetime, timedelta
from pathlib import Path
from types import TracebackType
from typing import IO

import numpy as np

from hjcamp.errors import HjcampError, UsageError
from hjcamp.model.language.field_table import FieldTable
from hjcamp.records.check import check_names
from hjcamp.records.log import TOPIC, TestLog
from hjcamp.records.mcap.container import CHANNEL, Container
from hjcamp.records.mcap.layout import encode, record_dtype
from hjcamp.records.mcap.scan import METADATA_NAME, MOST_RECORDS, MOST_UNCOMPRESSED_BYTES
from hjcamp.records.mcap.schema import descriptor_set
from hjcamp.records.of_plant import period_of, table_of
from hjcamp.storage import disk_errors, new_part, put_in_place

CHUNK_BYTES = 64 * 1024
BETWEEN_FLUSHES_S = 0.1  # what a power cut may cost
SPARE_RECORDS = 100_000  # of a file's records: those that are no samples
INDEX_BYTES = 16  # of a sample in the index of its chunk
EPOCH_NS = 1_000_000_000_000_000_000  # for a log that does not know when it was made
MEDIA_TYPES = {".yaml": "application/yaml", ".json": "application/json", ".csv": "text/csv"}


def start_time_ns(metadata: Mapping[str, str]) -> int:
    """Return ``started_at`` (ISO 8601, UTC where it names no zone) in ns since 1970, or a fixed time."""
    try:
        started = datetime.fromisoformat(metadata["started_at"])
        started = started if started.tzinfo else started.replace(tzinfo=UTC)
        microseconds = (started - datetime(1970, 1, 1, tzinfo=UTC)) // timedelta(microseconds=1)
    except (KeyError, ValueError, OverflowError):
        return EPOCH_NS
    return microseconds * 1000 if microseconds >= 0 else EPOCH_NS


def write_log(path: str | Path, log: TestLog) -> None:
    """Write a whole log under its final name at once; equal logs give equal bytes.

    Raises UsageError for columns that are no log, HjcampError where a value is not finite or the disk refuses.
    """
    target = Path(path)
    names = field_order(log.columns, log.table, str(target))
    columns = [np.asarray(log.columns[name], dtype=np.float64) for name in names]
    if any(values.shape != columns[0].shape or values.ndim != 1 for values in columns) or not len(columns[0]):
        shapes = ", ".join(f"{name} {values.shape}" for name, values in zip(names, columns, strict=True))
        raise UsageError(f"{target}: columns must share one shape (samples,) and hold a sample; they are {shapes}")
    check_samples(len(columns[0]), len(names), str(target))
    for name, values in zip(names, columns, strict=True):
        if not np.isfinite(values).all():
            sample = int(np.argmin(np.isfinite(values)))
            raise HjcampError(f"{target}: not written, '{name}' is {values[sample]} at sample {sample}")
    writer = LogWriter(target, names, log.metadata, log.attachments, replace=True)
    try:
        writer.append_arrays(columns)
        writer.close()
    except BaseException:
        writer.abort().unlink(missing_ok=True)
        raise


def check_samples(samples: int, fields: int, where: str) -> None:
    """Raise UsageError for more samples of so many fields than a log can have that is still read."""
    size = record_dtype(tuple(range(1, fields + 1))).itemsize + INDEX_BYTES
    most = min(MOST_RECORDS - SPARE_RECORDS, MOST_UNCOMPRESSED_BYTES // size)
    if samples > most:
        raise UsageError(
            f"{where}: {samples} samples of {fields} fields are more than a test log holds ({most}); make several tests of it, or say "
            "a longer resample_s in the map of its import"
        )


def field_order(names: Iterable[str], table: FieldTable, where: str) -> tuple[str, ...]:
    """Return the fields in the order of the field table; raises UsageError for unknown or missing ones."""
    given = list(names)
    for name in given:
        table.field(name, where)
    check_names(given, table, where)
    return tuple(name for name in table.names if name in given)


class LogWriter:
    """Writes a log while the test runs: ``NAME.part`` until ``close`` gives it its final name.

    Not for the control loop's own thread: ``flush`` waits for the disk. Used as a context it closes at the end,
    and on an exception aborts, which leaves a ``.part`` that ``recover_log`` reads.
    """

    def __init__(
        self,
        path: str | Path,
        names: Sequence[str],
        metadata: Mapping[str, str],
        attachments: Mapping[str, bytes] | None = None,
        samples_between_flushes: int | None = None,
        replace: bool = False,
    ) -> None:
        self.path = Path(path)
        self.part = self.path.with_name(self.path.name + ".part")
        table = table_of(metadata, str(self.path))
        self.names = field_order(names, table, str(self.path))
        self.samples = 0
        self._numbers = tuple(map(table.number, self.names))
        usual = max(1, round(BETWEEN_FLUSHES_S / period_of(metadata, str(self.path))))
        self._samples_between_flushes = samples_between_flushes or usual
        self._start_ns = start_time_ns(metadata)
        self._first_time: float | None = None
        self._rows: list[list[float]] = []
        if self.path.exists() and not replace:
            raise UsageError(f"{self.path}: exists already; a whole log is never overwritten")
        with disk_errors(self.part):
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._stream: IO[bytes] | None = new_part(self.part)  # closed by close or abort
            self._container = Container(self._stream)
            self._container.add_metadata(METADATA_NAME, metadata)
            for name, content in sorted((attachments or {}).items()):
                media_type = MEDIA_TYPES.get(Path(name).suffix, "application/octet-stream")
                self._container.add_attachment(name, media_type, content, self._start_ns)
            units = {name: table.field(name).unit for name in self.names}
            self._container.add_channel(TOPIC, descriptor_set(tuple(zip(self.names, self._numbers, strict=True))), units)

    def append(self, sample: Mapping[str, float]) -> None:
        """Add one sample (field name to value); every field given at the start must be there."""
        self._rows.append([sample[name] for name in self.names])
        if len(self._rows) >= self._samples_between_flushes:
            self.flush()

    def append_many(self, columns: Mapping[str, np.ndarray]) -> None:
        """Add samples, columns of one shape (samples,), and put them on the disk."""
        self._write_rows()
        self.append_arrays([np.asarray(columns[name], dtype=np.float64) for name in self.names])
        self.flush()

    def append_arrays(self, columns: Sequence[np.ndarray]) -> None:
        """Add samples as arrays in the order of ``names``; the caller flushes."""
        if not len(columns[0]):
            return
        time = columns[0]
        if not np.isfinite(time).all():
            raise HjcampError(f"{self.part}: a sample without a time cannot be logged")
        if self._first_time is None:
            self._first_time = float(time[0])
        size = max(1, CHUNK_BYTES // record_dtype(self._numbers).itemsize)
        with disk_errors(self.part):
            for start in range(0, len(time), size):
                piece = [values[start : start + size] for values in columns]
                log_time = self._start_ns + np.rint((piece[0] - self._first_time) * 1e9).astype(np.int64)
                self._container.add_chunk(encode(self._numbers, piece, log_time, CHANNEL, self.samples))
                self.samples += len(log_time)

    def flush(self) -> None:
        """Put everything that was appended on the disk."""
        self._write_rows()
        self._to_disk()

    def close(self) -> Path:
        """Finish the file and give it its final name."""
        if self._stream is not None:
            self._write_rows()
            with disk_errors(self.part):
                self._container.finish()
                self._to_disk()
                self._stream.close()
                self._stream = None
                put_in_place(self.part, self.path)
        return self.path

    def abort(self) -> Path:
        """Stop and leave what was written as ``NAME.part``, which can be recovered."""
        stream, self._stream = self._stream, None
        if stream is not None:
            with suppress(HjcampError, OSError):  # the disk is full: what reached it stays
                self._write_rows()
                stream.flush()
                os.fsync(stream.fileno())
            with suppress(OSError):
                stream.close()
        return self.part

    def _write_rows(self) -> None:
        if self._rows:
            rows, self._rows = self._rows, []
            self.append_arrays(list(np.array(rows, dtype=np.float64).T))

    def _to_disk(self) -> None:
        if self._stream is not None:
            with disk_errors(self.part):
                self._stream.flush()
                os.fsync(self._stream.fileno())

    def __enter__(self) -> LogWriter:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if kind is None:
            self.close()
        else:
            self.abort()
