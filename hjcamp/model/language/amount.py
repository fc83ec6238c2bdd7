"""Numbers that carry their dimension: an effect's functions are called with them to check its units."""

from __future__ import annotations

import contextlib
import functools
import math
import re
from collections.abc import Iterable
from typing import Any

from hjcamp.errors import UsageError
from hjcamp.model.language.dimension import Dimension, product_of_units

# Numbers that everyone writes without their unit.
KNOWN_CONSTANTS = {9.81: "m/s^2", 9.80665: "m/s^2", 101325.0: "Pa"}


@functools.cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry()


def _meant(unit: str) -> str:
    """Return a hint at the unit that is probably meant: kg*m2 is kg*m^2, Nm, which is read as nanometres, N*m, and degC K."""
    written = re.sub(r"([A-Za-z])(-?\d)", r"\1^\2", re.sub(r"\bNm(s?)\b", lambda one: "N*m*s" if one[1] else "N*m", unit))
    written = re.sub(r"(?<=[A-Za-z0-9])[ .·](?=[A-Za-z])", "*", written)
    written = re.sub(r"°C|deg_?C|[Cc]elsius", "K", written)
    for one in dict.fromkeys((written, written.lower())):
        with contextlib.suppress(UsageError):
            if one != unit:
                dimension(one)
                return f" (did you mean '{one}'?)"
    return ""


@functools.cache
def dimension(unit: str) -> Dimension:
    """Return the dimension of ``unit``; refuse an unknown unit and one that is not SI (mm, deg, bar)."""
    # pint knows every unit, and takes half a second to be loaded
    if (known := product_of_units(unit)) is not None:
        return known
    registry = _registry()
    try:
        one = registry.Quantity(1.0, registry.parse_units(unit if unit != "1" else ""))
    except Exception:
        raise UsageError(f"unknown unit '{unit}'{_meant(unit)}; write SI units, such as m, rad, N, Pa*s/m^3, 1") from None
    if not math.isclose(one.to_base_units().magnitude, 1.0):
        raise UsageError(
            f"unit '{unit}' is not an SI unit{_meant(unit)}; inside the model everything is in SI units (m, rad, Pa, s)"
        )
    return Dimension({name: float(power) for name, power in one.dimensionality.items()})


class Amount:
    """A value with its dimension. A ``literal`` takes the dimension of what it is added to or compared with."""

    def __init__(self, value: float, dims: Dimension, literal: bool = False) -> None:
        self.value, self.dims, self.literal = value, dims, literal

    @staticmethod
    def of(value: Any) -> Amount:
        """Return ``value`` as an amount; a plain number is a literal, or one of the known constants."""
        if isinstance(value, Amount):
            return value
        known = KNOWN_CONSTANTS.get(float(value))
        return Amount(float(value), dimension(known or "1"), known is None)

    def in_same_unit(self, other: Any, doing: str) -> Amount:
        """Return ``other`` as an amount of the same dimension, or refuse it; ``self`` may be the literal."""
        found = Amount.of(other)
        if self.dims != found.dims and not self.literal and not found.literal:
            raise UsageError(f"{doing} {self.dims} and {found.dims}")
        return found

    def _sum(self, other: Any, value: float, doing: str) -> Amount:
        other = self.in_same_unit(other, doing)
        return Amount(value, other.dims if self.literal else self.dims, self.literal and other.literal)

    def __add__(self, other: Any) -> Amount:
        return self._sum(other, self.value + Amount.of(other).value, "adds")

    __radd__ = __add__

    def __sub__(self, other: Any) -> Amount:
        return self._sum(other, self.value - Amount.of(other).value, "subtracts")

    def __rsub__(self, other: Any) -> Amount:
        return Amount.of(other) - self

    def __mul__(self, other: Any) -> Amount:
        other = Amount.of(other)
        return Amount(self.value * other.value, self.dims * other.dims, self.literal and other.literal)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Amount:
        other = Amount.of(other)
        value = self.value / other.value if other.value else math.inf
        return Amount(value, self.dims / other.dims, self.literal and other.literal)

    def __rtruediv__(self, other: Any) -> Amount:
        return Amount.of(other) / self

    def __pow__(self, other: Any) -> Amount:
        power = pure(other, "an exponent")
        return Amount(abs(self.value) ** power, self.dims**power, self.literal)

    def __rpow__(self, other: Any) -> Amount:
        return Amount.of(other) ** self

    def __neg__(self) -> Amount:
        return Amount(-self.value, self.dims, self.literal)

    def __pos__(self) -> Amount:
        return self

    def __abs__(self) -> Amount:
        return Amount(abs(self.value), self.dims, self.literal)

    def __lt__(self, other: Any) -> bool:
        return self.value < self.in_same_unit(other, "compares").value

    def __le__(self, other: Any) -> bool:
        return self.value <= self.in_same_unit(other, "compares").value

    def __gt__(self, other: Any) -> bool:
        return self.value > self.in_same_unit(other, "compares").value

    def __ge__(self, other: Any) -> bool:
        return self.value >= self.in_same_unit(other, "compares").value

    def __eq__(self, other: object) -> bool:
        return self.value == self.in_same_unit(other, "compares").value

    __hash__ = None  # type: ignore[assignment]

    def __bool__(self) -> bool:
        return self.value != 0.0


def pure(value: Any, what: str) -> float:
    """Return the value of an amount without dimension, or refuse it."""
    amount = Amount.of(value)
    if amount.dims != dimension("1") and not amount.literal:
        raise UsageError(f"{what} must be a pure number, not {amount.dims}")
    return amount.value


def unit_product(powers: Iterable[tuple[str, float]]) -> str:
    """Return the product of powers of units as such a text: ``N*s/m``, ``1/rad``, ``Pa/m^0.5``, ``1``."""
    registry = _registry()
    found = registry.Unit("")
    for unit, power in powers:
        found = found * registry.parse_units(unit if unit != "1" else "") ** power
    above, *below = f"{found:~C}".replace("**", "^").split("/")
    # N*m, as engineers write it, not m*N
    return "/".join(["*".join(sorted(above.split("*"))) or "1", *below])
