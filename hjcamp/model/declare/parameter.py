"""What plants, effects and controllers declare as class attributes: parameters, states, inputs, channels."""

from __future__ import annotations

import math
import numbers
from dataclasses import dataclass, field
from typing import Any

from hjcamp.errors import UsageError, shown, unknown

PRIORS = ("uniform", "log-uniform", "normal", "log-normal")
HOLDS = ("previous", "linear")
# Two thirds of what a log-normal prior expects lie within this factor of the default.
USUAL_FACTOR = 3.0


@dataclass(frozen=True)
class Parameter:
    """A constant of the model: unit (SI), default, bounds and, for fitting, the prior over the bounds.

    A log-normal prior says that the size is known to within a factor of three (what a payload weighs, what the water of a
    tube weighs), so that effects that fit equally well are distinguished by it; it takes no part in the fit itself.
    ``shape`` marks a parameter that enters non-linearly (a length, a time constant): it is fitted from several starts.
    ``off`` is the value at which the effect that owns it vanishes, if there is one. ``each_test`` marks what a test begins
    with and no rig repeats: every measured test then has a value of its own, told by its lines, and the parameter is their mean.
    A plant's ``base`` parameter is another one on each rig: it is calibrated before anything is called missing. One that is
    ``given`` stands in the metadata of each test, under that name (a mass, a supply pressure). One that is ``placed`` is a place on a
    scale whose zero means nothing: any value is allowed, and default and bounds are counted from the middle of where tests were.
    """

    unit: str
    default: float
    bounds: tuple[float, float] = (float("-inf"), float("inf"))
    prior: str = "uniform"
    text: str = ""
    shape: bool = False
    off: float | None = None
    each_test: bool = False
    base: bool = False
    given: str = ""
    placed: bool = False
    name: str = ""

    def __set_name__(self, owner: type, name: str) -> None:
        object.__setattr__(self, "name", name)
        where = f"{owner.__name__}.{name}"
        low, high = self.bounds
        if not low < high:
            raise UsageError(f"{where}: bounds ({low:g}, {high:g}) are not in rising order")
        if not low <= self.default <= high:
            raise UsageError(f"{where}: default {self.default:g} is outside its bounds ({low:g}, {high:g})")
        if self.prior not in PRIORS:
            raise UsageError(f"{where}: unknown prior '{self.prior}'; allowed: {', '.join(PRIORS)}")
        if self.prior == "log-uniform" and low <= 0:
            raise UsageError(f"{where}: a log-uniform prior needs a lower bound above zero, not {low:g}")
        if self.prior == "log-normal" and self.default <= 0:
            raise UsageError(f"{where}: a log-normal prior needs a default above zero, not {self.default:g}")

    def checked(self, value: object, path: str) -> float:
        """Return ``value`` as a float; ``UsageError`` where it is no number or not within the bounds."""
        number = finite_number(value)
        low, high = (-math.inf, math.inf) if self.placed else self.bounds
        # files of models have seven digits: a value at its bound may stand beyond it by the last of them
        if number is None or not (low <= number <= high or any(math.isclose(number, one, rel_tol=1e-6) for one in self.bounds)):
            within = f"a number from {low:g} to {high:g}" if math.isfinite(high - low) else "a finite number"
            unit = "" if self.unit == "1" else f" {self.unit}"
            raise UsageError(f"{path} is {shown(value)}; {within}{unit} is needed")
        return min(max(number, low), high)

    def unusual(self, value: float) -> float:
        """Return by how many standard deviations the size of ``value`` differs from what is expected; 0 where nothing is."""
        if self.prior != "log-normal":
            return 0.0
        return math.log(max(value, 1e-3 * self.default) / self.default) / math.log(USUAL_FACTOR)

    @property
    def cyclic(self) -> bool:
        """Whether it is an angle that comes back to itself: its bounds hold one turn about zero and hardly more."""
        low, high = self.bounds
        return self.unit == "rad" and low < -3.0 and high > 3.0 and math.tau <= high - low < 1.1 * math.tau


@dataclass(frozen=True)
class State:
    """A quantity that the model integrates.

    ``resolution`` is the local error that one sample may make (a millionth of ``typical`` unless given), ``typical`` the
    size at which the model is linearised. ``low`` is what it cannot fall below (a level, an absolute pressure). A state that
    nothing measures begins about 0, or about its ``typical`` value where it has a ``low``: ``State("K", typical=350.0, low=200.0)``.
    ``start`` may be "unknown": each test then has a value of its own; ``scatter`` is its standard deviation from test to test.
    An effect's state that is ``known`` at rest starts again where the observed states are set to measurements at rest.
    """

    unit: str
    resolution: float = 0.0
    typical: float = 1.0
    start: float | str = 0.0
    text: str = ""
    known: bool = False
    low: float = float("-inf")
    scatter: float = 0.0
    name: str = ""

    def __post_init__(self) -> None:
        if self.resolution == 0.0:
            object.__setattr__(self, "resolution", 1e-6 * abs(self.typical))

    def usual(self, generator: Any) -> float:
        """Return a value that it may well have: about its typical size, on either side unless it has a lowest value."""
        if math.isfinite(self.low):
            return float(self.low + (abs(self.typical) + abs(min(self.low, 0.0))) * generator.uniform(0.1, 1.0))
        return float(self.typical * generator.uniform(-1, 1))

    def __set_name__(self, owner: type, name: str) -> None:
        object.__setattr__(self, "name", name)
        where = f"{owner.__name__}.{name}"
        _check_size(self.typical, f"{where}: typical")
        if self.start != "unknown" and finite_number(self.start) is None:
            raise UsageError(f'{where}: start is {shown(self.start)}; a number or "unknown" is needed')
        if not _is_number(self.low) or self.low == math.inf:
            raise UsageError(f"{where}: low is {shown(self.low)}; a number is needed: what the state cannot fall below")
        if (finite_number(self.scatter) or 0.0) < 0.0 or finite_number(self.scatter) is None:
            raise UsageError(f"{where}: scatter is {shown(self.scatter)}; a number from 0 on is needed")


