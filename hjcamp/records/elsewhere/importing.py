"""Measurements from elsewhere become test logs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from hjcamp.errors import UsageError, counted
from hjcamp.known_plants import DEFAULT
from hjcamp.model.declare.parameter import Parameter, State
from hjcamp.model.language.field_unit import unit_of_field
from hjcamp.records.check import check_finite, check_phase
from hjcamp.records.elsewhere.clock import (
    RATE_TOLERANCE,
    falls_back,
    last_of_each_time,
    lost_rows,
    refuse_slow,
    resample,
    steady_period,
    uneven_words,
    usual_step,
)
from hjcamp.records.elsewhere.import_map import ColumnRule, ImportMap, read_import_map
from hjcamp.records.elsewhere.map_values import GAPS_HINT, HIGHEST_SAMPLING_HZ
from hjcamp.records.elsewhere.tables import read_table
from hjcamp.records.glitch_words import told_spikes
from hjcamp.records.glitches import spikes
from hjcamp.records.log import TestLog
from hjcamp.records.of_plant import PERIOD_KEY, PLANT_KEY, USUAL_PERIOD_S
from hjcamp.records.plausible import Finding, refuse_implausible, watched_columns, without_small_tests
from hjcamp.records.read import read_log
from hjcamp.records.write import check_samples, write_log


@dataclass(frozen=True)
class Imported:
    """A log that an import wrote from a ``source``: how much it holds (duration in s), and what in it is doubtful.

    ``constant``: the columns that keep one value.
    """

    source: Path
    path: Path
    samples: int
    duration: float
    fields: tuple[str, ...]
    metadata: dict[str, str]
    doubtful: list[Finding]
    constant: tuple[str, ...] = ()


@dataclass(frozen=True)
class Refused:
    """A file that no log could be made of, and why."""

    source: Path
    text: str


def import_file(file: str | Path, mapping: str | Path, out: str | Path) -> TestLog:
    """Write ``file`` as the test log ``out`` by the YAML file ``mapping``, and return the log; see ``import_files``."""
    import_files([file], mapping, [out])
    return read_log(out)


def import_files(
    files: Sequence[str | Path],
    mapping: str | Path,
    outs: Sequence[str | Path],
    refused: list[Refused] | None = None,
    report: Callable[[str, float], None] = lambda text, share: None,
    look: Callable[[TestLog], Iterable[Finding]] = lambda log: (),
) -> list[Imported]:
    """Write each of ``files`` as the test log of ``outs`` by the YAML file ``mapping``, and return what was written.

    A column becomes a field as ``sign * (scale * column + offset)`` in ``unit``. The end of a file's name says what it
    is (``readers``): ``.mat`` (a column is a variable: ``q``, ``data.q``, ``q(:,2)``, ``rec.Y(2).Data``), ``.parquet``, ``.npz`` and
    ``.h5`` (``q[:,1]``), ``.tdms`` of a ``group``, workbooks with a ``sheet``, ``.mcap`` and ``.db3`` (a column is a name in the
    messages on ``topic``: ``q``, ``pose.x``, ``position[0]``), anything else is a table of text::

        plant: axis             # the usual one where it is absent; its fields: hjcamp plants axis
        skip_lines: 2           # before the header; also: comment, and separator, header, decimal_comma where the file misleads
        period_s: 0.001         # or sampling_hz; neither is needed where time_s is mapped
        gaps: interpolate       # cells without a value, single lost rows; refused where it is absent
        missing: [-9999]        # what stands for no reading, as it is in the file
        spikes: interpolate     # readings that jump out and back; kept, and told, where it is absent
        fields:
          time_s: {column: t, unit: ms}
          position_m: {column: x, unit: mm, sign: -1, offset: 12.5}
          voltage_v: {column: u_raw, scale: 2.5}    # also: unwrap, after how much a counter begins again; topic
        metadata: {condition: "{file}", mass_kg: 95}      # {file}: the name of the file without its ending
        files:                  # metadata of single files, where they differ; then every file is named
          train.csv: {condition: train}
          pulses.csv: {condition: pulses, mass_kg: 120}

    A log has one sample each period: that of the map, else the mean one of the rows; rows that jitter are interpolated
    (an input that holds its value, and the phase, keep the value before). Logs of the usual plant have one each 1 ms.
    Time 0 is the first row of phase 3, or the first of all. Nothing is written where one of the files cannot be,
    unless ``refused`` is a list, which takes these. One file is in memory at a time; ``look`` says more of its log.

    Raises UsageError for a file or a mapping that is unusable, for values that the fields cannot have, and where one of
    ``outs`` exists or stands for two files.
    """
    pairs = [(Path(file), Path(out)) for file, out in zip(files, outs, strict=True)]
    _check_targets(pairs)
    rules = read_import_map(Path(mapping))
    written: list[Imported] = []
    try:
        for number, (source, target) in enumerate(pairs):
            report(f"reading {source.name}", number / len(pairs))
            try:
                written.append(_import(source, target, rules, Path(mapping), look))
            except UsageError as fault:
                if refused is None:
                    raise
                refused.append(Refused(source, str(fault)))
    except BaseException:
        for one in written:
            one.path.unlink(missing_ok=True)
        raise
    told = without_small_tests([one.doubtful for one in written])
    return [replace(one, doubtful=found) for one, found in zip(written, told, strict=True)]


def _check_targets(pairs: Sequence[tuple[Path, Path]]) -> None:
    """Raise UsageError where a log is there already, or would be that of two files."""
    taken: dict[Path, Path] = {}
    for source, target in pairs:
        if target.exists():
            raise UsageError(f"{target}: exists already; delete it, or give the imported log another name")
        if (other := taken.setdefault(target, source)) is not source:
            raise UsageError(f"{target}: would be the log of {other} and of {source}; import them one by one")


def _import(
    source: Path, target: Path, rules: ImportMap, mapping: Path, look: Callable[[TestLog], Iterable[Finding]]
) -> Imported:
    log, filled = _log(source, target, rules, mapping)
    doubtful = [*filled, *refuse_implausible(log, f"{source} by {mapping}"), *_counted_from_elsewhere(rules, log)]
    said = {one.field for one in doubtful}
    doubtful += [one for one in look(log) if one.field not in said]
    write_log(target, log)
    constant = tuple(name for name, values in log.columns.items() if name != "phase" and not np.ptp(values))
    return Imported(source, target, log.samples, log.duration, tuple(log.columns), log.metadata, doubtful, constant)


def _log(source: Path, target: Path, rules: ImportMap, mapping: Path) -> tuple[TestLog, list[Finding]]:
    where = str(source)
    metadata = rules.metadata_for(source)
    fields, times, filled = _fields(source, rules)
    rows = len(next(iter(fields.values())))
    if rows < 2:
        raise UsageError(f"{where}: {counted(rows, 'row is', 'rows are')} no test")
    if rules.period is not None and "time_s" not in fields:
        times = np.arange(rows) * rules.period
    elif times is not None:
        fields, times, repeated = last_of_each_time(fields, times, where)
        filled += [Finding("time_s", repeated, False, kind="clock")] if repeated else []
        falls_back(times, rules.rules.get("time_s", ColumnRule("")), where)
    if times is None:
        raise UsageError(f"{rules.where}: give period_s or sampling_hz, or map a column to time_s; {source} has no times")
    # a plant that declares a short period may have a faster logger
    most = max(HIGHEST_SAMPLING_HZ, 100.0 / rules.plant.period)
    usual = usual_step(times, where, most, rules.resample or 0.0, rules.interpolate)
    if rules.period is not None and abs(usual / rules.period - 1) > RATE_TOLERANCE:
        given = f"sampling_hz is {1 / rules.period:g}" if rules.by_rate else f"period_s is {rules.period:g}"
        raise UsageError(f"{where}: the time column has {1 / usual:.5g} rows a second, {given}")
    if rules.plant.name == DEFAULT:
        refuse_slow(usual, where)
        period, held = USUAL_PERIOD_S, []
    else:
        period, held = rules.resample or steady_period(times, rules.period), rules.held
        metadata |= {PLANT_KEY: rules.plant.name, PERIOD_KEY: repr(period)}
    check_samples(round(float(times[-1] - times[0]) / period) + 1, len({"time_s", *fields}), where)
    columns = resample(fields, times, period, held, where)
    if uneven := uneven_words(times, period):
        filled.append(Finding("time_s", uneven, False, kind="gaps" if lost_rows(times) is not None else "clock"))
    check_phase(columns, where)
    return TestLog(columns, metadata, {"import.yaml": mapping.read_bytes()}, target), filled


def _fields(source: Path, rules: ImportMap) -> tuple[dict[str, np.ndarray], np.ndarray | None, list[Finding]]:
    """Return the mapped columns in the units of their fields, in the order of the table, the rows' times, s, and what was filled."""
    table = read_table(source, rules)
    fields: dict[str, np.ndarray] = {}
    later = Counter(rule.key for rule in rules.rules.values())
    for name, rule in rules.rules.items():
        later[rule.key] -= 1  # a column goes with the last field that is made of it
        values = table.columns[rule.key] if later[rule.key] else table.columns.pop(rule.key)
        if rule.unwrap is not None:
            there = np.isfinite(values)
            values = values.copy()
            values[there] = np.unwrap(values[there], period=rule.unwrap)
        fields[name] = rule.field_of(values)
    times = fields.get("time_s", table.times)
    filled = [Finding("", note, False, kind="file") for note in table.notes]
    filled += _filled(fields, times, rules.held) if rules.interpolate else []
    check_finite(fields, str(source), _hint(fields, rules))
    if rules.without_spikes:
        filled += _without_spikes(fields, times, rules)
    return fields, times, filled


