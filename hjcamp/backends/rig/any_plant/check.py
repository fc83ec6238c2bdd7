"""The check of a rig of any plant before a campaign moves it: its channels at rest, then a small push of each input."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.backends.plant_simulation import apart, model_of, plant_in, start_of
from hjcamp.backends.rig import check_stamp
from hjcamp.backends.rig.any_plant.driver import DriverFailed, not_written
from hjcamp.backends.rig.any_plant.limits import PlantLimits
from hjcamp.backends.rig.any_plant.loop import Clock
from hjcamp.backends.rig.any_plant.session import Session, decisive, open_session, rig_in, stamp_path, wiring_of
from hjcamp.backends.rig.lock import hold
from hjcamp.backends.rig.stop import while_moving
from hjcamp.errors import RigStopped
from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.course import Given
from hjcamp.model.run.simulator import Simulator
from hjcamp.rigs.fit import Wire
from hjcamp.storage import check_place

Array = NDArray[np.float64]
REST_S, MOST_SAMPLES = 0.5, 500
#: A reading has answered a push where it moved by so many standard deviations of its noise at rest.
SEEN = 5.0


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at."""

    name: str
    passed: bool
    text: str


@dataclass
class Look:
    """Samples on an open rig, under its limits; ``asked`` returns why to stop now, or None."""

    session: Session
    period: float
    asked: Callable[[], str | None]

    def __post_init__(self) -> None:
        wiring, rig = self.session.wiring, self.session.driver.rig
        self._clock = Clock(self.session.driver, self.period)
        self._limits = PlantLimits(rig, wiring, tracked=False)
        self._signs = [one.channel.sign for one in (*wiring.measured, *wiring.read)]

    def sample(self, put: list[float] | None = None) -> list[float]:
        """Return what is read next, in the channels' units, after which ``put`` is written; raises ``RigStopped`` at a limit."""
        driver, wiring = self.session.driver, self.session.wiring
        try:
            missed, read = self._clock.next()
            values = [read[place] * sign for place, sign in zip(wiring.order, self._signs, strict=True)]
            reason = self.asked() or self._limits.check(missed, values, None)
            if reason is None and put is not None:
                given, reason = self._limits.given_within(put)
                driver.write([one.channel.sign * value for one, value in zip(wiring.given, given, strict=True)])
        except DriverFailed as error:
            reason = str(error)
        if reason is not None:
            raise RigStopped(f"the rig was made safe during the check: {reason}")
        return values

    def course(self, seconds: float, put: list[float] | None = None) -> Array:
        """Return the readings (n, channels) of some time, all inputs as ``put``, else as they are."""
        count = min(max(round(seconds / self.period), 2), MOST_SAMPLES)
        return np.array([self.sample(put) for _ in range(count)])


def at_rest(session: Session, period: float, asked: Callable[[], str | None]) -> Finding:
    """Look at all channels with the outputs safe: within their ranges and limits; the noise is said."""
    rows = Look(session, period, asked).course(max(REST_S, 20 * period))
    wires = (*session.wiring.measured, *session.wiring.read)
    told = [f"{one.channel.name} {value:.4g} {one.unit} (noise {noise:.2g})" for one, value, noise in _each(wires, rows)]
    return Finding("at rest", True, ", ".join(told))


def _each(wires: tuple[Wire, ...], rows: Array) -> Iterator[tuple[Wire, float, float]]:
    # the noise is that of neighbours: what drifts slowly is none
    noise = np.diff(rows, axis=0).std(axis=0) / np.sqrt(2.0)
    yield from zip(wires, rows.mean(axis=0).tolist(), noise.tolist(), strict=True)


def findings(look: Look, config: Mapping[str, Any], announce: Callable[[str], None]) -> Iterator[Finding]:
    """Yield what is found, in order; ``announce`` hears of each step before it moves anything."""
    announce("all channels at rest, nothing moves")
    yield at_rest(look.session, look.period, look.asked)
    wiring = look.session.wiring
    for place, wire in enumerate(wiring.given):
        channel = wire.channel
        if channel.nudge == 0.0:
            yield Finding(channel.name, True, "not moved: its channel has no nudge=..., so its sign is as it is said to be")
            continue
        announce(f"{channel.name} at {channel.nudge:g} {wire.unit} for {channel.nudge_s:g} s")
        yield _pushed(look, config, place)


