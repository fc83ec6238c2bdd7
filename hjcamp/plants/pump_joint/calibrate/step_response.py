"""Step responses of all-pole transfer functions of any order with a delay, and their fit by output error."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
PERIOD = 1e-3


@dataclass(frozen=True)
class TransferFunction:
    """An all-pole transfer function with delay: gain prod(p_i) / prod(s + p_i) e^(-delay s).

    ``sections`` holds (natural frequency rad/s, damping) of each pair of poles, ``real_pole`` (1/s) the odd one out.
    """

    gain: float
    delay: float
    sections: tuple[tuple[float, float], ...]
    real_pole: float | None

    @property
    def order(self) -> int:
        return 2 * len(self.sections) + (self.real_pole is not None)

    @property
    def denominator(self) -> Array:
        """Coefficients of the denominator, highest power first, leading 1."""
        polynomial = np.array([1.0] if self.real_pole is None else [1.0, self.real_pole])
        for frequency, damping in self.sections:
            polynomial = np.polymul(polynomial, [1.0, 2.0 * damping * frequency, frequency**2])
        return polynomial

    def step(self, samples: int, period: float = PERIOD) -> Array:
        """Return the response (samples,) to a unit step at time 0, exact at each sample."""
        matrix = self._matrix()
        first = max(math.ceil(self.delay / period - 1e-12), 0)
        response = np.zeros(samples)
        if first >= samples:
            return response
        states = exponential(matrix * (first * period - self.delay))[:, -1:]
        move = exponential(matrix * period)
        # Each turn doubles the number of samples: columns k to 2k - 1 are the first k, moved on by k samples.
        while states.shape[1] < samples - first:
            # einsum, for BLAS would start threads for these small products.
            states = np.hstack([states, np.einsum("ij,jk->ik", move, states)])
            move = move @ move
        response[first:] = states[-2, : samples - first]
        return self.gain * response

    def _matrix(self) -> Array:
        # A chain of sections, rates scaled by frequency; the last state is the constant 1 that drives it.
        size = self.order + 1
        matrix = np.zeros((size, size))
        source, row = size - 1, 0
        if self.real_pole is not None:
            matrix[row, row], matrix[row, source] = -self.real_pole, self.real_pole
            source, row = row, row + 1
        for frequency, damping in self.sections:
            rate, place = row, row + 1
            matrix[rate, source], matrix[rate, place] = frequency, -frequency
            matrix[rate, rate] = -2.0 * damping * frequency
            matrix[place, rate] = frequency
            source, row = place, row + 2
        return matrix


def exponential(matrix: Array) -> Array:
    """Return the exponential of a small matrix (n, n): series of order 12 after scaling, then squaring.

    scipy.linalg.expm starts BLAS threads, which for 7 x 7 takes 100 times as long on a busy machine.
    Source: Moler & Van Loan (2003), SIAM Rev. 45, 3, method 3.
    """
    size = float(np.abs(matrix).sum(axis=0).max())
    halvings = max(math.ceil(math.log2(size)) + 2, 0) if size > 0 else 0
    scaled = matrix / 2.0**halvings
    term = np.eye(len(matrix))
    total = term.copy()
    for order in range(1, 13):
        term = term @ scaled / order
        total = total + term
    for _ in range(halvings):
        total = total @ total
    return total


def rise_time(function: TransferFunction) -> float:
    """Return the time from 10 to 90 % of the final value, s (thesis 4.3)."""
    slowest = min([frequency * min(damping, 1.0) for frequency, damping in function.sections] or [math.inf])
    slowest = min(slowest, function.real_pole or math.inf)
    period = 1e-5 if slowest > 15.0 else 1e-4
    response = function.step(round((function.delay + 6.0 / slowest) / period), period) / function.gain
    ends = []
    for level in (0.1, 0.9):
        after = int(np.argmax(response >= level))
        before = response[after - 1]
        ends.append((after - 1 + (level - before) / (response[after] - before)) * period)
    return ends[1] - ends[0]


def to_vector(function: TransferFunction) -> Array:
    """Return the logarithms that the fit moves, and the delay in ms."""
    poles = [] if function.real_pole is None else [math.log(function.real_pole)]
    pairs = [math.log(value) for section in function.sections for value in section]
    return np.array([function.gain, function.delay * 1e3, *poles, *pairs])


def from_vector(vector: Array, order: int) -> TransferFunction:
    """Return the transfer function of a fit's vector."""
    gain, delay, *rest = (float(value) for value in vector)
    pole = math.exp(rest.pop(0)) if order % 2 else None
    pairs = [math.exp(value) for value in rest]
    return TransferFunction(gain, delay * 1e-3, tuple(zip(pairs[::2], pairs[1::2], strict=True)), pole)


def fit(response: Array, order: int, starts: list[TransferFunction], rows: NDArray[np.intp]) -> TransferFunction:
    """Return the transfer function of ``order`` nearest to a response (n,) to a unit step at time 0, at its ``rows``.

    Output error, least squares over gain, delay and poles, best of several starts. Source: Ljung (1999), System
    Identification, 2nd ed., section 4.2; solver: scipy.optimize.least_squares (trust region reflective).
    """
    from scipy.optimize import least_squares

    low, high = np.zeros(2 + order), np.full(2 + order, math.log(2e4))
    low[:2], high[:2] = (0.05, -1e-9), (20.0, 60.0)
    damping = slice(3 + order % 2, None, 2)
    low[damping], high[damping] = math.log(0.05), math.log(5.0)
    samples, wanted = int(rows[-1]) + 1, response[rows]
    best = None
    for start in starts:
        vector = np.clip(to_vector(start), low + 1e-6, high - 1e-6)
        solution = least_squares(
            lambda x: from_vector(x, order).step(samples)[rows] - wanted,
            vector, bounds=(low, high), x_scale=np.maximum(np.abs(vector), 0.1), max_nfev=40, xtol=1e-9, ftol=1e-9,
        )  # fmt: skip
        if best is None or solution.cost < best.cost:
            best = solution
    assert best is not None
    return from_vector(best.x, order)


def telling_rows(response: Array) -> NDArray[np.intp]:
    """Return which samples of a step response the fit looks at: all of the rise, few of what is settled."""
    final = float(np.median(response[-20:]))
    low, high = (int(np.argmax(response > share * final)) for share in (0.1, 0.9))
    rise = max(high - low, 5)
    every = max(rise // 20, 1)
    end = min(high + 4 * rise, len(response) - 1)
    return np.unique(np.concatenate([np.arange(0, end, every), np.linspace(end, len(response) - 1, 15)]).astype(np.intp))
