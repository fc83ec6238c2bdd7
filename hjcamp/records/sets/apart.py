"""How far a column of a log is from its repetitions, and whether chance allows that."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hjcamp.records.sets.course import Array, Course

# By chance one set of logs in twenty has a log that is named.
LEVEL = 0.05
# Of what a column does (rms): logs that differ by less are repetitions, and commands one command.
MATTERS = 0.1
# Steps over this part of a test are looked at beside the readings themselves: what adds up over a test makes them scatter most.
PART = 50
# Squares in this ratio are nothing beside each other.
LEAST = 1e-12


@dataclass(frozen=True)
class Apart:
    """How far a column is from its repetitions: the ``ratio`` to what these differ by, and what chance ``allowed`` of it.

    ``outside``: it is farther from each repetition than these are from each other, by more than a tenth of what the column does.
    What a single repetition would differ by is not ``known``. ``turned`` is by how much the ratio falls by chance where two tests do
    not repeat at all and one is changed; ``spread`` the standard deviation that chance gives the logarithm of the ratio,
    ``whole`` the ratio of the readings themselves.
    """

    ratio: float
    allowed: float
    outside: bool
    known: bool
    turned: float
    spread: float
    whole: float = 0.0

    @property
    def far(self) -> bool:
        """Whether it is outside, and by more than chance allows."""
        return self.outside and self.known and self.ratio > self.allowed


def apart(name: str, columns: dict[str, Array], rest: Sequence[Course], level: float, skipped: int = 0) -> Apart:
    r"""Return how far a column (n,) is from its repetitions ``rest``, of which ``skipped`` samples lie before it.

    For the deviation d from the mean of the r repetitions, with the variance s² of these,

    .. math:: F = \frac{r}{r + 1} \frac{\overline{d^2}}{s^2}

    is beyond what chance exceeds with probability ``level``. Degrees of freedom are those of the spectra P of the deviations,
    :math:`(\sum P)^2 / \sum P^2` (Satterthwaite 1946, doi:10.2307/3002019). The same is asked of steps over a fiftieth of the test,
    and of its first fiftieth.
    """
    length = min(len(columns[name]), *(one.samples - skipped for one in rest))
    own = columns[name][:length]
    each = np.array([one.columns[name][skipped : skipped + length] for one in rest])
    least = max(one.smallest[name] for one in rest) ** 2 + 1e-300
    step, size = max(length // PART, 1), float(np.var(each))
    looks = [_apart(own, each, least, level, size)]
    if length > 2 * step:
        steps = each[:, step:] - each[:, :-step]
        looks.append(_apart(own[step:] - own[:-step], steps, 2.0 * least, level, float(np.var(steps))))
        looks.append(_apart(own[:step], each[:, :step], least, level, size))
    return replace(max(looks, key=lambda one: (one.outside, one.ratio / one.allowed)), whole=looks[0].ratio)


def _apart(own: Array, each: Array, least: float, level: float, moves: float) -> Apart:
    from scipy.special import fdtri

    deviation, count = own - each.mean(axis=0), len(each)
    size = count / (count + 1) * float(np.mean(deviation**2))
    least_freedom = freedom = _freedom(deviation)
    scatter = 0.0
    outside = size > MATTERS**2 * moves
    if count > 1:
        scatter = float(np.mean(np.var(each, axis=0, ddof=1)))
        # by chance a deviation is as those of the others, of which few say little: the fewest degrees of freedom are taken
        usual = min(_freedom(one) for one in each - each.mean(axis=0))
        freedom, least_freedom = usual, min(freedom, usual)
        between = max(float(np.mean((one - other) ** 2)) for k, one in enumerate(each) for other in each[:k])
        outside &= float(np.min(np.mean((own - each) ** 2, axis=1))) > between
    others = max(count - 1, 1) * freedom
    allowed, turned = float(fdtri(freedom, others, 1.0 - level)), float(fdtri(least_freedom, least_freedom, 1.0 - LEVEL))
    return Apart(size / max(scatter, least), allowed, bool(outside), count > 1, turned, math.sqrt(2.0 / freedom + 2.0 / others))


def _freedom(deviation: Array) -> float:
    """Return the degrees of freedom of a deviation (n,): those of white noise are half its samples, those of an offset one."""
    power = np.abs(np.fft.rfft(deviation)) ** 2
    power[1:] *= 2.0
    squares = float(power[0] ** 2 + 0.5 * np.sum(power[1:] ** 2))
    return float(np.sum(power)) ** 2 / squares if squares > 0.0 else 1.0


def commanded_otherwise(one: Course, rest: Sequence[Course]) -> bool:
    """Whether a log was given another command than its repetitions."""
    for name in one.commanded:
        for other in (other for other in rest if name in other.columns):
            length = min(one.samples, other.samples)
            a, b = one.columns[name][:length], other.columns[name][:length]
            if np.mean((a - b) ** 2) > MATTERS**2 * max(np.var(a), np.var(b)):
                return True
    return False


def stands_out(one: Apart, usual: Sequence[Apart], level: float) -> bool:
    """Whether a log is farther from its repetitions than other logs of a set are from theirs (``usual``), by more than ``level``.

    Friction may differ by a factor for a whole test, which no spectrum says. The logarithms of the other logs' ratios do, by their
    median and their median absolute deviation, against which that of the log is held by Student's t distribution.
    """
    from scipy.special import stdtrit

    differing = [each for each in usual if each.ratio > LEAST]
    if len(differing) < 2:
        # what is the same in all others, a command, has no scatter
        return one.far and not differing
    logs = np.array([math.log(each.ratio) for each in differing])
    middle = float(np.median(logs))
    usually = float(np.median([each.spread for each in differing]))
    further = max((float(np.median(np.abs(logs - middle))) / 0.6745) ** 2 - usually**2, 0.0)
    score = (math.log(max(one.ratio, LEAST)) - middle) / math.hypot(one.spread, math.sqrt(further))
    return score > float(stdtrit(len(logs) - 1, 1.0 - level))
