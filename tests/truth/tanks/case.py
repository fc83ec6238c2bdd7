"""A hidden case on the two tanks: one long log and one held out, or five conditions with three repetitions each."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.signal import lfilter

from truth.case_files import MeasuredLog, rough, write_case_files
from truth.hidden_form import Form, find_form, level_of
from truth.tanks.hidden import FORMS
from truth.tanks.plant import PERIOD, Tanks, run

ONE_LOG, HELD_OUT, TEST = 800, 500, 180  # samples
CONDITIONS = ("fill", "drain", "steps", "sine", "high")
FIELDS = {"time_s": "t_s", "level_v": "level_volt", "pump_v": "pump_volt", "upper_v": "upper_volt"}
GAUGE_EFFECTS = ("sensor_offset", "sensor_gain", "sensor_lag", "sensor_drift")
SOURCE = '''"""Two tanks, the upper one runs out into the lower one; a pump fills the upper one."""

from __future__ import annotations

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, path, sensor, sqrt, store


class Tanks(Plant):
    r"""Outlets by Torricelli's law; levels in volts of the gauges.

    .. math:: \\dot h_u = k_4 u - k_1 \\sqrt{{h_u}}, \\quad \\dot h_l = {ratio_text}k_1 \\sqrt{{h_u}} - k_3 \\sqrt{{h_l}}
    """

    upper = State("V", typical=5.0, low=0.0{start})
    lower = State("V", typical=5.0, low=0.0)

    pump = Input("V", typical=3.0, text="voltage of the pump")

    k1 = Parameter("V**0.5/s", {k1:g}, (1e-4, 1.0), "log-uniform", base=True, text="outlet of the upper tank")
    k3 = Parameter("V**0.5/s", {k3:g}, (1e-4, 1.0), "log-uniform", base=True, text="outlet of the lower tank")
    k4 = Parameter("1/s", {k4:g}, (1e-4, 1.0), "log-uniform", base=True, text="flow of the pump for one volt")
{parameters}
    level_v = Measured("gauge", of="lower")
{measured}
    @staticmethod
    def equations(state, parameter, drive, rate):
        """What flows in less what flows out, for each tank."""
        inflow = actuator(parameter.k4 * drive.pump)
        between = path(parameter.k1 * sqrt(state.upper), upstream=state.upper, downstream=state.lower)
        outflow = path(parameter.k3 * sqrt(state.lower), upstream=state.lower)
        rate.upper = store(inflow - between)
        rate.lower = store({ratio}between - outflow)
        gauge = sensor(state.lower)
{sensors}'''


@dataclass(frozen=True)
class TanksCase:
    """Two tanks with what hides in them; `observed` where the upper level is measured too."""

    tanks: Tanks
    plain: Tanks
    form: Form[Tanks]
    seed: int
    observed: bool


def draw_tanks(seed: int, observed: bool) -> Tanks:
    """Draw two tanks: a time constant of 1 - 2 minutes, levels up to 9 V for 4.4 V at the pump."""
    random = np.random.default_rng([seed, 401])
    between = float(random.uniform(0.035, 0.07))
    return Tanks(
        between=between,
        outflow=between * float(random.uniform(0.95, 1.2)),
        pump=between * 2 / 3 * float(random.uniform(0.85, 1.03)),
        ratio=float(random.uniform(0.85, 1.05)) if observed else 1.0,
        noise=float(random.uniform(0.008, 0.025)),
        count=10 / 2 ** int(random.choice([10, 12, 14])),
    )


def build_tanks_case(
    effect: str = "nothing",
    form: str | None = None,
    seed: int = 0,
    strength: str | float = "medium",
    observed: bool | None = None,
) -> TanksCase:
    """Draw two tanks and hide the effect in them; see `write_tanks_case`. Raises ValueError for what is not known."""
    level = level_of(strength)
    chosen = find_form(FORMS, effect, form, seed)
    if observed is None:
        observed = bool(np.random.default_rng([seed, 403]).random() < 0.5)
    if observed:
        chosen = replace(chosen, names=tuple(map(_at_gauge, chosen.names)), similar=tuple(map(_at_gauge, chosen.similar)))
    tanks = draw_tanks(seed, observed)
    changes = chosen.build(tanks, level, np.random.default_rng([seed, 409]))
    return TanksCase(tanks._replace(**changes), tanks, chosen, seed, observed)


def _at_gauge(name: str) -> str:
    return f"{name}_at_gauge" if name in GAUGE_EFFECTS else name


def pump_course(name: str, samples: int, random: np.random.Generator) -> np.ndarray:
    """Return the pump's voltage (V) of a log or a condition: levels held for one to five minutes, a sine, or both."""
    ranges = {"fill": (3.4, 4.4), "drain": (0.2, 1.6), "high": (3.8, 4.4)}
    low, high = ranges.get(name, (0.6, 4.4))
    if name == "sine":
        time = np.arange(samples) * PERIOD
        return np.round(2.6 + 1.5 * np.sin(2 * np.pi * time / float(random.uniform(220, 320))), 3)
    parts: list[np.ndarray] = []
    while sum(part.size for part in parts) < samples:
        length = int(random.integers(15, 110) if name in ("train", "held_out") else random.integers(12, 45))
        part = np.full(length, float(random.uniform(low, high)))
        if random.random() < 0.4:
            part += 0.4 * np.sign(np.sin(np.arange(length) * 2 * np.pi / 10))
        parts.append(part)
    return np.round(np.clip(np.concatenate(parts)[:samples], 0.0, 4.6), 3)


