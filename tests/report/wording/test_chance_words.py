"""A p-value counted over replicates: it is never claimed finer than they can show."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hjcamp.report.wording.chance import chance_words, p_words


def test_the_gain_stands_with_those_by_chance() -> None:
    drawn = np.linspace(2.0, 6.0, 24)
    assert chance_words(1 / 25, 158.0, drawn) == "p <= 0.04, the least that 24 replicates can show; gain 158 against at most 6"
    assert chance_words(3 / 25, 5.9, drawn) == "p = 0.12; gain 5.9 against at most 6"
    assert chance_words(0.5, 1.0, []) == "p = 0.5"


@given(st.integers(1, 2000), st.data())
def test_a_bound_is_said_where_and_only_where_no_replicate_gained_as_much(replicates: int, data: st.DataObject) -> None:
    above = data.draw(st.integers(0, replicates))
    said = p_words((1 + above) / (1 + replicates), replicates)
    assert said.startswith("p <= " if above == 0 else "p = ")
    assert float(said.split()[-1]) == pytest.approx((1 + above) / (1 + replicates), rel=0.06)
