"""A kernel reads a law without a form from a table: the same number as the sum of all its hats gives, bit for bit."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import slide

from hjcamp.diagnosis.candidates.nonparametric_laws import ENDS, LAWS, gain_over, over_time_of_each
from hjcamp.diagnosis.candidates.nonparametric_terms import unknowns_of
from hjcamp.known_plants import find_plant
from hjcamp.model.compile.compose import Composition
from hjcamp.model.compile.function_sources import terms_source
from hjcamp.model.declare.effect import Effect, parameters_of
from hjcamp.model.declare.table import interpolated, rooted, table_of

GAINS = [
    gain_over("any", "drive", "demand", "level", "m"),
    gain_over("any", "capacity", "capacity", "level", "m", positive=True),
    gain_over("any", "oil", "oil", "level", "m", of="value"),
]
METHODS = [
    pytest.param(term.function, id=f"{law.__name__} of {slot}, {len(law.parameters)}")
    for law in (*LAWS, *GAINS, *over_time_of_each(18))
    for slot, term in law.terms.items()
]
PLACES = (-0.3, 0.0, 1e-9, 0.25, 0.5, 0.999, 1.0, 1.7, math.nan)


def as_a_kernel_says_it(method: Callable[..., float], given: dict[str, float]) -> float:
    table = table_of(method)
    assert table is not None
    names = {"interpolated": interpolated, "rooted": rooted, "floor": math.floor}
    first = list(given).index(table.first)
    text = table.text.replace("{table}", f"p, {first}, {table.count}")
    return float(eval(text, {**names, **given, "p": np.array(list(given.values()))}))


@pytest.mark.parametrize("method", METHODS)
def test_the_table_gives_what_the_sum_of_hats_gives(method: Callable[..., float]) -> None:
    draw = np.random.default_rng(7)
    names = parameters_of(method)
    knots = table_of(method).count  # type: ignore[union-attr]
    driven = [name for name in names if name not in ENDS and not name.startswith(("knot_", "conditions_"))]
    for place in (*PLACES, *(k / (knots - 1) for k in range(knots)), *draw.uniform(0.0, 1.0, 40)):
        given = {name: float(draw.normal()) for name in names}
        low, high = given[ENDS[0]], given[ENDS[0]] + 1.5
        given |= {ENDS[1]: high} | dict.fromkeys(driven, low + place * (high - low))
        if math.isnan(place) and "floor" in str(table_of(method)):
            continue  # as plain Python, which has no floor of what is no number
        np.testing.assert_array_equal(as_a_kernel_says_it(method, given), method(**given))


def test_laws_of_a_plant_share_one_function(tmp_path: Path) -> None:
    (tmp_path / "slide.py").write_text(slide.PLANT, encoding="utf-8")
    plant = find_plant("slide", folders=[tmp_path])
    wide: Any = type("Everywhere", (dict,), {"get": lambda self, key, other=None: (-1.0, 1.0)})()
    laws: list[type[Effect]] = [one.effect for one in unknowns_of(plant, wide).values()]
    text = terms_source(Composition(plant, tuple(laws), gated=True))
    assert len(laws) > 4
    assert text.count("\ndef ") == 2  # interpolated and rooted
