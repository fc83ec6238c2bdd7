"""What may be claimed of a model: whether it is better than another one, by what matters, and by more than scatter."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.candidates.equivalence import memory_end, times_remembered
from hjcamp.diagnosis.data.repeatability import Repeatability, unknown_repeatability
from hjcamp.diagnosis.estimation.gauss_newton import SETTLED
from hjcamp.diagnosis.estimation.intervals import intervals
from hjcamp.diagnosis.estimation.likelihood import size
from hjcamp.diagnosis.levels import LEVEL, MATTERS, SCATTER
from hjcamp.diagnosis.selection.fits import Fits
from hjcamp.diagnosis.selection.scored import Follows, Scored
from hjcamp.diagnosis.validation.blocks import advantages, critical, discrimination, ratio_t
from hjcamp.diagnosis.validation.kernel_regression import regression_of

Array = NDArray[np.float64]


def mean_squares(features: Array, sensors: int) -> Array:
    """Return the mean squares (sensors,) of features (windows, d)."""
    return np.asarray(np.mean(features**2, axis=0).reshape(sensors, -1).mean(axis=1))


@dataclass
class Claims(Fits):
    """Models that are held against each other; ``claims`` is the level of all that is claimed together.

    ``repeatability`` is that of the calibrated model; where there is none yet it counts as unknown.
    """

    claims: float = LEVEL
    repeatability: Repeatability | None = None

    def matters(self, model: Scored, before: Scored, level: float = LEVEL) -> bool:
        """Whether a model takes a share of the error that matters, does so block by block, and by what is shown."""
        return self.takes_a_share(model, before, level) and not self.of_no_memory(model, before)

    def takes_a_share(self, model: Scored, before: Scored, level: float = LEVEL) -> bool:
        """Whether a model takes a share of the error that matters, block by block, that every contact's scatter does not."""
        if not self.beats(model, before, level) or self.error_ratio(model, before) > 1.0 - MATTERS:
            return False
        return not self.only_scatter(model, before)

    def of_no_memory(self, model: Scored, before: Scored) -> bool:
        """Whether the time for which an effect remembers reaches an end of what it may be, or of what readings resolve.

        That it remembers is not shown then.
        """
        effects = (name for name in model.beyond(before) if name in self.library)
        times = {(name, key): ends for name in effects for key, ends in times_remembered(self.library[name]).items()}
        rows = intervals(model.fitted, self.blocks) if times else []
        remembered = ((one, times[one.effect, one.name]) for one in rows if (one.effect, one.name) in times)
        return any(memory_end((one.low, one.high), bounds, self.shortest_memory) for one, bounds in remembered)

    @property
    def shortest_memory(self) -> float:
        """The time that the smooth part of a window resolves, s: what is forgotten sooner follows the moment for all that it shows."""
        layout = self.windows.layout
        return float(layout.width / layout.basis.shape[1] * layout.measured.period)

    def only_scatter(self, model: Scored, before: Scored) -> bool:
        """Whether friction differs with place or time by no more than every contact's does: that is how friction is, no effect."""
        laws = [self.unknowns.get(name) or self.library[name] for name in model.beyond(before)]
        if not laws or not all(one.scatters for one in laws):
            return False
        kept, self.windows.place = self.windows.place, before.place
        usual = self.windows.features(before.fitted.candidate)
        found = self.windows.features(model.fitted.candidate)
        self.windows.place = kept
        return bool(np.linalg.norm(found - usual) <= np.linalg.norm(self.scatter(before)))

    def scatter(self, model: Scored) -> Array:
        """Return what friction that differs as much as every contact's does changes (windows, d)."""
        kept, self.windows.place = self.windows.place, model.place
        usual = self.windows.features(model.fitted.candidate)
        most = self.windows.features(model.fitted.candidate, friction=1.0 + SCATTER)
        self.windows.place = kept
        return np.asarray(most - usual)

    def error_ratio(self, model: Scored, before: Scored) -> float:
        """Return what a model leaves, blocks left out, of another's error above repeatability, where it takes most (`share_left`)."""
        return self.share_left(model.features, before.features)

    def share_left(self, one: Array, other: Array) -> float:
        """Return what features (windows, d) leave of others' rms above repeatability, in the sensor in which that is least.

        Without repetitions nobody knows it, and all of the rms counts (`Repeatability`).
        """
        known = self.repeatability or unknown_repeatability(len(self.windows.layout.measured.sensors))
        return float(np.min(known.left(self.squares(one), self.squares(other))))

    def squares(self, features: Array) -> Array:
        """Return the mean squares (sensors,) of features (windows, d), in units of the sensors' noise."""
        return mean_squares(features, len(self.windows.layout.measured.sensors))

    def ruled_out(self, rival: Scored, model: Scored) -> bool:
        """Whether a model beats a rival, and the rival errs more (rms, on held-out blocks) in some sensor.

        A rival that errs less in each loses by the scores alone: by windows whose starts it knows less well, such as those of a lag
        behind a sensor, which on a linear plant does the same as one of its drive.
        """
        sensors = len(self.windows.layout.measured.sensors)
        one, other = (mean_squares(each.features, sensors) for each in (rival, model))
        return self.beats(model, rival) and bool(np.any(one > other))

    def follows_motion(self, model: Scored) -> Follows:
        """Return how much of what a model leaves follows from the motion, by whatever law; nothing where none is shown to.

        It is shown where a regression predicts blocks left out better at the level of all claims, by a share that matters,
        and by more than friction that differs as every contact's does: on the motion as it was measured and as it is predicted.
        Readings have the noise that is left of a model, predictions that of their starts; what both tell is no noise.
        """
        measured = self._follows(model, self.windows.layout.readings)
        if not measured.share:
            return measured
        return min(measured, self._follows(model, self.predicted(model)), key=lambda one: one.share)

    def _follows(self, model: Scored, readings: Array) -> Follows:
        """Return how much of what a model leaves follows from the motion that readings (n, sensors) describe."""
        found = regression_of(self.windows.layout, model.features, self.blocks, readings)
        before, blocks = model.features[found.rows], self.blocks[found.rows]
        apart = discrimination(found.features, before, blocks)
        t, count = ratio_t(advantages(found.features, before, blocks), apart)
        left, nothing = self.share_left(found.features, before), Follows(0.0, 0.0)
        if t <= critical(count, self.claims) or left > 1.0 - MATTERS:
            return nothing
        if np.linalg.norm(before - found.features) <= np.linalg.norm(self.scatter(model)[found.rows]):
            return nothing
        return Follows(1.0 - left, max(math.log(size(before) / size(found.features)), 0.0))

    def predicted(self, model: Scored) -> Array:
        """Return what a model predicts of all readings (n, sensors), from its own starts."""
        kept, self.windows.place = self.windows.place, model.place
        found = self.windows.readings(model.fitted.candidate)[0]
        self.windows.place = kept
        return np.where(np.isfinite(found), found, self.windows.layout.readings)

    def beats(self, model: Scored, other: Scored, level: float = LEVEL) -> bool:
        """Whether a model is better on blocks that it does not know, at a level, and by more than a fit leaves to be gained.

        Two laws that do the same differ by where their fits ended, in each block by next to nothing.
        """
        if not math.isfinite(model.left_out) or not math.isfinite(other.left_out):
            return math.isfinite(model.left_out)
        t, blocks = self.t(model, other)
        return t > critical(blocks, level) and float(np.sum(advantages(model.features, other.features, self.blocks))) > SETTLED

    def t(self, model: Scored, other: Scored) -> tuple[float, float]:
        """Return Student's t of a model's advantage over another, and the number of blocks that it stands on."""
        found = advantages(model.features, other.features, self.blocks)
        return ratio_t(found, discrimination(model.fitted.features, other.fitted.features, self.blocks))
