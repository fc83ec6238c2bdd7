"""Sets of sound logs, of the joint and of another plant, and mistakes that make one log of a set wrong on purpose."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.tour.samples import sample_logs
from hjcamp.records.log import TestLog
from hjcamp.records.plausible import findings
from hjcamp.records.sets.look import look_at

Columns = dict[str, np.ndarray]
JOINT = ("triangle_slow", "mixed_pid", "sine_1hz_pid", "ramp_hold", "sine_0p5hz_mid")
PERIOD, SECONDS, COUNT, AMPERE = 2e-3, 6.0, 1e-5, 5e-3
CARRIAGE = '''"""A carriage on a guide, with the current of its motor."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, contact, outside, sensor


class Drive(Plant):
    """A motor against mass and friction."""

    position = State("m", typical=1.0)
    velocity = State("m/s", typical=0.3)
    voltage = Input("V", typical=5.0)
    wind = Input("N", required=False)
    gain = Parameter("N/V", 4.0)
    per_volt = Parameter("A/V", 0.5)
    mass = Parameter("kg", 2.0, (0.2, 20.0), "log-uniform", base=True)
    coulomb = Parameter("N", 1.0, (1e-3, 50.0), "log-uniform", base=True)
    viscous = Parameter("N s/m", 8.0, (1e-2, 500.0), "log-uniform", base=True)
    period = 0.002
    position_m = Measured("encoder", of="position")
    current_a = Measured("ammeter", required=False)
    loop = "foreign"

    @staticmethod
    def equations(state, parameter, drive, rate):
        force = actuator(parameter.gain * drive.voltage)
        load = outside("N")
        friction = contact(
            state.velocity, push=force + load, coulomb=parameter.coulomb, viscous=parameter.viscous, travel=state.position
        )
        rate.position = state.velocity
        rate.velocity = body(force + drive.wind - friction + load, mass=parameter.mass, load=load, position=state.position)
        encoder = sensor(state.position)
        ammeter = sensor(parameter.per_volt * drive.voltage)
