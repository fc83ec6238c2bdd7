"""Dimensions of products of SI units are those of pint, which is not loaded for them."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pint
import pytest

from hjcamp.errors import UsageError
from hjcamp.model.language.amount import dimension
from hjcamp.model.language.dimension import SYMBOLS, Dimension, product_of_units

PACKAGE = Path(__file__).parents[2] / "hjcamp"
DECLARED = re.compile(r"""(?:State|Parameter|Input|Measured|Constant|signal)\([^"\n]*"([^"\n]{1,40})"|unit="([^"\n]{1,40})\"""")


@pytest.fixture(scope="module")
def registry() -> pint.UnitRegistry[float]:
    return pint.UnitRegistry()


def declared() -> set[str]:
    """Units that the files of plants and effects give."""
    files = [*(PACKAGE / "plants").rglob("*.py"), *(PACKAGE / "effects").rglob("*.py")]
    found = {unit for path in files for pair in DECLARED.findall(path.read_text(encoding="utf-8")) for unit in pair if unit}
    return {unit for unit in found if product_of_units(unit) is not None}


def drawn(count: int) -> set[str]:
    """Products of powers of units, written in every way that is read."""
    draw = random.Random(20261129)
    units = [*SYMBOLS, "1"]
    found = set()
    for _ in range(count):
        text = draw.choice(units)
        for _ in range(draw.randrange(4)):
            one = draw.choice(units)
            one = draw.choice((one, f"{one}^{draw.choice((2, 3, -1, 0.5))}", f"({one}*{draw.choice(units)})", f"{one}**2"))
            text += draw.choice("*/") + one
        found.add(text)
    return found


def test_products_of_units_are_those_of_pint(registry: pint.UnitRegistry[float]) -> None:
    written = declared()
    assert len(written) > 30
    for unit in sorted(written | drawn(400)):
        of_pint = registry.parse_units("" if unit == "1" else unit).dimensionality
        assert dict(product_of_units(unit) or {}) == pytest.approx(dict(of_pint)), unit


@pytest.mark.parametrize(
    "unit", ["mm", "kg m", "2*m", "m^1e9", "m**2**9999", "1if 1else 1", "m[0]", "f(m)", "m;s", "m*", "(" * 50, "m" * 99]
)
def test_another_text_is_none(unit: str) -> None:
    assert product_of_units(unit) is None


@pytest.mark.parametrize(("unit", "same"), [("newton*meter", "N*m"), ("kg m^2/s^3", "W"), ("count", "1"), ("1.0/s", "Hz")])
def test_what_is_written_otherwise_is_the_same(unit: str, same: str) -> None:
    assert product_of_units(unit) is None and dimension(unit) == dimension(same)
    assert hash(dimension(unit)) == hash(dimension(same))


@pytest.mark.parametrize("unit", ["mm", "deg", "bar", "degC", "newtonish"])
def test_what_is_not_si_is_refused(unit: str) -> None:
    with pytest.raises(UsageError, match=unit):
        dimension(unit)


@pytest.mark.parametrize(
    ("unit", "text"),
    [
        ("N*m", "kg*m^2/s^2"),
        ("1", "1"),
        ("1/s", "1/s"),
        ("Pa*s/m^3", "kg/(m^4*s)"),
        ("m^0.5", "m^0.5"),
        ("V", "kg*m^2/(s^3*A)"),
    ],
)
def test_a_dimension_is_written_in_base_units(unit: str, text: str) -> None:
    assert str(dimension(unit)) == text


def test_powers_that_cancel_are_gone() -> None:
    speed = dimension("m/s")
    assert speed * dimension("s/m") == speed / speed == speed**0 == Dimension({}) == dimension("rad")
