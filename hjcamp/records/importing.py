"""Measurements from elsewhere, as a table of text, become test logs."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from hjcamp.errors import UsageError, unknown
from hjcamp.records.check import check_finite, check_phase
from hjcamp.records.import_map import HIGHEST_SAMPLING_HZ, LOWEST_SAMPLING_HZ, ImportMap, read_import_map
from hjcamp.records.log import COMMAND_PHASE, SAMPLE_S, TestLog
from hjcamp.records.plausible import refuse_implausible
from hjcamp.records.write import write_log
from hjcamp.storage import check_is_file

LONGEST_STEP = 1.5  # of the usual one
RATE_TOLERANCE = 0.01


def import_csv(file: str | Path, mapping: str | Path, out: str | Path) -> TestLog:
    """Write the table ``file`` as the test log ``out`` by the YAML file ``mapping``, and return the log.

    A column becomes a field as ``sign * (scale * column + offset)`` in ``unit``; the log has one sample each
    1 ms, linearly interpolated (the phase is held). Time 0 is the first sample of phase 3, or the first of all
    where no phase is mapped. An example, of which only the fields that every log needs are necessary::

        separator: ";"          # also: decimal_comma, skip_lines (before the header), comment
        sampling_hz: 2000       # not needed where time_s is mapped
        fields:
          time_s: {column: t, unit: ms}
          arm_deg: {column: theta, unit: rad, sign: -1}
          pressure1_mpa: {column: P1, unit: bar, offset: -1.013}
          pressure2_mpa: {column: P2_volt, unit: bar, scale: 2.5, offset: -1.25}
          pump_deg: {column: piston, unit: mm}
        metadata: {condition: ramp_bench, trajectory: ramp_pos, controller: pid, pump: pump2}

    Raises UsageError for a table or a mapping that is unusable, for values that the fields cannot have, and where ``out`` exists.
    """
    source, target = Path(file), Path(out)
    if target.exists():
        raise UsageError(f"{target}: exists already; give the imported log another name")
    rules = read_import_map(Path(mapping))
    columns = resample(_fields(source, rules), rules.sampling_hz, str(source))
    check_phase(columns, str(source))
    log = TestLog(columns, rules.metadata, {"import.yaml": Path(mapping).read_bytes()}, target)
    refuse_implausible(log, f"{source} by {mapping}")
    write_log(target, log)
    return log


def resample(columns: dict[str, np.ndarray], sampling_hz: float | None, where: str) -> dict[str, np.ndarray]:
    """Return columns of shape (samples,) at 1 kHz, of columns of shape (rows,) at any steady rate from 200 Hz.

    Raises UsageError where the time has gaps, does not increase, or disagrees with ``sampling_hz`` by over 1 %.
    """
    rows = len(next(iter(columns.values())))
    if rows < 2:
        raise UsageError(f"{where}: {rows} rows are no test")
    time = columns["time_s"] if "time_s" in columns else np.arange(rows) / (sampling_hz or 1 / SAMPLE_S)
    usual = _usual_step(time, where)
    if sampling_hz is not None and abs(usual * sampling_hz - 1) > RATE_TOLERANCE:
        raise UsageError(f"{where}: the time column has {1 / usual:.5g} rows a second, sampling_hz is {sampling_hz:g}")
    phase = columns.get("phase")
    zero = time[0]
    if phase is not None:
        if not (phase == COMMAND_PHASE).any():
            raise UsageError(f"{where}: no row of the command phase (phase 3)")
        zero = time[int(np.argmax(phase == COMMAND_PHASE))]
    tolerance = 1e-6  # of a sample: what rounding may cost at either end
    first = int(np.ceil((time[0] - zero) / SAMPLE_S - tolerance))
    last = int(np.floor((time[-1] - zero) / SAMPLE_S + tolerance))
    grid = np.arange(first, last + 1) * SAMPLE_S
    resampled = {"time_s": grid}
    for name, values in columns.items():
        if name == "phase":
            held = np.searchsorted(time - zero, grid + tolerance * SAMPLE_S, side="right") - 1
            resampled[name] = values[np.clip(held, 0, rows - 1)]
        elif name != "time_s":
            resampled[name] = np.interp(grid, time - zero, values)
    return resampled


def _usual_step(time: np.ndarray, where: str) -> float:
    steps = np.diff(time)
    if (steps <= 0).any():
        row = int(np.argmax(steps <= 0)) + 1
        raise UsageError(
            f"{where}: time does not increase at row {row + 1}: {time[row - 1]:.6g} s, then {time[row]:.6g} s"
        )
    usual = float(np.median(steps))
    if 1 / usual < LOWEST_SAMPLING_HZ * (1 - RATE_TOLERANCE):
        raise UsageError(
            f"{where}: {1 / usual:.4g} rows a second; below {LOWEST_SAMPLING_HZ:g} Hz too little is left of a test "
            "(is the unit of time_s right?)"
        )
    if 1 / usual > HIGHEST_SAMPLING_HZ:
        raise UsageError(
            f"{where}: {1 / usual:.4g} rows a second, the whole table is {time[-1] - time[0]:.4g} s; no logger is faster than "
            f"{HIGHEST_SAMPLING_HZ:g} Hz (is the unit of time_s right? s read as ms are 1000 times too short)"
        )
    if (steps > LONGEST_STEP * usual).any():
        row = int(np.argmax(steps > LONGEST_STEP * usual))
        raise UsageError(f"{where}: gap of {steps[row] * 1e3:.4g} ms after row {row + 1} (time {time[row]:.6g} s)")
    return usual


def _fields(source: Path, rules: ImportMap) -> dict[str, np.ndarray]:
    """Return the mapped columns of the table in the units of their fields."""
    import polars

    check_is_file(source)
    try:
        table = polars.read_csv(
            source,
            separator=rules.separator,
            decimal_comma=rules.decimal_comma,
            skip_lines=rules.skip_lines,
            comment_prefix=rules.comment,
            encoding="utf8-lossy",
            infer_schema=False,
        )
    except OSError as error:
        raise UsageError(f"{source}: cannot be read: {error.strerror or error}") from error
    except polars.exceptions.PolarsError as error:
        reason = str(error).strip().splitlines()[0] if str(error).strip() else "it is no table"
        raise UsageError(f"{source}: cannot be read as a table: {reason}") from error
    table = table.rename({name: name.strip() for name in table.columns}) if _strippable(table.columns) else table
    fields: dict[str, np.ndarray] = {}
    for name, rule in rules.rules.items():
        if rule.column not in table.columns:
            raise unknown("column", rule.column, table.columns, str(source))
        text = table[rule.column].str.strip_chars()
        if rules.decimal_comma:
            text = text.str.replace(",", ".", literal=True)
        numbers = text.cast(polars.Float64, strict=False)
        if numbers.null_count():
            row = int(numbers.is_null().arg_max() or 0)
            raise UsageError(f"{source}: '{rule.column}' is no number in row {row + 1}: {text[row]!r}")
        values = numbers.to_numpy()
        fields[name] = rule.sign * (rule.scale * values + rule.offset) * rule.factor
    check_finite(fields, str(source))
    return fields


def _strippable(names: list[str]) -> bool:
    return len({name.strip() for name in names}) == len(names)
