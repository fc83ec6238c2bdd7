"""Read a test log, whoever wrote it, and refuse what is no whole test."""

from __future__ import annotations

from pathlib import Path

from hjcamp.errors import UsageError
from hjcamp.records.check import check_log
from hjcamp.records.log import TestLog
from hjcamp.records.mcap.chunks import Damaged
from hjcamp.records.mcap.samples import SampleDecoder, Samples
from hjcamp.records.mcap.scan import Scan, load, metadata_of, scan


def read_log(path: str | Path, validate_crcs: bool = True) -> TestLog:
    """Return the test log in a file, protobuf or JSON.

    Raises UsageError, one line with the file, the fault, the place and what to do, for a file that is missing,
    no MCAP file, truncated, damaged or too large, and for samples that are no whole test of its plant, one each period.
    """
    source = Path(path)
    found, samples = read_samples(source, validate_crcs)
    log = TestLog(samples.columns, metadata_of(found), attachments_of(found), source)
    check_log(log, str(source))
    return log


def read_metadata(path: Path) -> dict[str, str]:
    """Return the metadata of a test log, its samples neither decoded nor checked: for what is asked before they are read."""
    data = load(path)
    try:
        return metadata_of(scan(data, validate_crcs=False))
    except Damaged as fault:
        raise _damaged(path, fault) from fault


def read_samples(path: Path, validate_crcs: bool = True) -> tuple[Scan, Samples]:
    """Return what a whole file holds, without asking whether the samples are a whole test."""
    data = load(path)
    try:
        found = scan(data, validate_crcs)
        decoder = SampleDecoder(found, str(path))
        for stretch in found.stretches:
            decoder.add(stretch)
    except Damaged as fault:
        raise _damaged(path, fault) from fault
    found.stretches.clear()
    return found, decoder.result()


def _damaged(path: Path, fault: Damaged) -> UsageError:
    return UsageError(f"{path}: {fault}; what is whole in it can be saved: hjcamp log recover {path}")


def attachments_of(found: Scan) -> dict[str, bytes]:
    """Return the attachments by name."""
    return {record.name: record.data for record in found.attachments}
