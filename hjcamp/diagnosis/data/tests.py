"""Measured tests of one plant as arrays in SI units: readings, given inputs, conditions, and the noise of each sensor."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.feedthrough import may_be_late, passed_to
from hjcamp.diagnosis.data.measured_test import MeasuredTest
from hjcamp.diagnosis.data.repetitions import apart_by_course
from hjcamp.diagnosis.data.saturation import ends_of, within
from hjcamp.diagnosis.data.sensor_noise import noise_of, without_passed
from hjcamp.errors import UsageError
from hjcamp.model.declare.parameter import finite_number
from hjcamp.model.declare.plant import ALWAYS, Plant
from hjcamp.model.language.field_unit import field_of, unit_of_field
from hjcamp.model.run.inputs_along import with_rates
from hjcamp.records.find import refuse_mixed_plants
from hjcamp.records.log import TestLog
from hjcamp.records.noise import step_of
from hjcamp.records.of_plant import plant_of
from hjcamp.records.sets.copies import counted_once
from hjcamp.records.sets.incomplete import complete_logs

Array = NDArray[np.float64]
RATE_TOLERANCE = 1e-3
ROUNDED = 0.01
FEWEST_SAMPLES = 64
# A held input may act so many samples later than its log says.
MOST_DELAY = 2


@dataclass(frozen=True)
class Sensor:
    """A measured channel: its field, the unit of its field, and the value in that unit of one SI unit."""

    field: str
    unit: str
    scale: float

    @property
    def quantity(self) -> str:
        """The name without its unit."""
        return self.field[: -len(unit_of_field(self.field, "").suffix) - 1]


@dataclass(frozen=True)
class Measured:
    """All tests of one plant, ``period`` s between samples; tests of one condition and one course are repetitions.

    ``twice`` names each test that was left out, and the one that it is a copy of: it would pass for a repetition without scatter.
    ``odd`` says which logs differ from their repetitions by more than these do from each other: nothing is concluded with them.
    ``short`` names each log that was left out for its few samples, and their number, ``missing`` each that was for a field it lacks.
    """

    plant: type[Plant]
    period: float
    sensors: tuple[Sensor, ...]
    columns: tuple[int, ...]
    tests: tuple[MeasuredTest, ...]
    twice: tuple[tuple[str, str], ...] = ()
    short: tuple[tuple[str, int], ...] = ()
    odd: tuple[str, ...] = ()
    missing: tuple[tuple[str, str], ...] = ()

    @cached_property
    def conditions(self) -> dict[str, list[int]]:
        """Positions of the tests of each condition."""
        found: dict[str, list[int]] = {}
        for place, test in enumerate(self.tests):
            found.setdefault(test.condition, []).append(place)
        return found

    def of(self, places: Sequence[int]) -> Measured:
        """Return some of the tests, at their positions; noise and ends of the sensors are those of all."""
        return self.with_tests([self.tests[place] for place in places])

    def with_tests(self, tests: Sequence[MeasuredTest]) -> Measured:
        """Return other tests of the same plant; noise and ends of the sensors are those of these, whatever the others tell."""
        found = Measured(self.plant, self.period, self.sensors, self.columns, tuple(tests))
        # they are put where they are kept
        vars(found).update(noise=self.noise, ends=self.ends)
        return found

    @property
    def repeated(self) -> bool:
        """Whether any condition has more than one repetition."""
        return any(len(places) > 1 for places in self.conditions.values())

    @cached_property
    def noise(self) -> Array:
        """Standard deviation of the noise of each sensor (sensors,), SI: see `noise_of`, the median of the tests."""
        found = [
            [self._noise_in(test, k, step) for k, step in enumerate(steps)]
            for test, steps in zip(self.tests, self._counted, strict=True)
        ]
        declared = [self.plant.measured[one.field].noise for one in self.sensors]
        median = np.median(np.array(found), axis=0)
        return np.array([read if said is None else said for read, said in zip(median, declared, strict=True)])

    def _noise_in(self, test: MeasuredTest, k: int, step: float) -> float:
        """Return the noise of a sensor in a test: no more than it has in addition to what inputs pass on to it at once."""
        readings = within(test.readings[:, k], *self.ends[k])
        read = noise_of(readings, step)
        passed = [j for j in passed_to(self.plant, self.sensors[k].field) if np.ptp(test.inputs[:, j]) > 0.0]
        if not passed or len(readings) != test.samples:
            return read
        return min(read, noise_of(without_passed(readings, test.inputs[:, passed], MOST_DELAY), step))

    @cached_property
    def _counted(self) -> list[list[float]]:
        """The step of each sensor in each test, SI: as declared, else as the readings have it; 0 where none counts."""
        declared = [self.plant.measured[one.field].counts for one in self.sensors]
        return [[said or step_of(test.readings[:, k]) for k, said in enumerate(declared)] for test in self.tests]

    @cached_property
    def steps(self) -> Array:
        """The step of each sensor (sensors,), SI, as most tests have it; 0 where none counts."""
        return np.asarray(np.median(np.array(self._counted), axis=0))

    @cached_property
    def ends(self) -> Array:
        """The lowest and the highest value that each sensor shows (sensors, 2), SI; infinite where no test reaches an end."""
        count = len(self.sensors)
        found = [ends_of([one.readings[:, k] for one in self.tests], float(self.steps[k]), count) for k in range(count)]
        return np.array(found)

    @cached_property
    def still(self) -> dict[str, float]:
        """The recorded inputs, by field, that keep one value in all tests, SI: nothing can be identified of how these act."""
        places = enumerate(_inputs_of(self.plant).values())
        recorded = {field: k for k, field in places if all(field in one.log.command_phase for one in self.tests)}
        found = {
            field: np.concatenate([part[:, k] for one in self.tests for part in (one.earlier, one.inputs) if len(part)])
            for field, k in recorded.items()
        }
        return {field: float(values[0]) for field, values in found.items() if np.ptp(values) == 0.0}

    def shown(self, true: Array) -> Array:
        """Return simulated readings (n, sensors), SI, as the sensors would show them: none beyond their ends."""
        return np.clip(true, *self.ends.T)


def measured_tests(
    logs: Sequence[TestLog],
    twice: tuple[tuple[str, str], ...] = (),
    odd: tuple[str, ...] = (),
    missing: tuple[tuple[str, str], ...] = (),
    plant: type[Plant] | None = None,
) -> Measured:
    """Return the tests of all logs that are long enough; refuse logs of several plants or periods, and one that lacks a reading.

    ``twice``, ``odd`` and ``missing`` are what is known of the logs as a set already, as in `Measured`; ``plant`` is as what they are
    taken, that of their metadata unless given.
    """
    if not logs:
        raise UsageError("no tests: give a run folder, a folder of logs, or log files")
    refuse_mixed_plants(logs)
    logs, short = _long_enough(logs)
    plant = plant or plant_of(logs[0].metadata, str(logs[0].path))
    period = logs[0].period
    for log in logs:
        if abs(log.period / period - 1.0) > RATE_TOLERANCE:
            longer = max(log.period, period)
            # as round as rows that are hardly uneven allow
            common = next(
                own for own in (float(f"{longer:.{digits}g}") for digits in (2, 3, 6)) if abs(own / longer - 1.0) < ROUNDED
            )
            raise UsageError(
                f"{log.path}: one sample each {log.period:g} s, but each {period:g} s in {logs[0].path}; "
                f"analyse tests of one sampling period together, or import them with resample_s: {common:g} in the map"
            )
    logs, lacking = complete_logs(logs)
    missing = (*missing, *((_where(one.log), one.field) for one in lacking if one.left_out))
    # effects have their times in samples of the logs, whatever the plant's file says of its own
    if abs(period / plant.period - 1.0) > RATE_TOLERANCE:
        plant = plant.sampled(period)
    present = [name for name in plant.measured if all(name in log.columns for log in logs)]
    if not present:
        raise UsageError(f"{logs[0].path}: none of the channels of plant {plant.name}: {', '.join(plant.measured)}")
    units = [unit_of_field(name, f"plant {plant.name}") for name in present]
    sensors = tuple(Sensor(name, unit.shown, unit.scale) for name, unit in zip(present, units, strict=True))
    columns = tuple(list(plant.measured).index(name) for name in present)
    if not twice:
        logs, found = counted_once(logs)
        twice = tuple((_where(one.log), _where(one.original)) for one in found)
    tests = [_test(log, plant, sensors) for log in logs]
    return Measured(plant, period, sensors, columns, apart_by_course(tests), twice, short, odd, missing)


def _long_enough(logs: Sequence[TestLog]) -> tuple[Sequence[TestLog], tuple[tuple[str, int], ...]]:
    """Return the logs with samples enough, and the name and the samples of each other one; refuse logs that are all too short."""
    counts = [len(log.command_phase["time_s"]) for log in logs]
    most = max(range(len(logs)), key=counts.__getitem__)
    if counts[most] < FEWEST_SAMPLES:
        several = f" in one of the {len(logs)} logs" if len(logs) > 1 else ""
        raise UsageError(f"{_where(logs[most])}: {counts[most]} samples; at least {FEWEST_SAMPLES} are needed{several}")
    short = tuple((_where(log), count) for log, count in zip(logs, counts, strict=True) if count < FEWEST_SAMPLES)
    return [log for log, count in zip(logs, counts, strict=True) if count >= FEWEST_SAMPLES], short


def _where(log: TestLog) -> str:
    return str(log.path or log.condition_key)


def _test(log: TestLog, plant: type[Plant], sensors: Sequence[Sensor]) -> MeasuredTest:
    columns = log.command_phase
    where = _where(log)
    samples = len(columns["time_s"])
    readings = np.column_stack([columns[one.field] / one.scale for one in sensors])
    inputs = []
    for name, channel in _inputs_of(plant).items():
        item = plant.inputs[name]
        if channel in columns:
            inputs.append(columns[channel] / unit_of_field(channel, where).scale)
        elif channel and item.required:
            raise UsageError(f"{where}: field '{channel}' is missing, the input '{name}' of plant {plant.name}")
        else:
            inputs.append(np.full(samples, item.default))
    whole = np.column_stack([readings, *inputs])
    if not np.all(np.isfinite(whole)):
        row = int(np.argmin(np.all(np.isfinite(whole), axis=1)))
        raise UsageError(f"{where}: sample {row} (at {columns['time_s'][row]:g} s) is not finite; see hjcamp log verify")
    name = log.path.stem if log.path else log.condition_key
    given = with_rates(plant, np.column_stack(inputs), log.period)
    # What a late input does in the first samples was given before the log, which does not say it: a step may be its first sample.
    lead = MOST_DELAY if may_be_late(plant) else 0
    time = columns["time_s"] - columns["time_s"][0]
    return MeasuredTest(
        name,
        log.condition_key,
        time[lead:],
        given[lead:],
        readings[lead:],
        _given(plant, log.metadata, where),
        log,
        given[:lead],
    )


def _inputs_of(plant: type[Plant]) -> dict[str, str]:
    """Return the field of each input that a log may hold, in the order of the plant; empty where none can."""
    return {
        item.name: item.field
        or ("" if item.name in ALWAYS or item.rate_of else field_of(item.name, item.unit, f"plant {plant.name}"))
        for item in plant.inputs.values()
        if item.name not in ("time", "direction")
    }


def _given(plant: type[Plant], metadata: Mapping[str, str], where: str) -> tuple[tuple[str, float], ...]:
    """Return the parameters of the plant that a test's metadata give, SI."""
    found = list(plant.told_by(metadata).items())
    for name, item in plant.parameters.items():
        if item.given and item.given in metadata:
            try:
                number = finite_number(float(metadata[item.given]))
            except ValueError:
                number = None
            if number is None:
                raise UsageError(f"{where}: its metadata give {item.given} = {metadata[item.given]!r:.40}; a number is needed")
            found.append((name, number / unit_of_field(item.given, where).scale))
    return tuple(found)
