"""The table that an import of many files ends with: what was read, and what looks wrong in each."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from hjcamp.errors import counted
from hjcamp.records.elsewhere.importing import Imported, Refused
from hjcamp.records.sets.look import InSet

#: With so few files each has its own lines, and the table says no more.
FEW = 5
#: Of more files those without a remark are counted, not listed.
LISTED = 60


def remarks_of(log: Imported, in_set: Sequence[InSet]) -> list[dict[str, str]]:
    """Return what looks wrong in a log: kind, field and text of each remark, those of its set among them."""
    found = [*log.doubtful, *(one.finding for one in in_set if one.log.path == log.path)]
    said = {one.field for one in found if one.kind == "constant"}
    rows = [{"kind": one.kind, "field": one.field, "text": one.text} for one in found]
    still = [
        {"kind": "constant", "field": name, "text": f"'{name}' keeps one value"} for name in log.constant if name not in said
    ]
    return [*rows, *still]


def answer_of(plant: str, logs: Sequence[Imported], refused: Sequence[Refused], in_set: Sequence[InSet]) -> dict[str, Any]:
    """Return the answer for programs: every log with all that is said of it, and what could not be read."""
    rows = [
        {
            "file": str(log.source), "log": str(log.path), "samples": log.samples, "duration_s": log.duration,
            "fields": list(log.fields), "metadata": log.metadata, "warnings": [one.line for one in log.doubtful],
            "remarks": remarks_of(log, in_set),
        }
        for log in logs
    ]  # fmt: skip
    not_read = [{"file": str(one.source), "text": one.text} for one in refused]
    return {"schema": "hjcamp.import/1", "plant": plant, "logs": rows, "not_read": not_read}


def table_lines(logs: Sequence[Imported], refused: Sequence[Refused], in_set: Sequence[InSet], width: int = 100) -> list[str]:
    """Return the lines of the table: samples, length, rate and remarks of each file, then all in numbers."""
    by_log: dict[Path | None, list[InSet]] = {}
    for one in in_set:
        by_log.setdefault(one.log.path, []).append(one)
    rows = [(log, _short(remarks_of(log, by_log.get(log.path, [])))) for log in logs]
    wrong = [log for log, said in rows if said]
    shown = rows if len(rows) <= LISTED else [(log, said) for log, said in rows if said]
    name = max([4, *(len(log.source.name) for log, _ in shown), *(len(one.source.name) for one in refused)])
    lines = [f"{'file':{name}}  {'samples':>9}  {'s':>10}  {'Hz':>9}  remarks"]
    for log, said in shown:
        rate = log.samples / log.duration
        lines.append(f"{log.source.name:{name}}  {log.samples:9d}  {log.duration:10.3f}  {rate:9.5g}  {said or '-'}")
    lines += [f"{one.source.name:{name}}  {'not read':>9}: {one.text.removeprefix(f'{one.source}: ')}" for one in refused]
    if len(shown) < len(rows):
        lines.append(f"and {counted(len(rows) - len(shown), 'file')} without a remark")
    samples, seconds = sum(log.samples for log in logs), sum(log.duration for log in logs)
    left = f", {len(refused)} not read" if refused else ""
    total = f"{counted(len(logs) + len(refused), 'file')}: {len(logs)} read, {len(wrong)} of them with remarks{left}"
    return [*lines, f"{total}; {counted(samples, 'sample')}, {seconds:.6g} s"]


def _short(remarks: Sequence[dict[str, str]]) -> str:
    """Return remarks as kinds with their fields: ``spikes position_m, gaps voltage_v position_m``."""
    kinds: dict[str, dict[str, None]] = {}
    for one in remarks:
        kinds.setdefault(one["kind"], {})[one["field"]] = None
    return ", ".join(" ".join([kind, *(field for field in fields if field)]) for kind, fields in kinds.items())
