"""How far a column of a log is from its repetitions, and whether chance allows that."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hjcamp.records.sets.course import Array, Course

# By chance one set of logs in a hundred has a log that is named, and one in a thousand one that is refused.
LEVEL, REFUSED = 0.01, 0.001
# Of what a column does (rms): logs that differ by less are repetitions, and commands one command.
MATTERS = 0.1
# Steps over this part of a test are looked at beside the readings themselves: what adds up over a test makes them scatter most.
PART = 50
# Squares in this ratio are nothing beside each other.
LEAST = 1e-12


@dataclass(frozen=True)
class Apart:
    """How far a column is from its repetitions: the ``ratio`` to what these differ by, and what chance ``allowed`` of it.

    ``outside``: it is farther from each repetition than these are from each other, by more than a tenth of what the column does;
    ``gross``: by more than all of what it does (rms of the readings). What a single repetition would differ by is not ``known``.
    ``spread`` is the standard deviation that chance gives the logarithm of the ratio, ``freedom`` and ``least_freedom`` the degrees
    of freedom of the deviation, and the fewest of those of the others; ``whole`` is the ratio of the readings themselves.
    """

    ratio: float
    allowed: float
    outside: bool
    known: bool
    gross: bool
    spread: float
    freedom: float
    least_freedom: float
    whole: float = 0.0

    @property
    def far(self) -> bool:
        """Whether it is outside, and by more than chance allows."""
        return self.outside and self.known and self.ratio > self.allowed

    def turned(self, level: float, freedom: float) -> float:
        """Return by how much a ratio falls by chance (``level``) where two tests do not repeat at all and one is changed."""
        from scipy.special import fdtri

        return float(fdtri(freedom, freedom, 1.0 - level))


@dataclass(frozen=True)
class Hunting:
    """What repetitions in closed loop differ by: the largest mean square of each column and look, with ``freedom`` of all of them."""

    squares: dict[str, tuple[float, ...]]
    freedom: int


def hunting(groups: Sequence[Sequence[Course]]) -> Hunting:
    """Return by how much the repetitions of conditions in closed loop differ."""
    squares: dict[str, tuple[float, ...]] = {}
    for group in groups:
        for name in group[0].columns:
            if all(name in one.columns for one in group):
                length = min(one.samples for one in group)
                looks = _looks(np.array([one.columns[name][:length] for one in group]))
                own = tuple(float(np.mean(np.var(look, axis=0, ddof=1))) for look in looks)
                squares[name] = tuple(map(max, own, squares.get(name, own)))
    return Hunting(squares, sum(len(group) - 1 for group in groups))


def apart(
    name: str,
    columns: dict[str, Array],
    rest: Sequence[Course],
    level: float,
    skipped: int = 0,
    loops: Hunting | None = None,
) -> Apart:
    r"""Return how far a column (n,) is from its repetitions ``rest``, of which ``skipped`` samples lie before it.

    For the deviation d from the mean of the r repetitions, with the variance s² of these,

    .. math:: F = \frac{r}{r + 1} \frac{\overline{d^2}}{s^2}

    is beyond what chance exceeds with probability ``level``. Degrees of freedom are those of the spectra P of the deviations,
    :math:`(\sum P)^2 / \sum P^2` (Satterthwaite 1946, doi:10.2307/3002019). The same is asked of steps over a fiftieth of the test,
    and of its first fiftieth. In closed loop, of which ``loops`` are the other conditions, s² is the largest of all of them, and a
    repetition has one degree of freedom: two oscillations of any phases may agree by chance.
    """
    length = min(len(columns[name]), *(one.samples - skipped for one in rest))
    all_of = [columns[name][:length], *(one.columns[name][skipped : skipped + length] for one in rest)]
    least = max(one.smallest[name] for one in rest) ** 2 + 1e-300
    looks = []
    for k, look in enumerate(_looks(np.array(all_of))):
        moves = np.array(all_of)[1:] if k == 2 else look[1:]
        squares = loops.squares.get(name, ()) if loops else None
        at_least = None if loops is None else (squares[k] if squares else 0.0, loops.freedom)
        looks.append(_apart(look[0], look[1:], (2.0 if k == 1 else 1.0) * least, level, float(np.var(moves)), at_least))
    return replace(max(looks, key=lambda one: (one.outside, one.ratio / one.allowed)), whole=looks[0].ratio)


def _looks(each: Array) -> list[Array]:
    """Return readings (k, n) of tests, their steps over a fiftieth of the test, and their first fiftieth."""
    step = max(each.shape[1] // PART, 1)
    return [each, each[:, step:] - each[:, :-step], each[:, :step]] if each.shape[1] > 2 * step else [each]


def _apart(own: Array, each: Array, least: float, level: float, moves: float, loops: tuple[float, int] | None) -> Apart:
    from scipy.special import fdtri

    deviation, count = own - each.mean(axis=0), len(each)
    size = count / (count + 1) * float(np.mean(deviation**2))
    own_freedom = freedom = least_freedom = _freedom(deviation)
    scatter = 0.0
    nearest = float(np.min(np.mean((own - each) ** 2, axis=1)))
    outside = size > MATTERS**2 * moves
    if count > 1:
        scatter = float(np.mean(np.var(each, axis=0, ddof=1)))
        # by chance a deviation is as those of the others, of which few say little: the fewest degrees of freedom are taken
        freedom = min(_freedom(one) for one in each - each.mean(axis=0))
        least_freedom = min(freedom, own_freedom)
        between = max(float(np.mean((one - other) ** 2)) for k, one in enumerate(each) for other in each[:k])
        outside &= nearest > between
    others = max(count - 1, 1) * freedom
    if loops is not None:
        scatter, freedom, others = max(scatter, loops[0]), 1.0, max(count - 1, 1) + loops[1]
    return Apart(
        ratio=size / max(scatter, least),
        allowed=float(fdtri(freedom, others, 1.0 - level)),
        outside=bool(outside),
        known=count > 1,
        gross=bool(outside and nearest > moves),
        spread=math.sqrt(2.0 / freedom + 2.0 / others),
        freedom=own_freedom,
        least_freedom=least_freedom,
    )


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


def in_closed_loop(group: Sequence[Course]) -> bool:
    """Whether repetitions were driven by more different inputs than the noise of these: then something feeds back what is measured."""
    for k, one in enumerate(group):
        for name in one.columns.keys() - {*one.measured}:
            for other in group[:k]:
                length = min(one.samples, other.samples)
                if name.startswith("reference_") or name not in other.columns:
                    continue
                differ = float(np.mean((one.columns[name][:length] - other.columns[name][:length]) ** 2))
                # of noise the difference has twice the variance
                if differ > 4.0 * max(one.smallest[name], other.smallest[name]) ** 2:
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
