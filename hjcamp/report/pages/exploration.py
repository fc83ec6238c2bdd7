"""What the explorer of a page shows: channels of tests, measured and modelled, condensed to 16 bits for each point."""

from __future__ import annotations

import base64
import zlib
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import UsageError, counted
from hjcamp.report.wording.channels import described
from hjcamp.report.wording.names import readable
from hjcamp.report.wording.units import unit_for

if TYPE_CHECKING:
    from hjcamp.records.log import TestLog

Array = NDArray[np.float64]
Channels = Mapping[str, Array]
#: Points of a page, all curves together, and the fewest and most of one curve.
ROOM, FEWEST, MOST = 1_500_000, 150, 1500
#: 0 stands for a value that is not there.
STEPS = 2**16 - 2
MEASURED = -1
NOT_CHANNELS = ("time_s", "phase")
REFERENCE = "reference"


class Exploration:
    """Tests, added one after the other; of each only its points for the page are kept.

    A channel is a name that ends with its unit (``position_mm``), whatever the plant. ``tests`` is how many will be added,
    ``models`` their models in order, ``hidden`` those that are off at first, ``noise_floors`` those of the channels in their units,
    ``observed`` what readings are called.
    """

    def __init__(
        self,
        tests: int,
        models: Sequence[str],
        noise_floors: Mapping[str, float | None] | None = None,
        hidden: Sequence[str] = (),
        observed: str = "measured",
    ) -> None:
        self._observed = observed
        self._expected = tests
        self._models = list(models)
        self._hidden = list(hidden)
        self._noise_floors = dict(noise_floors or {})
        self._channels: dict[str, dict[str, Any]] = {}
        # from the unit of the name to that of tables
        self._factors: dict[str, float] = {}
        self._tests: list[dict[str, Any]] = []
        self._stretch = 0
        self._curves: list[bytes] = []
        self._points = 0

    @property
    def tests(self) -> int:
        """How many tests were added."""
        return len(self._tests)

    def add(
        self,
        name: str,
        condition: str,
        time: Array,
        measured: Channels,
        models: Mapping[str, Channels] | None = None,
        errors: Mapping[str, Mapping[str, float]] | None = None,
    ) -> None:
        """Add one test: ``time`` (n,) at equal distances in s, each channel (n,), ``models`` by name, NaN where one says nothing.

        ``errors`` are those of each model by channel, in its unit; the root mean square of the difference where none are given.
        Raises ``UsageError`` for a channel of another length and for one without a unit.
        """
        given = models or {}
        if not len(time):
            return
        every = [(MEASURED, measured), *[(self._models.index(one), given[one]) for one in given]]
        for _, channels in every:
            for channel, values in channels.items():
                if len(values) != len(time):
                    raise UsageError(f"{name}: channel {channel} has {counted(len(values), 'value')}, time has {len(time)}")
        curves = sum(len(channels) for _, channels in every)
        if not self._stretch:
            room = min(max(ROOM // (max(curves, 1) * self._expected), FEWEST), MOST)
            self._stretch = max(1, -(-len(time) // room))
        step = (time[-1] - time[0]) / max(len(time) - 1, 1)
        entry: dict[str, Any] = {"name": name, "label": readable(name), "condition": condition}
        entry["points"] = -(-len(time) // self._stretch)
        entry["start"] = float(time[0] + step * (self._stretch - 1) / 2)
        entry["step"] = float(step * self._stretch)
        entry["curves"] = [
            self._packed(model, channel, values, name) for model, channels in every for channel, values in channels.items()
        ]
        told = errors or {}
        found = [_finite(told[one]) if one in told else _errors(measured, given.get(one, {})) for one in self._models]
        entry["rms"] = [{channel: error * self._factors.get(channel, 1.0) for channel, error in one.items()} for one in found]
        self._tests.append(entry)

    def add_log(self, name: str, log: TestLog) -> None:
        """Add what a log measured, and as the model ``reference`` what was wanted."""
        columns = {one: values for one, values in log.command_phase.items() if one not in NOT_CHANNELS}
        wanted = references(columns)
        measured = {one: values for one, values in columns.items() if not one.startswith("reference_")}
        self.add(name, log.condition_key, log.command_phase["time_s"], measured, {REFERENCE: wanted} if wanted else {})

    def head(self) -> dict[str, Any]:
        """Return everything but the points: channels, models, noise floors, tests with their curves and errors."""
        return {
            "channels": list(self._channels.values()),
            "models": self._models,
            "observed": self._observed,
            "hidden": self._hidden,
            "floors": {
                name: noise_floor * self._factors.get(name, 1.0)
                for name, noise_floor in self._noise_floors.items()
                if noise_floor
            },
            "tests": self._tests,
            "averaged": self._stretch,
        }

    def points(self) -> str:
        """Return the points of all curves: differences of unsigned 16-bit numbers, deflated, in base 64."""
        return base64.b64encode(zlib.compress(b"".join(self._curves), 9)).decode()

    def _packed(self, model: int, channel: str, values: Array, where: str) -> dict[str, Any]:
        if channel not in self._channels:
            self._channels[channel] = described(channel, where)
            most = float(np.nanmax(np.abs(values))) if np.isfinite(values).any() else 0.0
            name, self._factors[channel] = unit_for(most, self._channels[channel]["unit"] or "1")
            self._channels[channel]["unit"] = name
        means = _means(np.asarray(values, dtype=np.float64), self._stretch)
        there = np.isfinite(means)
        low = float(means[there].min()) if there.any() else 0.0
        span = (float(means[there].max()) - low if there.any() else 0.0) or 1.0
        steps = np.zeros(len(means), dtype=np.uint16)
        steps[there] = np.round((means[there] - low) / span * STEPS).astype(np.uint16) + 1
        self._curves.append(np.diff(steps, prepend=np.uint16(0)).astype("<u2").tobytes())
        place, self._points = self._points, self._points + len(steps)
        factor = self._factors[channel]
        return {"model": model, "channel": channel, "at": place, "low": low * factor, "per": span / STEPS * factor}


def references(columns: Channels) -> dict[str, Array]:
    """Return what is wanted of each measured channel: ``reference_CHANNEL``, or ``reference_UNIT`` for the first of that unit."""
    wanted: dict[str, Array] = {}
    for name, values in columns.items():
        if not name.startswith("reference_"):
            continue
        rest = name.removeprefix("reference_")
        ends = [one for one in columns if one.endswith(f"_{rest}") and not one.startswith("reference_")]
        channel = rest if rest in columns else next(iter(ends), None)
        if channel:
            wanted[channel] = values
    return wanted


def _errors(measured: Channels, modelled: Channels) -> dict[str, float]:
    found = {}
    for channel in modelled:
        if channel in measured:
            square = (modelled[channel] - measured[channel]) ** 2
            if np.isfinite(square).any():
                found[channel] = float(np.sqrt(np.nanmean(square)))
    return found


def _finite(errors: Mapping[str, float]) -> dict[str, float]:
    return {channel: value for channel, value in errors.items() if np.isfinite(value)}


def _means(values: Array, size: int) -> Array:
    short = -len(values) % size
    filled = np.concatenate([values, np.full(short, values[-1])]) if short else values
    means: Array = filled.reshape(-1, size).mean(axis=1)
    return means


def names_of(logs: Sequence[TestLog]) -> list[str]:
    """Return "CONDITION/REPETITION" of each log, with a number where two would have the same."""
    seen: dict[str, int] = {}
    names = []
    for log in logs:
        repetition = log.metadata.get("repetition") or (log.path.stem if log.path else "")
        name = f"{log.condition_key}/{repetition}" if repetition else log.condition_key
        seen[name] = seen.get(name, 0) + 1
        names.append(name if seen[name] == 1 else f"{name} ({seen[name]})")
    return names
