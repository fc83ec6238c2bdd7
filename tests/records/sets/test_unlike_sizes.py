"""One log of a set whose input or reading is in another unit than in all others, or whose input is dead, without any repetition."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from wrong_logs import carriage_set

from hjcamp.records.log import TestLog
from hjcamp.records.sets.look import look_at

PLANT = '''"""Two pumps fill a tank."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, sensor, store


class TwoIn(Plant):
    """Two pumps."""

    volume = State("m^3", typical=0.01)
    pump = Input("V")
    valve = Input("V")
    area = Parameter("1/s", 0.2, (0.01, 2.0), "log-uniform", base=True)
    gain = Parameter("m^3/s/V", 1e-3, (1e-5, 1e-1), "log-uniform", base=True)
    period = 0.01
    volume_l = Measured("level", of="volume")
    loop = "foreign"

    @staticmethod
    def equations(state, parameter, two_in, rate):
        rate.volume = parameter.gain * (two_in.pump + two_in.valve) - parameter.area * state.volume
        level = sensor(state.volume)
'''


def in_conditions(logs: list[TestLog]) -> list[TestLog]:
    """Return logs as single tests of conditions of their own."""
    return [replace(log, metadata={**log.metadata, "condition": f"test_{k}"}) for k, log in enumerate(logs)]


def scaled(log: TestLog, field: str, times: float) -> TestLog:
    return replace(log, columns={**log.columns, field: log.columns[field] * times})


@pytest.fixture
def carriages(empty_folder: Path) -> list[TestLog]:
    return in_conditions(carriage_set(empty_folder))


def of_sizes(logs: list[TestLog]) -> list[str]:
    return [one.line for one in look_at(logs) if not one.missing]


@pytest.mark.parametrize(
    ("field", "times", "said"),
    [
        ("voltage_v", 1e3, "it is 1000 times too large, as mV read as V or V as kV would be"),
        ("voltage_v", 1e-3, "it is 1000 times too small, as kV read as V or V as mV would be"),
        ("position_m", 1e3, "it is 1000 times too large, as mm read as m"),
        ("position_m", 1e2, "it is 100 times too large, as cm read as m would be"),
        ("position_m", 39.37, "it is 39.37 times too large, as in read as m would be"),
        ("current_a", 1e3, "it is 1000 times too large, as mA read as A"),
    ],
)
@pytest.mark.parametrize("at", [0, 4, 8])
def test_one_recording_in_another_unit_is_named(carriages: list[TestLog], field: str, times: float, said: str, at: int) -> None:
    logs = [scaled(log, field, times) if k == at else log for k, log in enumerate(carriages)]
    (line,) = of_sizes(logs)
    assert line.startswith(f"{logs[at].path}: warning: '{field}'") and said in line, line


def test_a_small_or_a_large_test_is_sound(carriages: list[TestLog]) -> None:
    # what is commanded and what is measured are as much smaller
    for times in (1e-3, 1e3):
        small = carriages[0]
        for field in ("voltage_v", "position_m", "current_a"):
            small = scaled(small, field, times)
        assert of_sizes([small, *carriages[1:]]) == []
    assert of_sizes(carriages) == [] and of_sizes(carriages[:3]) == []


def test_the_noise_of_an_input_that_nothing_drives_is_no_unit(carriages: list[TestLog]) -> None:
    log = carriages[0]
    idle = 1e-3 * np.random.default_rng(1).standard_normal(log.samples)
    assert of_sizes([replace(log, columns={**log.columns, "voltage_v": idle}), *carriages[1:]]) == []


def two_in(seed: int, pump: float = 1.0, valve: float = 1.0, dead: str = "") -> TestLog:
    generator = np.random.default_rng(seed)
    time = 0.01 * np.arange(3000)
    given = {
        "pump_v": pump * (2.0 + np.sin(0.7 * time + generator.uniform(0, 6))),
        "valve_v": valve * (2.0 + np.sin(0.4 * time + generator.uniform(0, 6))),
    }
    volume, level = 0.0, np.empty(len(time))
    for k in range(len(time)):
        level[k] = volume
        volume += 0.01 * (1e-3 * (given["pump_v"][k] + given["valve_v"][k]) - 0.2 * volume)
    columns = {"time_s": time, **given, "volume_l": 1e3 * level + 1e-3 * generator.standard_normal(len(time))}
    if dead:
        columns[dead] = np.full(len(time), columns[dead][0])
    return TestLog(
        columns, {"plant": "two_in", "period_s": "0.01", "condition": f"test_{seed}"}, path=Path(f"test_{seed}.mcap")
    )


@pytest.mark.parametrize("dead", ["pump_v", "valve_v"])
def test_one_dead_input_among_live_ones_is_named(empty_folder: Path, dead: str) -> None:
    (empty_folder / "plants").mkdir()
    (empty_folder / "plants" / "two_in.py").write_text(PLANT, encoding="utf-8")
    sound = [two_in(seed) for seed in range(1, 6)]
    assert of_sizes(sound) == []
    (line,) = of_sizes([*sound, two_in(6, dead=dead)])
    assert line.startswith(
        f"test_6.mcap: warning: '{dead}' keeps one value in all 3000 samples, although it changes in the 5 logs"
    )
    # inputs that are driven one at a time are no fault
    one_at_a_time = [two_in(10, valve=0.0), two_in(11, valve=0.0), two_in(12, pump=0.0), two_in(13, pump=0.0), two_in(14)]
    assert of_sizes(one_at_a_time) == []