@dataclass(frozen=True)
class Input:
    """A quantity that is given for each sample: a command, a flow, a measured motion.

    ``field`` is what the logs call it (by default its name and SI unit, such as ``voltage_v``), ``plausible`` what a sound
    log stays within; between samples it holds its "previous" value or runs "linear"-ly to the next. An input whose size is far
    from 1 says so by ``typical``. A log may lack one that is not ``required``: it then has its default. One that is the ``rate_of``
    another, a position that runs "linear"-ly, stands in no log: it is how fast that one goes on to its next sample.
    """

    unit: str
    default: float = 0.0
    text: str = ""
    typical: float = 1.0
    hold: str = "previous"
    field: str = ""
    plausible: tuple[float, float] = (float("-inf"), float("inf"))
    required: bool = True
    rate_of: str = ""
    name: str = ""

    def __set_name__(self, owner: type, name: str) -> None:
        object.__setattr__(self, "name", name)
        where = f"{owner.__name__}.{name}"
        _check_size(self.typical, f"{where}: typical")
        if self.rate_of and (self.field or self.hold != "previous"):
            raise UsageError(f"{where}: the rate of an input has neither a field nor a hold of its own; leave them out")
        if finite_number(self.default) is None:
            raise UsageError(f"{where}: default is {shown(self.default)}; a finite number is needed")
        if self.hold not in HOLDS:
            raise unknown("hold", str(self.hold), HOLDS, where)

    def usual(self, generator: Any) -> float:
        """Return a value that it may well have."""
        return self.default or float(self.typical * generator.uniform(-1.0, 1.0))


@dataclass(frozen=True)
class Measured:
    """A sensor whose reading the logs hold; the attribute's name is the field, a quantity and its unit (``position_m``).

    ``sensor`` names a slot or signal of the equations, ``of`` the state that it shows. ``counts`` is one count of a
    counting sensor and ``noise`` the standard deviation of an analog one, both in SI and read off the logs unless given.
    """

    sensor: str
    of: str = ""
    counts: float | None = None
    noise: float | None = None
    text: str = ""
    required: bool = True
    plausible: tuple[float, float] = (float("-inf"), float("inf"))
    name: str = ""

    def __set_name__(self, owner: type, name: str) -> None:
        object.__setattr__(self, "name", name)
        for word in ("counts", "noise"):
            if getattr(self, word) is not None:
                _check_size(getattr(self, word), f"{owner.__name__}.{name}: {word}")


@dataclass(frozen=True)
class Channel:
    """A measured column of the test log and the signal that predicts it.

    ``log_scale`` is the value in the log's unit of one SI unit; ``counts`` names the parameter that holds the
    resolution of a counting sensor (SI), ``noise`` the one that holds the standard deviation of an analog one.
    ``plausible`` (SI) is what a sound log stays within, ``along`` are the columns of the same quantity that are not
    measured, such as what is wanted of it.
    """

    field: str
    signal: str
    subsystem: str
    log_scale: float
    counts: str | None = None
    noise: str | None = None
    required: bool = True
    plausible: tuple[float, float] = (float("-inf"), float("inf"))
    along: tuple[str, ...] = ()


@dataclass(frozen=True)
class Contact:
    """Where dry friction holds: ``velocity`` stays 0 while the ``push`` is within ``limit`` and ``locks`` is not 0.

    ``direction`` is the input that says its regime: 0 held, +1 and -1 moving; ``friction`` is the line of its force.
    """

    name: str
    velocity: str
    push: str
    limit: str
    locks: str
    direction: str
    friction: str


@dataclass(frozen=True)
class Cut:
    """A view that drives part of the plant with measurements: each state in ``driven`` follows a channel.

    ``driven`` maps a state to the channel field that it follows; ``slopes`` maps a state to the driven state whose
    rate it is; the states in ``frozen`` are not needed then. Nothing needs to be driven: then the inputs alone move the plant.
    """

    name: str
    driven: dict[str, str] = field(default_factory=dict)
    slopes: dict[str, str] = field(default_factory=dict)
    frozen: tuple[str, ...] = ()


def _check_size(value: object, what: str) -> None:
    if (finite_number(value) or 0.0) <= 0.0:
        raise UsageError(f"{what} is {shown(value)}; a finite number above zero is needed (SI)")


def _is_number(value: object) -> bool:
    return isinstance(value, numbers.Real) and not isinstance(value, bool) and not math.isnan(value)


def finite_number(value: object) -> float | None:
    """Return ``value`` as a float, None where it is no finite number (a bool and a text are none)."""
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) else None


def declared(owner: type, kind: type) -> dict[str, Any]:
    """Return the class attributes of type ``kind``, base classes first, in order of declaration."""
    found: dict[str, Any] = {}
    for base in reversed(owner.__mro__):
        found.update({name: value for name, value in vars(base).items() if isinstance(value, kind)})
    return found