def _hint(fields: dict[str, np.ndarray], rules: ImportMap) -> str:
    """Return what to do about a value that is not there."""
    if not rules.interpolate:
        return f"; {GAPS_HINT}"
    return "; a row without its time is to be deleted" if np.isnan(fields.get("time_s", np.zeros(1))).any() else ""


def _without_spikes(fields: dict[str, np.ndarray], times: np.ndarray | None, rules: ImportMap) -> list[Finding]:
    """Draw a line between the neighbours of readings that jump out and back; say how many these are."""
    found = []
    for name in [one.name for one in watched_columns(rules.plant) if one.name in fields]:
        values = fields[name]
        places = spikes(values)
        if len(places):
            rows = np.arange(len(values)) * (rules.period or 1.0) if times is None else times
            text = told_spikes(name, places, values, rows, rules.table.field(name).unit)
            good = np.delete(np.arange(len(values)), places)
            fields[name] = np.interp(rows, rows[good], values[good])
            found.append(Finding(name, f"{text}; filled in", False, kind="spikes"))
    return found


def _counted_from_elsewhere(rules: ImportMap, log: TestLog) -> list[Finding]:
    """Say which columns a unit has shifted although all that the plant declares in it looks as if it were not shifted."""
    found = []
    for name, rule in rules.rules.items():
        if not rule.shift:
            continue
        scale = unit_of_field(name, rules.plant.name).scale
        shifted = float(np.median(np.abs(log.columns[name]))) / scale
        before = float(np.median(np.abs(log.columns[name] - rule.shift * rule.factor))) / scale
        items: list[State | Parameter] = [*rules.plant.states.values(), *rules.plant.parameters.values()]
        sizes = [abs(size) for one in items if one.unit == "K" and (size := _declared_size(one))]
        if before and shifted and sizes and all(abs(np.log(size / before)) < abs(np.log(size / shifted)) for size in sizes):
            text = (
                f"'{name}' is {shifted:.4g} K in the middle, as degrees are turned into kelvins; the plant is written for about "
                f"{np.median(sizes):.3g} K: where it counts from 0 degrees Celsius, map the column without a unit"
            )
            found.append(Finding(name, text, False, kind="unit"))
    return found


def _declared_size(item: State | Parameter) -> float:
    """Return what a state or parameter is declared to be about; 0 where nothing was."""
    return item.default if isinstance(item, Parameter) else item.typical if item.typical != 1.0 else 0.0


def _filled(fields: dict[str, np.ndarray], times: np.ndarray | None, held: list[str]) -> list[Finding]:
    """Fill what has no value, by a line between its neighbours or by the value before where a field holds that; say how much."""
    found = []
    for name, values in fields.items():
        there = ~np.isnan(values)
        if name == "time_s" or there.all() or not there.any():
            continue
        known = np.flatnonzero(there)
        if name in held:
            fields[name] = values[known[np.maximum(np.searchsorted(known, np.arange(len(values)), side="right") - 1, 0)]]
        else:
            rows = np.arange(len(values)) if times is None else times
            fields[name] = np.interp(rows, rows[known], values[known])
        longest = int(np.diff([-1, *known, len(values)]).max()) - 1
        lacking = f"{counted(len(values) - len(known), 'row')} of {len(values)}, at most {longest} in a row"
        found.append(Finding(name, f"'{name}' has no value in {lacking}; filled in", False, kind="gaps"))
    return found