'''


@dataclass(frozen=True)
class Wrong:
    """One mistake: what it is, and the set with it; ``unknowable`` says why no program could know, where none could."""

    name: str
    make: Callable[[list[TestLog]], list[TestLog]]
    unknowable: str = ""


def joint_set() -> list[TestLog]:
    """Return logs of the tour: five conditions of the joint with three repetitions each, those of a slow triangle first."""
    logs = sample_logs()
    return [replace(logs[f"{name}_r{k}"], path=Path(f"{name}_r{k}.mcap")) for name in JOINT for k in (1, 2, 3)]


def carriage_set(folder: Path) -> list[TestLog]:
    """Return nine logs of a carriage, three conditions with three repetitions each; its plant's file goes to ``folder``."""
    (folder / "plants").mkdir(exist_ok=True)
    (folder / "plants" / "drive.py").write_text(CARRIAGE, encoding="utf-8")
    return [carriage(kind, k + 1) for kind in ("swing", "steps", "sweep") for k in range(3)]


def carriage(kind: str, repetition: int) -> TestLog:
    """Return a test of a carriage: a voltage that is the same in every repetition, friction that is not quite."""
    generator = np.random.default_rng([repetition, *kind.encode()])
    time = np.arange(round(SECONDS / PERIOD)) * PERIOD
    voltage = {
        "swing": 3.0 * np.sin(2.0 * np.pi * 0.5 * time) + 1.5 * np.sin(2.0 * np.pi * 1.3 * time + 0.4),
        "steps": 4.0 * np.sign(np.sin(2.0 * np.pi * 0.75 * time + 1e-9)) * (0.6 + 0.4 * np.sin(0.7 * time)),
        "sweep": 4.0 * np.sin(2.0 * np.pi * (0.3 + 0.12 * time) * time),
    }[kind]
    coulomb, viscous = (
        1.0 * (1.0 + 0.03 * generator.standard_normal()),
        8.0 * (1.0 + 0.02 * generator.standard_normal()),
    )
    x = v = 0.0
    places = np.empty(len(time))
    for k, volt in enumerate(map(float, voltage)):
        places[k] = x
        push = 4.0 * volt - viscous * v
        if v != 0.0 or abs(push) > coulomb:
            after = v + PERIOD * (push - coulomb * (1.0 if (v or push) > 0.0 else -1.0)) / 2.0
            v = 0.0 if after * v < 0.0 else after
            x += PERIOD * v
    noise = generator.standard_normal((2, len(time)))
    columns = {
        "time_s": time,
        "position_m": np.round((places + 2e-5 * noise[0]) / COUNT) * COUNT,
        "current_a": 0.5 * voltage + 0.02 * noise[1],
        "voltage_v": voltage,
        "wind_n": np.zeros(len(time)),
    }
    metadata = {"plant": "drive", "period_s": str(PERIOD), "condition": kind, "repetition": str(repetition)}
    return TestLog(columns, metadata, path=Path(f"{kind}_r{repetition}.mcap"))


def said(logs: list[TestLog], wrong: set[Path]) -> list[str]:
    """Return the sentences that name one of the ``wrong`` logs, by itself or as one of a set, or refuse it."""
    lines = []
    for log in (log for log in logs if log.path in wrong):
        try:
            lines += [f"{log.path}: {one.line}" for one in findings(log)]
        except UsageError as refusal:
            lines.append(str(refusal))
    lines += [one.line for one in look_at(logs)]
    return [line for line in lines if any(str(path) in line for path in wrong)]


def changed(change: Callable[[Columns], object], at: int = 1) -> Callable[[list[TestLog]], list[TestLog]]:
    """Return what changes the columns of one log of a set."""

    def make(logs: list[TestLog]) -> list[TestLog]:
        columns = {name: values.copy() for name, values in logs[at].columns.items()}
        change(columns)
        return [*logs[:at], replace(logs[at], columns=columns), *logs[at + 1 :]]

    return make


def added(change: Callable[[Columns], object], at: int = 1, **metadata: str) -> Callable[[list[TestLog]], list[TestLog]]:
    """Return what puts a changed copy of one log beside a set."""

    def make(logs: list[TestLog]) -> list[TestLog]:
        columns = {name: values.copy() for name, values in logs[at].columns.items()}
        change(columns)
        path = Path(f"{Path(str(logs[at].path)).stem}_copied.mcap")
        return [*logs, replace(logs[at], columns=columns, metadata={**logs[at].metadata, **metadata}, path=path)]

    return make


def labelled(at: int = 1, **metadata: str) -> Callable[[list[TestLog]], list[TestLog]]:
    """Return what gives one log of a set other metadata."""
    return lambda logs: [*logs[:at], replace(logs[at], metadata={**logs[at].metadata, **metadata}), *logs[at + 1 :]]


def rows(keep: Callable[[int], slice | np.ndarray]) -> Callable[[Columns], object]:
    """Return what keeps some rows of all columns, the time going on from 0."""

    def change(columns: Columns) -> None:
        time = columns["time_s"]
        kept = keep(len(time))
        for name, values in columns.items():
            columns[name] = values[kept]
        columns["time_s"] = time[: len(columns["time_s"])]

    return change


def scaled(name: str, factor: float, offset: float = 0.0) -> Callable[[Columns], object]:
    """Return what changes a column by factor and offset."""
    return lambda columns: columns.update({name: factor * columns[name] + offset})


def exchanged(one: str, other: str) -> Callable[[Columns], object]:
    """Return what exchanges two columns."""
    return lambda columns: columns.update({one: columns[other], other: columns[one]})


def without(name: str) -> Callable[[Columns], object]:
    """Return what takes a column out."""
    return lambda columns: columns.pop(name)


def part(name: str, first: float, last: float, value: Callable[[np.ndarray], object]) -> Callable[[Columns], object]:
    """Return what puts a value into a column between two shares of its rows."""

    def change(columns: Columns) -> None:
        values = columns[name]
        a, b = round(first * len(values)), round(last * len(values))
        values[a:b] = value(values[a:b])

    return change


def backwards(columns: Columns) -> None:
    """Turn all columns but the time and the phase round."""
    for name, values in columns.items():
        if name not in ("time_s", "phase"):
            columns[name] = values[::-1]


def rounded(names: tuple[str, ...], step: float) -> Callable[[Columns], object]:
    """Return what prints columns with a coarser last digit."""
    return lambda columns: columns.update({name: np.round(columns[name] / step) * step for name in names})


def nudged(size: float) -> Callable[[Columns], object]:
    """Return what changes every reading by next to nothing."""

    def change(columns: Columns) -> None:
        generator = np.random.default_rng(0)
        for name, values in columns.items():
            if name not in ("time_s", "phase"):
                columns[name] = values + size * generator.standard_normal(len(values))

    return change


def nothing(columns: Columns) -> None:
    """Change nothing."""


def common(sensor: str, analog: str, drive: str, size: float, step: float, digits: dict[str, float]) -> list[Wrong]:
    """Return the mistakes that any plant's log may have: a counting ``sensor``, an ``analog`` one, a ``drive``."""
    coarse = tuple(digits)
    return [
        Wrong("copied under another name", added(nothing)),
        Wrong("copied as another repetition", added(nothing, repetition="9")),
        Wrong("copied into another condition", added(nothing, at=1, condition="other")),
        Wrong("copied, every reading changed by 1e-9", added(nudged(1e-9))),
        Wrong("copied without the first row", added(rows(lambda n: slice(1, None)))),
        Wrong("copied without the last tenth", added(rows(lambda n: slice(0, n - n // 10)))),
        Wrong("copied without the first fifth", added(rows(lambda n: slice(n // 5, None)))),
        Wrong(
            "copied with one digit less",
            added(lambda columns: [rounded((name,), digits[name])(columns) for name in coarse]),
        ),
        Wrong(f"sign of {sensor}", changed(scaled(sensor, -1.0))),
        Wrong(f"sign of {analog}", changed(scaled(analog, -1.0))),
        Wrong(f"{sensor} times 1000", changed(scaled(sensor, 1000.0))),
        Wrong(f"{sensor} by 1000", changed(scaled(sensor, 1e-3))),
        Wrong(f"{sensor} times 0.5", changed(scaled(sensor, 0.5))),
        Wrong(f"{analog} times 2", changed(scaled(analog, 2.0))),
        Wrong(f"{sensor} times 1.02", changed(scaled(sensor, 1.02)), "within what repetitions differ by"),
        Wrong(f"zero of {sensor} moved by its travel", changed(scaled(sensor, 1.0, size))),
        Wrong(f"zero of {sensor} moved by a count", changed(scaled(sensor, 1.0, step)), "repetitions begin as far apart"),
        Wrong("backwards in time", changed(backwards)),
        Wrong("begun a fifth of a test late", changed(rows(lambda n: slice(n // 5, None)))),
        Wrong("ended half way", changed(rows(lambda n: slice(0, n // 2))), "a shorter test is a test"),
        Wrong("every second row lost, the clock going on", changed(rows(lambda n: np.arange(0, n, 2)))),
        Wrong(f"{sensor} dead", changed(part(sensor, 0.0, 1.0, lambda v: 0.0))),
        Wrong(f"{analog} dead", changed(part(analog, 0.0, 1.0, lambda v: v[0]))),
        Wrong(f"{sensor} dead from half way", changed(part(sensor, 0.5, 1.0, lambda v: v[0]))),
        Wrong(f"{sensor} frozen for a fifth", changed(part(sensor, 0.4, 0.6, lambda v: v[0]))),
        Wrong(f"{analog} frozen for a fifth", changed(part(analog, 0.4, 0.6, lambda v: v[0]))),
        Wrong(
            f"{analog} with single readings of -9999",
            changed(lambda columns: columns[analog].__setitem__([50, 700, 1900], -9999.0)),
        ),
        Wrong(f"{drive} dead", changed(part(drive, 0.0, 1.0, lambda v: 0.0))),
        Wrong(
            "a condition's name on another test",
            labelled(1, condition="other"),
            "a single test of another condition may be so",
        ),
    ]


def joint_mistakes() -> list[Wrong]:
    """Return the mistakes that are tried on a log of the joint."""
    digits = {"arm_deg": 0.01, "pressure1_mpa": 1e-4, "pressure2_mpa": 1e-4, "pump_deg": 0.01}
    again = labelled(1, condition="sine_1hz_pid", repetition="4", trajectory="sine_1hz", controller="pid")
    return [
        *common("arm_deg", "pressure1_mpa", "command_deg", 60.0, 0.35, digits),
        Wrong("pressures exchanged", changed(exchanged("pressure1_mpa", "pressure2_mpa"))),
        Wrong("arm and pump exchanged", changed(exchanged("arm_deg", "pump_deg"))),
        Wrong("arm in rad", changed(scaled("arm_deg", np.pi / 180.0))),
        Wrong("pump in turns", changed(scaled("pump_deg", 1.0 / 360.0))),
        Wrong(
            "pressures in bar",
            changed(lambda columns: [scaled(name, 10.0)(columns) for name in ("pressure1_mpa", "pressure2_mpa")]),
        ),
        Wrong("a test of another condition under this name", again),
        Wrong("a hole in the command phase", changed(part("phase", 0.4, 0.45, lambda v: 2.0))),
        Wrong("two tests in one log", changed(part("phase", 0.5, 0.6, lambda v: 4.0))),
        Wrong("phases 3, 4, 3, 4, ...", changed(lambda columns: columns["phase"].__setitem__(slice(500, None, 2), 4.0))),
        Wrong("pump_deg missing", changed(without("pump_deg"))),
    ]


def carriage_mistakes() -> list[Wrong]:
    """Return the mistakes that are tried on a log of the carriage."""
    return [
        *common("position_m", "current_a", "voltage_v", 0.1, COUNT, {"position_m": 1e-4, "current_a": 1e-3}),
        Wrong("position and current exchanged", changed(exchanged("position_m", "current_a"))),
        Wrong("position in mm", changed(scaled("position_m", 1e3))),
        Wrong("a test of another condition under this name", labelled(1, condition="sweep")),
        Wrong("current missing", changed(without("current_a"))),
        Wrong("wind missing", changed(without("wind_n"))),
        Wrong("sign of the voltage", changed(scaled("voltage_v", -1.0))),
        Wrong(
            "position with a drift of its travel",
            changed(lambda c: c.update({"position_m": c["position_m"] + 0.1 * np.linspace(0, 1, len(c["time_s"]))})),
        ),
        Wrong(
            "position late by 0.1 s",
            changed(lambda c: c.update({"position_m": np.concatenate([np.zeros(50), c["position_m"][:-50]])})),
        ),
        Wrong(
            "current ends at half its size",
            changed(lambda c: c.update({"current_a": np.clip(c["current_a"], -0.7, 0.7)})),
        ),
        Wrong(
            "current with a hum of its own size",
            changed(lambda c: c.update({"current_a": c["current_a"] + np.sin(2.0 * np.pi * 50.0 * c["time_s"])})),
        ),
        Wrong(
            "two tests one after the other",
            changed(
                lambda c: (
                    [c.update({n: np.concatenate([v, v])}) for n, v in list(c.items()) if n != "time_s"]
                    and c.update({"time_s": np.arange(2 * len(c["time_s"])) * PERIOD})
                )
            ),
        ),
    ]
