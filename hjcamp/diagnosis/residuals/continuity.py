r"""From window to window: what a start explains of the readings, and how a state that nothing measures goes on.

Readings err by :math:`e_w` from the start :math:`x_w`. To first order they are met best from :math:`x_w + S_w^+ e_w`, and the
window then ends at :math:`z_w + \Phi_w S_w^+ e_w`. What the start explains is taken out of :math:`e_w`. In its place is what the
readings would err by if the states that nothing measures began where the window before ended: :math:`S_w` times their jump, as
far as no start of a measured state explains it (condensing in multiple shooting: Bock & Plitt 1984,
doi:10.1016/S1474-6670(17)61205-9).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# A start is free in directions that the window tells at all.
TOLD = 1e-6


class Memory(NamedTuple):
    """What effects remember, in usual sizes: k states of theirs, which go on from window to window.

    ``readings`` (windows, coefficients, k) is what they change of a window's readings where it begins with more of them, ``by_starts``
    (windows, k, states) and ``by_memory`` (windows, k, k) what starts and they change of what is remembered when it ends,
    ``of_sensors`` (k,) those of sensors, ``fresh`` (windows,) the windows with which tests begin.
    """

    readings: Array
    by_starts: Array
    by_memory: Array
    of_sensors: NDArray[np.bool_]
    fresh: NDArray[np.bool_]

    @property
    def first(self) -> Array:
        """What is changed of the readings (windows, coefficients, k) where nothing tells what is remembered."""
        return np.where(self.fresh[:, None, None], _finite(self.readings), 0.0)

    @property
    def later(self) -> Array:
        """What is changed of the readings (windows, coefficients, k) where the window before tells what is remembered."""
        return np.where(self.fresh[:, None, None], 0.0, _finite(self.readings))


@dataclass(frozen=True)
class Passage:
    """What starts explain, in their usual sizes; ``spans`` (windows, coefficients, states) is an orthonormal basis of it.

    ``shifts`` (windows, states, coefficients) are the starts' shifts by the readings' errors, ``told`` (windows, states, states) the
    part of a shift that readings tell, ``passed`` (windows, states, states) how a shift changes a window's end, ``jumps``
    (windows, coefficients, unseen states) what a jump changes, in units of what the noise of the window before makes of it, ``unseen``
    (states,) and ``goes_on`` (windows,) where there is one. ``recalls`` (windows, k, coefficients) are the shifts of what effects
    remember where nothing tells it. ``own`` (windows, coefficients, k) is an orthonormal basis of what the
    states of sensors explain with which they begin: it tells nothing of where the plant begins, as a lag reads what it has caught up
    with, and that goes on from the window before.
    """

    spans: Array
    shifts: Array
    told: Array
    passed: Array
    jumps: Array
    unseen: NDArray[np.bool_]
    goes_on: NDArray[np.bool_]
    recalls: Array
    own: Array | None = None
    unsure: Array | None = None

    @classmethod
    def of(
        cls, readings: Array, ends: Array, unseen: NDArray[np.bool_], goes_on: NDArray[np.bool_], memory: Memory | None = None
    ) -> Passage:
        """Return it for sensitivities of the readings (windows, coefficients, states) and of the ends (windows, states, states).

        What effects remember where nothing tells it is explained as a start is. Where any are not finite nothing is explained.
        """
        finite = np.all(np.isfinite(readings), axis=(1, 2)) & np.all(np.isfinite(ends), axis=(1, 2))
        slopes, passed = (np.where(finite[:, None, None], one, 0.0) for one in (readings, ends))
        whole, own = slopes, None
        if memory is not None and memory.of_sensors.any():
            own = _basis(memory.later[:, :, memory.of_sensors])
            slopes = slopes - own @ (own.transpose(0, 2, 1) @ slopes)
        u, s, v = np.linalg.svd(_with(slopes, memory), full_matrices=False)
        keep, plain = _telling(s), slopes.shape[2]
        spans, inverse = u * keep[:, None, :], keep / np.where(keep, s, 1.0)
        moves, v = np.einsum("wks,wk,wfk->wsf", v, inverse, u), v[:, :, :plain]
        shifts = moves[:, :plain]
        told = np.einsum("wks,wk,wkt->wst", v, keep.astype(float), v)
        known = goes_on & finite
        known[1:] &= finite[:-1]
        jumps = np.zeros((*slopes.shape[:2], int(unseen.sum())))
        if unseen.any() and known.any():
            jumps = _weighed(_orthogonal_part(slopes, unseen), _spread(shifts, told, passed, known)[:, unseen][:, :, unseen])
        unsure = None if memory is None else _unsure(memory, whole - slopes, spans, moves, known)
        return cls(spans, shifts, told, passed, jumps, unseen, known, moves[:, plain:], own, unsure)

    def less(self, left: Array) -> Array:
        """Return errors (windows, coefficients) without what the states of sensors explain."""
        if self.own is None:
            return left
        return _without(left, self.own)

    def recalled(self, left: Array) -> Array:
        """Return by how much more effects remember (windows, k) where nothing tells it, in usual sizes."""
        found = np.einsum("wkf,wf->wk", self.recalls, left)
        return np.where(np.isfinite(found), found, 0.0)

    def begun(self, left: Array, starts: Array, ends: Array) -> tuple[Array, Array]:
        """Return where windows begin and end best (windows, states) for errors (windows, coefficients) from ``starts``, with ``ends``.

        What the readings do not tell of a start is as the window before left it, where states go on.
        """
        shift = np.einsum("wsf,wf->ws", self.shifts, left)
        begun = starts + np.where(np.isfinite(shift), shift, 0.0)
        ended = ends + np.einsum("wst,wt->ws", self.passed, begun - starts)
        for w in self._joined:
            own = begun[w]
            own += self._untold[w] @ (ended[w - 1] - own)
            ended[w] = ends[w] + self.passed[w] @ (own - starts[w])
        return begun, ended

    @cached_property
    def _joined(self) -> list[int]:
        return np.flatnonzero(self.open).tolist()

    @cached_property
    def _untold(self) -> Array:
        """What readings do not tell of a start (windows, states, states)."""
        return np.eye(len(self.unseen)) - self.told

    def unexplained(self, left: Array, starts: Array, ends: Array) -> Array:
        """Return what no start explains of errors (windows, coefficients) from ``starts``, which lead to ``ends`` (windows, states)."""
        found = _without(left, self.spans)
        if self.unsure is not None:
            found = _without(found, self.unsure)
        if not self.unseen.any() or not self.goes_on.any():
            return found
        begun, ended = self.begun(left, starts, ends)
        jump = np.zeros_like(begun)
        jump[1:] = begun[1:] - ended[:-1]
        jump[~self.goes_on] = 0.0
        return np.asarray(found + np.einsum("wfs,ws->wf", self.jumps, jump[:, self.unseen]))

    @property
    def open(self) -> NDArray[np.bool_]:
        """Whether a window's start is partly taken from the window before (windows,)."""
        return self.goes_on & _open(self.told) & self.unseen.any()


