"""Verify a log, and recover what is whole in a damaged or unfinished one."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from hjcamp.errors import UsageError, counted
from hjcamp.known_plants import DEFAULT
from hjcamp.records.check import check_log, check_names
from hjcamp.records.log import COMMAND_PHASE, PHASES, TOPIC, TestLog
from hjcamp.records.mcap.container import CHANNEL, Container
from hjcamp.records.mcap.layout import encode
from hjcamp.records.mcap.salvage import Salvage, decode_salvage, salvage
from hjcamp.records.mcap.samples import MOST_SAMPLES, Samples
from hjcamp.records.mcap.scan import load, metadata_of
from hjcamp.records.mcap.schema import descriptor_set
from hjcamp.records.of_plant import PLANT_KEY, USUAL_PERIOD_S, period_of, table_of
from hjcamp.records.plausible import Finding, findings
from hjcamp.records.read import attachments_of, read_log, read_samples
from hjcamp.records.write import CHUNK_BYTES
from hjcamp.storage import whole_file

RECOVERY_METADATA = "hjcamp.recovery"


@dataclass(frozen=True)
class Verification:
    """What a log holds and what is wrong with it; ``whole`` means that ``read_log`` takes it. Period and duration in s.

    ``findings`` are what is not plausible in a whole log.
    """

    path: Path
    whole: bool
    plant: str
    period: float
    samples: int
    duration: float
    fields: tuple[str, ...]
    metadata: dict[str, str]
    attachments: tuple[str, ...]
    problems: tuple[str, ...]
    findings: tuple[Finding, ...] = ()

    @property
    def refused(self) -> bool:
        """Whether it holds what cannot be, so that no analysis takes it."""
        return any(one.refused for one in self.findings)


@dataclass(frozen=True)
class Recovery:
    """Samples kept and lost; where the file does not say how many it held, ``lost`` is what misses between those kept.

    ``until`` is the time of the last sample kept, s, and ``phase`` its phase (None: the log has no phases).
    """

    path: Path
    kept: int
    lost: int
    lost_is_exact: bool
    problems: tuple[str, ...]
    until: float
    phase: int | None

    @property
    def words(self) -> str:
        """What is known of the samples, and what is not."""
        if self.lost_is_exact:
            return f"{counted(self.kept, 'sample')} kept, {self.lost} lost"
        between = f", {self.lost} lost among them" if self.lost else ""
        phase = "" if self.phase is None else f" in phase {self.phase} ({PHASES.get(self.phase, 'unknown')})"
        return (
            f"{counted(self.kept, 'sample')} kept{between}, the last at {self.until:.3f} s{phase}; "
            "how many came after it is not known: the file does not say how many it held"
        )


def verify_log(path: str | Path) -> Verification:
    """Return a report on one log; raises UsageError only where there is no MCAP file to report on."""
    source = Path(path)
    data = load(source)
    try:
        found, samples = read_samples(source)
        log = TestLog(samples.columns, metadata_of(found), attachments_of(found), source)
        check_log(log, str(source))
        return _verification(source, True, samples, Salvage(found, _remarks(samples, log.period)), tuple(findings(log)))
    except UsageError as fault:
        problem = str(fault).removeprefix(f"{source}: ")
    result = salvage(data)
    try:
        samples = decode_salvage(result, str(source)).result()
    except UsageError:
        samples = Samples({}, np.empty(0, np.uint64))
    result.problems = list(dict.fromkeys([problem, *result.problems]))
    return _verification(source, False, samples, result)


def verify_logs(paths: Sequence[Path]) -> list[Verification]:
    """Return a report on each log, whole ones looked at as a set as well."""
    from hjcamp.records.sets.look import look_at

    found = {path: verify_log(path) for path in paths}
    whole = {read_log(path): path for path, own in found.items() if own.whole}
    for one in look_at(list(whole)):
        own = found[whole[one.log]]
        found[own.path] = replace(own, findings=(*own.findings, one.finding))
    return list(found.values())


def _remarks(samples: Samples, period: float) -> list[str]:
    remarks = list(samples.notes)
    phase = samples.columns.get("phase")
    zero = int(np.argmax(phase == COMMAND_PHASE)) if phase is not None else 0
    if abs(start := samples.columns["time_s"][zero]) > period:
        remarks.append(f"the command phase starts at time {start:.6g} s instead of 0")
    return remarks


def _verification(path: Path, whole: bool, samples: Samples, result: Salvage, found: tuple[Finding, ...] = ()) -> Verification:
    metadata, period = metadata_of(result.found), USUAL_PERIOD_S
    with suppress(UsageError):
        period = period_of(metadata, str(path))
    return Verification(
        path=path,
        whole=whole,
        plant=metadata.get(PLANT_KEY) or DEFAULT,
        period=period,
        samples=len(samples.log_time),
        duration=len(samples.log_time) * period,
        fields=tuple(samples.columns),
        metadata=metadata,
        attachments=tuple(record.name for record in result.found.attachments),
        problems=tuple(result.problems),
        findings=found,
    )


def recover_log(path: str | Path, out: str | Path) -> Recovery:
    """Write what is whole in ``path`` to the new log ``out``, with all metadata and attachments.

    Raises UsageError where nothing can be recovered or ``out`` exists, HjcampError where the disk refuses.
    """
    source, target = Path(path), Path(out)
    if target.exists():
        raise UsageError(f"{target}: exists already; give the recovered log another name")
    result = salvage(load(source))
    metadata = metadata_of(result.found)
    decoder = decode_salvage(result, str(source))
    try:
        samples = _without_duplicates(decoder.result())
        check_names(samples.columns, table_of(metadata, str(source)), str(source))
        period = period_of(metadata, str(source))
    except UsageError as fault:
        reason = str(fault).removeprefix(f"{source}: ")
        raise UsageError(f"{source}: nothing can be recovered: {reason}") from fault
    kept = len(samples.log_time)
    lost, exact = _lost(result, samples.log_time, period)
    until, last = float(samples.columns["time_s"][-1]), float(samples.columns.get("phase", [np.nan])[-1])
    problems = tuple(dict.fromkeys(result.problems))
    recovery = Recovery(target, kept, lost, exact, problems, until, int(last) if np.isfinite(last) else None)
    note = {"source": source.name, "kept": str(kept), "lost": str(lost), "lost_is_exact": str(exact).lower()}
    _write(target, samples, result, note)
    return recovery


def _without_duplicates(samples: Samples) -> Samples:
    times, rows = np.unique(samples.log_time, return_index=True)
    if len(times) == len(samples.log_time):
        return samples
    return Samples({name: values[rows] for name, values in samples.columns.items()}, times, samples.notes)


def _lost(result: Salvage, log_time: np.ndarray, period: float) -> tuple[int, bool]:
    """Return the number of lost samples and whether the file's own statistics say so."""
    channels = [channel.id for channel in result.found.channels.values() if channel.topic == TOPIC]
    declared = (result.messages_declared or {}).get(channels[0])
    if declared is not None and len(log_time) <= declared <= MOST_SAMPLES:
        return declared - len(log_time), True
    first, last, step = int(log_time[0]), int(log_time[-1]), max(1, round(period * 1e9))
    for start, end in result.lost_spans:
        if first - MOST_SAMPLES * step < start and end < last + MOST_SAMPLES * step:
            first, last = min(first, start), max(last, end)
    return max(0, round((last - first) / step) + 1 - len(log_time)), False


def _write(target: Path, samples: Samples, result: Salvage, note: dict[str, str]) -> None:
    table = table_of(metadata_of(result.found), str(target))
    numbers = tuple(map(table.number, samples.columns))
    messages = encode(numbers, list(samples.columns.values()), samples.log_time, CHANNEL, 0)
    size = CHUNK_BYTES // messages.itemsize
    with whole_file(target) as stream:
        container = Container(stream)
        for record in result.found.metadata:
            container.add_metadata(record.name, record.metadata)
        container.add_metadata(RECOVERY_METADATA, note)
        for attachment in result.found.attachments:
            container.add_attachment(attachment.name, attachment.media_type, attachment.data, attachment.log_time)
        units = {name: table.field(name).unit for name in samples.columns}
        container.add_channel(TOPIC, descriptor_set(tuple(zip(samples.columns, numbers, strict=True))), units)
        for start in range(0, len(messages), size):
            container.add_chunk(messages[start : start + size])
        container.finish()