def _pushed(look: Look, config: Mapping[str, Any], place: int) -> Finding:
    """Push one input and compare the direction in which each reading goes with the plant's own."""
    wiring = look.session.wiring
    wire = wiring.given[place]
    safe = [one.channel.safe for one in wiring.given]
    put = [wire.channel.nudge if i == place else value for i, value in enumerate(safe)]
    before = look.course(max(20 * look.period, 0.05), safe)
    during = look.course(wire.channel.nudge_s, put)
    look.sample(safe)
    count = len(wiring.measured)
    moved = during[-max(len(during) // 10, 1) :].mean(axis=0) - before.mean(axis=0)
    noise = np.diff(before, axis=0).std(axis=0) / np.sqrt(2.0)
    ours = expected(config, look, place, len(during))
    told, wrong = [], []
    for one, got, away, quiet in zip(wiring.measured, moved[:count], ours, noise[:count], strict=True):
        limit = max(SEEN * quiet, 0.02 * abs(away))
        told.append(f"{one.channel.name} {got:+.3g} {one.unit} (model {away:+.3g})")
        if abs(away) > limit and abs(got) > limit and got * away < 0.0:
            wrong.append(f"{one.channel.name} goes the wrong way: the sign of it or of {wire.channel.name} is wrong")
        elif abs(away) > 4.0 * limit and abs(got) <= limit:
            wrong.append(f"{one.channel.name} does not follow: not wired, or the drive is off")
    return Finding(wire.channel.name, not wrong, "; ".join([", ".join(told), *wrong]))


def expected(config: Mapping[str, Any], look: Look, place: int, samples: int) -> Array:
    """Return by how much the model moves each reading, in the channels' units, under the push of one input."""
    plant, wiring = plant_in(config), look.session.wiring
    effects, values = model_of(config, plant)
    simulator = Simulator(Composition(plant, tuple(effects)), free=True)
    inputs = np.tile(simulator.inputs(), (2 * samples, 1))
    for i, one in enumerate(wiring.given):
        column = simulator.composition.inputs.index(one.name)
        inputs[:, column] = one.si(one.channel.safe)
        if i == place:
            inputs[samples:, column] = one.si(one.channel.nudge)
    start = start_of(config, plant, {})
    begins = np.zeros(len(inputs), dtype=np.int64)
    begins[[0, samples]] = 1
    starts = np.tile([start[name] for name in plant.states], (2, 1))
    time_s = np.tile(np.arange(samples) * plant.period, 2)
    readings, _ = simulator.run_free(simulator.vector(apart(values)[0]), Given(plant.period, begins, time_s, inputs, starts))
    away = readings[-1] - readings[samples - 1]
    return np.asarray([value * abs(one.scale) for value, one in zip(away, wiring.measured, strict=True)])


def check_rig(
    config: Mapping[str, Any],
    say: Callable[[Finding], None],
    before: Callable[[], None] = lambda: None,
    announce: Callable[[str], None] = lambda words: None,
    seed: int = 1,
) -> bool:
    """Check the rig of a resolved configuration; ``say`` hears each finding. Returns whether all passed.

    ``before`` is called last before the outputs are taken, ``announce`` before each step. Raises ``RigStopped`` at a limit.
    """
    rig = rig_in(config)
    wiring = wiring_of(rig, config)
    # What passes must be kept: that there is no place for it is said before anything moves.
    check_place(stamp_path(rig))
    if rig.real:
        hold(rig.identity())
    before()
    period, found = plant_in(config).period, []
    with while_moving() as signals, open_session(rig, wiring, seed, signals) as session:
        for finding in findings(Look(session, period, lambda: signals.reason), config, announce):
            found.append(finding)
            say(finding)
            if not finding.passed:
                break
        facts = session.facts
    if session.problem is not None:
        raise RigStopped(not_written(session.driver, session.problem))
    passed = all(one.passed for one in found)
    if passed:
        # the stamp is of the rig as its file says it, not of what the device told once it was open
        check_stamp.write(
            stamp_path(rig), {"devices": facts, **{one.name: one.text for one in found}}, decisive(rig_in(config))
        )
    return passed