@dataclass(frozen=True)
class Through:
    """What the start of each test explains where tests are simulated through.

    ``spans`` (windows, coefficients, states) is an orthonormal basis of it over all windows of a test, ``shifts`` (windows, states,
    coefficients) is each window's share of the start's shift, ``recalls`` (windows, k, coefficients) that of what effects remember
    then, ``of_test`` (windows,) the test that a window belongs to.
    """

    spans: Array
    shifts: Array
    recalls: Array
    of_test: NDArray[np.int64]

    @classmethod
    def of(cls, readings: Array, of_test: NDArray[np.int64], memory: Memory | None = None) -> Through:
        """Return it for sensitivities of the readings (windows, coefficients, states) to a test's start, and to what is remembered."""
        plain = readings.shape[2]
        if memory is not None:
            readings = np.concatenate([readings, _finite(memory.readings)], axis=2)
        spans, shifts = np.zeros_like(readings), np.zeros_like(readings).transpose(0, 2, 1)
        for rows in _tests(of_test):
            slopes = readings[rows]
            if not np.isfinite(slopes).all():
                continue
            u, s, v = np.linalg.svd(slopes.reshape(-1, slopes.shape[2]), full_matrices=False)
            keep = _telling(s[None])[0]
            spans[rows] = (u * keep).reshape(slopes.shape)
            whole = (v.T * (keep / np.where(keep, s, 1.0))) @ u.T
            shifts[rows] = whole.reshape(len(v), *slopes.shape[:2]).transpose(1, 0, 2)
        return cls(spans, shifts[:, :plain], shifts[:, plain:], of_test)

    def less(self, left: Array) -> Array:
        """Return errors (windows, coefficients) as they are: one start of a test settles what its sensors begin with, too."""
        return left

    def recalled(self, left: Array) -> Array:
        """Return by how much more effects remember at the start of each test (windows, k), in usual sizes."""
        return self._summed(np.einsum("wkf,wf->wk", self.recalls, left))

    def begun(self, left: Array, starts: Array, ends: Array) -> tuple[Array, Array]:
        """Return where tests begin best for errors (windows, coefficients) from ``starts`` (windows, states); ``ends`` as given."""
        return starts + self._summed(np.einsum("wsf,wf->ws", self.shifts, left)), ends

    def unexplained(self, left: Array, starts: Array, ends: Array) -> Array:
        """Return what no start of a test explains of errors (windows, coefficients)."""
        del starts, ends
        explained = self._summed(np.einsum("wfs,wf->ws", self.spans, left))
        return np.asarray(left - np.einsum("wfs,ws->wf", self.spans, explained))

    @property
    def open(self) -> NDArray[np.bool_]:
        """Whether a window's start is partly taken from another (windows,): none is."""
        return np.zeros(len(self.of_test), dtype=bool)

    def _summed(self, each: Array) -> Array:
        """Return the sums over each test (windows, k), where they are finite."""
        found = np.zeros_like(each)
        for rows in _tests(self.of_test):
            whole = each[rows].sum(axis=0)
            found[rows] = np.where(np.isfinite(whole), whole, 0.0)
        return found


