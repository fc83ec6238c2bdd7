"""The input with which a model follows a reference exactly: its rates, inverted along the states that the reference asks for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import UsageError
from hjcamp.model.compile.compose import Composition
from hjcamp.model.run.rates import Course, Rates

Array = NDArray[np.float64]
# Steps of Newton's method, of a difference (share of a typical size), and what counts as reached (share of the reference's size).
STEPS, STEP, REACHED = 30, 1e-4, 1e-6
# Newton's method goes on to here, as its results are differenced over this share of the time in which the reference changes.
FINEST, SHARE = 1e-11, 1e-3
MOST_STATES = 2


@dataclass
class Inverse:
    r"""A composition whose controlled reading y determines its states (a flat output), and one input of it, SI.

    .. math:: z = \Phi(y, \dot y), \qquad \dot z = f(z, u)

    With n = 1 or 2 states of the plant z follows from y and its first n - 1 derivatives, its rate from the next one, and u from the
    equations. Raises ``UsageError``, with the reason, where that cannot be: Fliess et al. 1995, doi:10.1080/00207179508921959.
    """

    composition: Composition
    reading: int
    name: str
    p: Array
    _rates: Rates = field(init=False)

    def __post_init__(self) -> None:
        count = len(self.composition.plant.states)
        if count > MOST_STATES:
            self._refuse(f"it has {count} states; the reference with its two derivatives determines {MOST_STATES} at most")
        self._rates = Rates(self.composition)
        self._column = self.composition.inputs.index(self.name)

    def _refuse(self, why: str) -> None:
        raise UsageError(f"plant {self.composition.plant.name}: no feedforward by '{self.name}': {why}")

    def inputs(self, reference: Array, start: Array, rest: Array) -> Array:
        """Return the input (n,) along a reference (n, 3): value, velocity, acceleration.

        ``start`` are plant states near the begin, ``rest`` all inputs (inputs,) at rest; they stay but for the one that is sought. At
        rest before the first motion the input is that of ``rest``, later it holds the friction of the last direction.
        """
        given = np.tile(rest, (len(reference), 1))
        value, velocity, acceleration = reference.T
        states = self._states(value, velocity, np.tile(start, (len(reference), 1)), given)
        sides, moved = self._sides(states)
        wanted = self._slopes(value, velocity, acceleration, states, given)
        found = self._solved(states, wanted, sides, given)
        whole = np.where(moved, found, rest[self._column])
        # what is held over a sample acts as its mean there
        return np.asarray(0.5 * (whole + np.append(whole[1:], whole[-1])))

    def _along(self, states: Array, given: Array, sides: Array) -> tuple[Array, Array]:
        length = len(states)
        begins = np.zeros(length, dtype=np.int64)
        begins[0] = 1
        period = self.composition.plant.period
        course = Course(period, begins, np.arange(length, dtype=np.float64) * period, sides, states, given)
        found = self._rates.along(self.p, course)
        return found.before, found.readings[:, self.reading]

    def _states(self, value: Array, velocity: Array, begun: Array, given: Array) -> Array:
        """Return the states (n, states) in which the reading and, with two states, its velocity are as wanted."""
        still = np.zeros(len(value))
        targets = [value, velocity][: begun.shape[1]]

        def shown(states: Array, inputs: Array = given) -> Array:
            rates, reading = self._along(states, inputs, still)
            if len(targets) == 1:
                return np.asarray(reading[:, None])
            return np.column_stack([reading, self._change(states, rates, inputs, still)])

        pushed = given.copy()
        pushed[:, self._column] += self._typical_input()
        states, target = begun.copy(), np.column_stack(targets)
        free = shown(begun, pushed) - shown(begun)
        if len(targets) == 2 and np.any(np.abs(free[:, 1]) > REACHED * (np.abs(shown(begun)[:, 1]) + _size(velocity))):
            self._refuse("it acts on the first derivative of what is controlled, and a state is determined by nothing")
        states = self._newton(shown, states, target)
        if not _reached(shown(states), target):
            self._refuse("what is controlled does not determine its states")
        return states

    def _change(self, states: Array, rates: Array, given: Array, sides: Array) -> Array:
        """Return the rate of the reading (n,), by its slope along the rates of the states."""
        size = STEP * self._typical() / np.maximum(np.abs(rates), self._typical())
        step = np.min(size / self._typical(), axis=1)
        ahead = self._along(states + step[:, None] * rates, given, sides)[1]
        back = self._along(states - step[:, None] * rates, given, sides)[1]
        return np.asarray((ahead - back) / (2.0 * step))

    def _newton(self, shown: Callable[[Array], Array], states: Array, target: Array) -> Array:
        typical = self._typical()
        for _ in range(STEPS):
            error = target - shown(states)
            if _reached(target - error, target, FINEST):
                break
            slopes = np.empty((*error.shape, states.shape[1]))
            for k, size in enumerate(typical):
                moved = states.copy()
                moved[:, k] += STEP * size
                slopes[:, :, k] = (shown(moved) - target + error) / (STEP * size)
            states = states + np.einsum("nij,nj->ni", np.linalg.pinv(slopes), error)
        return states

    def _slopes(self, value: Array, velocity: Array, acceleration: Array, states: Array, given: Array) -> Array:
        """Return the rates (n, states) that the reference asks of the states."""
        times = [_size(one) / _size(rate) for one, rate in ((value, velocity), (velocity, acceleration)) if _size(rate) > 0.0]
        step = SHARE * min((one for one in times if one > 0.0), default=1.0)
        ends = [self._states(value + s * velocity, velocity + s * acceleration, states, given) for s in (step, -step)]
        return np.asarray((ends[0] - ends[1]) / (2.0 * step))

    def _solved(self, states: Array, wanted: Array, sides: Array, given: Array) -> Array:
        """Return the input (n,) under which the rates are as wanted."""
        given, size, scale = given.copy(), self._typical_input(), np.abs(wanted).max(axis=0) + self._typical() * 1e-9
        for _ in range(STEPS):
            rates = self._along(states, given, sides)[0]
            error = (wanted - rates) / scale
            pushed = given.copy()
            pushed[:, self._column] += STEP * size
            slope = (self._along(states, pushed, sides)[0] - rates) / (STEP * size * scale)
            square = np.einsum("ns,ns->n", slope, slope)
            active = sides != 0.0 if self.composition.contacts else np.ones(len(sides), dtype=bool)
            if np.any(square[active] == 0.0):
                self._refuse("it has no influence at once, as an effect of the model delays, stops or ends it")
            change = np.einsum("ns,ns->n", slope, error) / np.where(square > 0.0, square, 1.0)
            given[:, self._column] += np.where(active, change, 0.0)
            if np.max(np.abs(change[active]), initial=0.0) < REACHED * size:
                break
        left = np.abs(wanted - self._along(states, given, sides)[0])[active] / scale
        if np.max(left, initial=0.0) > 1e-3:
            at = float(np.argmax(left.max(axis=1)) * self.composition.plant.period)
            self._refuse(f"no value of it moves the plant as the reference asks {at:.3g} s after its first motion")
        return np.asarray(given[:, self._column])

    def _sides(self, states: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Return the sides of all contacts (n,), at rest those of the last motion, and where there has been motion."""
        names, contacts = list(self.composition.plant.states), self.composition.contacts
        if not contacts:
            return np.zeros(len(states)), np.ones(len(states), dtype=bool)
        moved = np.zeros(len(states), dtype=bool)
        total = np.zeros(len(states))
        for k, one in enumerate(contacts):
            speed = states[:, names.index(one.velocity)]
            sign = np.where(np.abs(speed) > 1e-9 * _size(speed), np.sign(speed), 0.0)
            last = np.maximum.accumulate(np.where(sign != 0.0, np.arange(len(sign)), -1))
            total += 3.0**k * np.where(last >= 0, sign[np.maximum(last, 0)], 0.0)
            moved |= last >= 0
        return total, moved

    def _typical(self) -> Array:
        return np.array([one.typical for one in self.composition.plant.states.values()])

    def _typical_input(self) -> float:
        return float(self.composition.plant.inputs[self.name].typical or 1.0)


def _size(values: Array) -> float:
    return float(np.max(np.abs(values), initial=0.0))


def _reached(found: Array, target: Array, share: float = REACHED) -> bool:
    scale = np.abs(target).max(axis=0) + 1e-12
    return bool(np.all(np.isfinite(found)) and np.max(np.abs(found - target) / scale) < share)


def inverse_inputs(
    composition: Composition, reading: int, name: str, values: Mapping[str, float], reference: Array, start: Mapping[str, float]
) -> Array:
    """Return the input ``name`` (n,), SI, with which a model's reading follows a reference (n, 3); see `Inverse`."""
    from hjcamp.model.run.simulator import Simulator

    simulator = Simulator(composition, free=True)
    begun = np.array([start.get(one, 0.0) for one in composition.plant.states])
    return Inverse(composition, reading, name, simulator.vector(values)).inputs(reference, begun, simulator.inputs())
