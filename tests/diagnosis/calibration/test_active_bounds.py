"""Base parameters that a start which nothing measures hides: each test has one of its own."""

from __future__ import annotations

from pathlib import Path

import pytest

from hjcamp.errors import UsageError
from hjcamp.known_plants import find_plant
from hjcamp.model.checks.plant_bench import identified


def test_a_store_that_nothing_measures_may_have_any_size(tanks: Path) -> None:
    assert identified(find_plant("tanks")) == "3 base parameters, each by itself"
    # what leaves the upper tank and what reaches the lower one apart: a larger tank with a faster pump does the same
    file = Path("plants/tanks.py")
    text = file.read_text().replace("store(between - outflow)", "store(parameter.k2 / parameter.k1 * between - outflow)")
    text = text.replace("    k3 = ", '    k2 = Parameter("V**0.5/s", 0.04, (1e-4, 1.0), "log-uniform", base=True)\n    k3 = ')
    file.write_text(text)
    with pytest.raises(UsageError, match=r"moves together with .*k4") as refusal:
        identified(find_plant("tanks"))
    assert str(refusal.value).count("the start of upper") == 1