def _unsure(memory: Memory, own: Array, spans: Array, moves: Array, goes_on: NDArray[np.bool_]) -> Array:
    """Return directions (windows, coefficients, coefficients) that noise of other windows has a share of, each by its root.

    ``own`` (windows, coefficients, states) is what starts change of what sensors begin with, of which they are not told.
    """
    plain, later = own.shape[2], memory.later
    by_starts, by_memory = _finite(memory.by_starts), _finite(memory.by_memory)
    spread, moved = np.zeros_like(by_memory), own @ moves[:, :plain]
    # what a diverging model remembers is no noise
    with np.errstate(over="ignore", invalid="ignore"):
        noise = np.concatenate([by_starts, by_memory], axis=2) @ moves
        rest = by_memory - by_starts @ moves[:, :plain] @ later
        for w in np.flatnonzero(goes_on):
            spread[w] = noise[w - 1] @ noise[w - 1].T + rest[w - 1] @ spread[w - 1] @ rest[w - 1].T
        later = later - spans @ (spans.transpose(0, 2, 1) @ later)
        variance = _finite(later @ spread @ later.transpose(0, 2, 1) + moved @ moved.transpose(0, 2, 1))
    share, found = np.linalg.eigh(variance)
    return np.asarray(found * np.sqrt(1.0 - 1.0 / np.sqrt(1.0 + np.maximum(share, 0.0)))[:, None, :])


def _without(left: Array, directions: Array) -> Array:
    """Return errors (windows, coefficients) without what directions (windows, coefficients, k) have of them."""
    return np.asarray(left - np.einsum("wfk,wk->wf", directions, np.einsum("wfk,wf->wk", directions, left)))


def _finite(slopes: Array) -> Array:
    """Return sensitivities (windows, ...) with 0 in windows in which they are not finite."""
    return np.where(np.isfinite(slopes).all(axis=(1, 2), keepdims=True), slopes, 0.0)


def _with(slopes: Array, memory: Memory | None) -> Array:
    """Return slopes (windows, coefficients, states) with those to what is remembered where nothing tells it."""
    return slopes if memory is None else np.concatenate([slopes, memory.first], axis=2)


def _basis(slopes: Array) -> Array:
    """Return an orthonormal basis (windows, coefficients, k) of columns (windows, coefficients, k)."""
    u, s, _ = np.linalg.svd(slopes, full_matrices=False)
    return np.asarray(u * _telling(s)[:, None, :])


def _tests(of_test: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    return [np.flatnonzero(of_test == test) for test in np.unique(of_test)]


def _orthogonal_part(slopes: Array, unseen: NDArray[np.bool_]) -> Array:
    """Return what unseen states' starts change (windows, coefficients, unseen states) beyond what those of measured ones could."""
    if unseen.all():
        return slopes
    u, s, _ = np.linalg.svd(slopes[:, :, ~unseen], full_matrices=False)
    u = u * _telling(s)[:, None, :]
    return np.asarray(slopes[:, :, unseen] - u @ (u.transpose(0, 2, 1) @ slopes[:, :, unseen]))


def _spread(shifts: Array, told: Array, passed: Array, known: NDArray[np.bool_]) -> Array:
    """Return the covariance (windows, states, states) with which the window before tells the states that a window begins with."""
    found = shifts @ shifts.transpose(0, 2, 1)
    for w in np.flatnonzero(known & _open(told)):
        rest = (np.eye(told.shape[1]) - told[w]) @ passed[w - 1]
        found[w] += rest @ found[w - 1] @ rest.T
    before = np.zeros_like(found)
    before[1:] = passed[:-1] @ found[:-1] @ passed[:-1].transpose(0, 2, 1)
    return before


def _weighed(jumps: Array, spread: Array) -> Array:
    """Return what jumps change (windows, coefficients, jumps) over the root of 1, the sensors' noise, and of ``spread``."""
    values, vectors = np.linalg.eigh(spread)
    root = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
    u, s, _ = np.linalg.svd(jumps @ root, full_matrices=False)
    less = u * (1.0 - 1.0 / np.sqrt(1.0 + s**2))[:, None, :]
    return np.asarray(jumps - less @ (u.transpose(0, 2, 1) @ jumps))


def _open(told: Array) -> NDArray[np.bool_]:
    """Whether a window's readings leave something of its start open (windows,)."""
    return np.asarray(np.trace(told, axis1=1, axis2=2) < told.shape[1] - 0.5)


def _telling(sizes: Array) -> NDArray[np.bool_]:
    """Return which directions (windows, k) of a start readings tell, by singular values in units of their noise."""
    return np.asarray(sizes > np.maximum(TOLD * sizes[:, :1], 1.0)) if sizes.shape[1] else sizes > 0.0
