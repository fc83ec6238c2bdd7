"""What measured tests can decide before any verdict: what is wrong with them, and the smallest effects that they would show."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hjcamp.analyses.data import Data, Report, silent
from hjcamp.errors import UsageError, counted

if TYPE_CHECKING:
    from hjcamp.diagnosis.calibration.analysis import Analysis
    from hjcamp.diagnosis.data.tests import Measured
    from hjcamp.records.log import TestLog
    from hjcamp.records.plausible import Finding

#: Of the usual step between samples: steps that scatter by more are those of an uneven clock.
UNEVEN = 0.02
#: Steps of a sensor over the range that a test covers; fewer hide what is smaller than a step.
FEWEST_STEPS = 50.0
#: Of the samples: more of them at a sensor's end hide the motion.
AT_END = 0.01
#: Of the power of an input beyond its mean: a line with less of it excites nothing.
LINE, FEWEST_LINES = 0.01, 3
#: Half of the 95 % interval over the value: above it the value is not known even to its size.
UNKNOWN = 1.0
#: At which an effect counts as shown: of one wrong in twenty over the whole library, with four true ones in five found.
LEVEL, POWER = 0.05, 0.8


@dataclass(frozen=True)
class Remark:
    """One thing that is wrong: the ``check``, what was found, and what follows for the verdict."""

    check: str
    text: str
    consequence: str


@dataclass(frozen=True)
class Smallest:
    """The smallest ``amplitude`` (SI) of an effect that the tests would show, next to the ``usual`` one; NaN where they show none."""

    effect: str
    parameter: str
    amplitude: float
    usual: float
    unit: str


@dataclass(frozen=True)
class Readiness:
    """What is to be said of the ``tests`` before a diagnosis (their number, 0 where none can be read)."""

    remarks: tuple[Remark, ...]
    smallest: tuple[Smallest, ...]
    tests: int = 0

    @property
    def ready(self) -> bool:
        """Whether nothing is to be said against a verdict."""
        return not self.remarks

    def content(self, plant: str) -> dict[str, Any]:
        """Return the answer for programs; an amplitude that the tests do not show is null."""
        rows = [asdict(one) | {"amplitude": one.amplitude if math.isfinite(one.amplitude) else None} for one in self.smallest]
        remarks = [asdict(one) for one in self.remarks]
        return {
            "schema": "hjcamp.ready/1",
            "plant": plant,
            "tests": self.tests,
            "ready": self.ready,
            "remarks": remarks,
            "smallest": rows,
        }


def readiness(data: Data, report: Report = silent) -> Readiness:
    r"""Return what is wrong with tests, and what they would show of each effect of the library.

    An amplitude a counts as shown where :math:`a \lVert r_\perp \rVert \ge z_{1 - \alpha / 2n} + z_{0.8}`: r is the response of all
    windows to an amplitude of 1 in units of the error of the calibrated base, without what its parameters could explain, n the
    number of effects. Valid while effects act in proportion to their amplitude. Raises UsageError where there is no log.
    """
    remarks: list[Remark] = []
    try:
        remarks += [one for log in data.logs for one in of_log(log)]
        measured = data.measured
    except UsageError as refusal:
        return Readiness((*remarks, Remark("data", str(refusal), "no analysis takes these logs")), ())
    remarks += [*of_set(data.logs), *of_tests(measured)]
    analysis = _calibrated(measured, report)
    if isinstance(analysis, Remark):
        return Readiness((*remarks, analysis), (), len(measured.tests))
    return Readiness((*remarks, *of_parameters(analysis)), tuple(smallest(analysis)), len(measured.tests))


def of_log(log: TestLog) -> Iterator[Remark]:
    """Yield what is wrong with the clock and the columns of one log."""
    from hjcamp.records.plausible import findings

    steps = np.diff(log.columns["time_s"])
    usual = float(np.median(steps)) if len(steps) else 0.0
    if usual and float(np.std(steps)) > UNEVEN * usual:
        spread = float(np.std(steps)) / usual
        yield Remark(
            "clock", f"{log.path}: steps between samples scatter by {spread:.1%}", "rates and delays are wrong by as much"
        )
    for one in findings(log):
        yield Remark("columns", f"{log.path}: {one.text}", "it passes for a motion that the model misses")


def at_ends(log: TestLog) -> Iterator[Finding]:
    """Yield the sensors of one log that stay at their end, as `of_tests` says it of all."""
    from hjcamp.diagnosis.data.saturation import ends_of
    from hjcamp.records.noise import step_of
    from hjcamp.records.of_plant import plant_of
    from hjcamp.records.plausible import Finding, watched_columns

    watched = [one.name for one in watched_columns(plant_of(log.metadata, str(log.path))) if one.name in log.columns]
    for name in watched:
        values = log.columns[name]
        low, high = ends_of([values], step_of(values), len(watched))
        share = float(np.mean((values <= low) | (values >= high)))
        if share > AT_END:
            text = f"'{name}' stays at its largest or smallest value in {share:.0%} of all samples: at rest, or at its sensor's end"
            yield Finding(name, text, False, kind="saturation")


def of_set(logs: Sequence[TestLog]) -> Iterator[Remark]:
    """Yield what logs say of each other: copies, one that differs from its repetitions, one that lacks a field."""
    from hjcamp.records.sets.look import look_at

    for one in look_at(logs):
        copied = one.original is not None
        follows = "a copy counts once: it shows no scatter" if copied else "nothing is concluded with a log that differs"
        yield Remark("copies" if copied else "set", f"{one.log.path}: {one.finding.text}", follows)


def of_tests(measured: Measured) -> Iterator[Remark]:
    """Yield what hides effects: ends and steps of sensors, no repetition, inputs that move little."""
    for k, sensor in enumerate(measured.sensors):
        readings = [test.readings[:, k] for test in measured.tests]
        low, high = measured.ends[k]
        share = float(np.mean(np.concatenate([(one <= low) | (one >= high) for one in readings])))
        if share > AT_END:
            text = f"'{sensor.field}' stays at its end in {share:.0%} of all samples"
            yield Remark("saturation", text, "what happens there is not seen; a saturation may be named for it")
        step, covered = float(measured.steps[k]), float(np.median([np.ptp(one) for one in readings]))
        if step > 0.0 and covered < FEWEST_STEPS * step:
            text = f"'{sensor.field}' covers {covered / step:.0f} of its steps in a test"
            yield Remark("quantisation", text, "an effect smaller than a step is not seen")
    if not measured.repeated:
        text = f"none of {counted(len(measured.tests), 'test')} is repeated"
        yield Remark("repetitions", text, "the repeatability is guessed from neighbours in time; repeat each condition")
    yield from _excitation(measured)


def _excitation(measured: Measured) -> Iterator[Remark]:
    for field in measured.still:
        yield Remark("excitation", f"the input '{field}' never moves", "nothing of how it acts can be identified")
    for name in measured.plant.given_inputs():
        columns = [test.inputs[:, list(measured.plant.inputs).index(name)] for test in measured.tests]
        if all(np.ptp(one) == 0.0 for one in columns):
            continue
        lines = len(set().union(*(_lines(one, measured.period) for one in columns)))
        if lines < FEWEST_LINES:
            text = f"the input '{name}' has {counted(lines, 'frequency', 'frequencies')} in all tests together"
            yield Remark(
                "excitation", text, f"{counted(2 * lines, 'parameter')} at most can be identified; add a chirp or a multisine"
            )


def _lines(values: np.ndarray, period: float) -> set[int]:
    """Return the frequencies that hold a share of the power of an input beyond its mean, in steps of a tenth of their size."""
    power = np.abs(np.fft.rfft((values - values.mean()) * np.hanning(len(values)))) ** 2
    power[:1] = 0.0
    peaks = np.flatnonzero((power > LINE * power.sum()) & (power >= np.roll(power, 1)) & (power > np.roll(power, -1)))
    return {round(10.0 * math.log(place / (len(values) * period))) for place in peaks if place}


def _calibrated(measured: Measured, report: Report) -> Analysis | Remark:
    """Return the base calibrated on the tests, or why it cannot be."""
    from hjcamp.diagnosis.calibration.analysis import calibrated
    from hjcamp.effects import load_effects

    report("compiling, once for this plant and its effects", 0.05)
    try:
        return calibrated(measured, load_effects(plant=measured.plant), report=report, unknowns=False)
    except UsageError as refusal:
        return Remark("base", str(refusal), "no effect is looked for before the base fits")


def of_parameters(analysis: Analysis) -> Iterator[Remark]:
    """Yield the base parameters that the tests do not identify."""
    from hjcamp.diagnosis.estimation.intervals import intervals

    names = set(analysis.measured.plant.base_parameters)
    for one in intervals(analysis.base.fitted, analysis.search.blocks):
        half = 0.5 * (one.high - one.low)
        if one.effect or one.name not in names or (one.told and half <= UNKNOWN * abs(one.value)) or one.at_bound:
            continue
        said = (
            "no reading depends on it alone"
            if not one.told
            else f"{one.value:.3g}, 95 % interval {one.low:.3g} to {one.high:.3g}"
        )
        text = f"parameter '{one.name}' is not identified: {said}"
        yield Remark("identifiability", text, "effects that act as it does cannot be distinguished from it")


def smallest(analysis: Analysis) -> Iterator[Smallest]:
    """Yield for each effect the smallest amplitude that the tests would show; the most visible of its usual shapes."""
    from scipy.special import ndtri

    from hjcamp.diagnosis.screening.screening import ProbedModel, Projection, probes_of
    from hjcamp.diagnosis.screening.settings import far_off

    fitted, library = analysis.base.fitted, analysis.search.library
    probed, projection = ProbedModel.of(analysis.windows, fitted), Projection(fitted)
    looked = [effect for effect in library.values() if effect.claimed and effect.name not in fitted.candidate.effects]
    needed = float(ndtri(1.0 - LEVEL / (2.0 * max(len(looked), 1))) + ndtri(POWER))
    for effect in looked:
        probe = next(probes_of(analysis.windows, probed, effect, {}), None)
        item = effect.parameters[probe.amplitudes[0]] if probe else None
        if probe is None or item is None or far_off(item):
            continue
        shown = float(np.linalg.norm(projection.free_of_base(probe.responses)[:, 0]))
        size = abs(float(probe.sizes[0])) * needed / shown if shown > 0.0 else math.nan
        usual = abs(item.default - (item.off or 0.0))
        yield Smallest(effect.name, item.name, size, usual, item.unit)