def simulate_tanks(tanks: Tanks, seed: int, log: str, repetition: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return time (n,), pump voltage (n,) and rows (n, 4) of `tanks.run` in one log: "train", "held_out", a condition."""
    known = ("train", "held_out", *CONDITIONS)
    random = np.random.default_rng([seed, 405, known.index(log)])
    samples = {"train": ONE_LOG, "held_out": HELD_OUT}.get(log, TEST)
    pump = pump_course(log, samples, random)
    usual = {"fill": 1.0, "drain": 7.0}.get(log, 4.0)
    chance = np.random.default_rng([seed, 407, known.index(log), repetition])
    start = usual * float(random.uniform(0.7, 1.2)), usual * float(random.uniform(0.7, 1.2))
    start = (start[0] + 0.1 * float(chance.normal()), start[1] + 0.1 * float(chance.normal()))
    memory = np.exp(-PERIOD / 60.0)
    flow = lfilter([1.0], [1.0, -memory], chance.normal(0, 0.008 * np.sqrt(1 - memory**2), samples))
    flow += chance.normal(0, 0.004)
    rows = run(tanks, pump, start, chance.normal(size=(samples, 2)), flow)
    return np.arange(samples) * PERIOD, pump, rows


def write_tanks_case(
    folder: Path | str,
    effect: str = "nothing",
    form: str | None = None,
    seed: int = 0,
    one_log: bool = True,
    *,
    strength: str | float = "medium",
    observed: bool | None = None,
) -> Path:
    """Write a hidden case on two tanks into `folder` and return the path of its sealed answer, `truth.json`.

    As `write_axis_case`, with one sample each 4 s: `measured/train.csv` (800 samples), or five conditions with three
    repetitions of 180 samples; `heldout/held_out.csv` (500). Starts differ from log to log and are not told.
    `observed` says whether the upper level is measured too (drawn by the seed where None).
    """
    case = build_tanks_case(effect, form, seed, strength, observed)
    plan = [("train", 0)] if one_log else [(name, k) for name in CONDITIONS for k in range(3)]
    fields = dict(list(FIELDS.items())[: 4 if case.observed else 3])
    logs, seen = [], []
    for name, repetition in [*plan, ("held_out", 0)]:
        time, pump, rows = simulate_tanks(case.tanks, seed, name, repetition)
        columns = dict(zip(fields.values(), (time, rows[:, 0], pump, rows[:, 1]), strict=False))
        metadata = {"condition": name}
        if not one_log:
            metadata["repetition"] = str(repetition + 1)
        file = name if one_log or name == "held_out" else f"{name}_{repetition + 1}"
        logs.append(MeasuredLog(file, columns, metadata, name == "held_out"))
        if name != "held_out" and repetition == 0:
            plain, again = (simulate_tanks(case.plain, seed, name, k)[2][:, 0] for k in (0, 99))
            seen.append((np.mean((rows[:, 0] - plain) ** 2), np.mean((again - plain) ** 2)))
    change, scatter = np.sqrt(np.mean(seen, axis=0))
    tanks = case.plain
    base = {
        "k1": tanks.between,
        "k3": tanks.outflow,
        "k4": tanks.pump,
        **({"ratio": tanks.ratio} if case.observed else {}),
    }
    answer = {
        "plant": "tanks",
        **case.form.answer(),
        "strength": strength,
        "observed": case.observed,
        "one_log": one_log,
        "seed": seed,
        "changes": {k: v for k, v in case.tanks._asdict().items() if v != getattr(tanks, k)},
        "base": base,
        "seen": {"change_v": float(change), "scatter_v": float(scatter)},
    }
    return write_case_files(folder, "tanks", plant_source(case), fields, logs, answer)


def plant_source(case: TanksCase) -> str:
    """Return the file that a user of these tanks would write: guesses of one digit; an upper level unseen is unknown."""
    random = np.random.default_rng([case.seed, 411])
    tanks = case.plain
    guesses = {name: rough(value, random) for name, value in (("k1", tanks.between), ("k3", tanks.outflow), ("k4", tanks.pump))}
    if not case.observed:
        return SOURCE.format(
            start=', start="unknown"', ratio="", ratio_text="", parameters="", measured="", sensors="", **guesses
        )
    ratio = '    ratio = Parameter("1", 1.0, (0.05, 20.0), "log-uniform", base=True, text="area of the upper over the lower tank")\n'
    return SOURCE.format(
        start="",
        ratio="parameter.ratio * ",
        ratio_text="a ",
        parameters=ratio,
        measured='    upper_v = Measured("upper_gauge", of="upper")\n',
        sensors="        upper_gauge = sensor(state.upper)\n",
        **guesses,
    )
