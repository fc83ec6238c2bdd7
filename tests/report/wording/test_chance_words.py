"""A p-value counted over replicates: it is never claimed finer than they can show."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hjcamp.report.wording.chance import p_words


@given(st.integers(1, 2000), st.data())
def test_a_bound_is_said_where_and_only_where_no_replicate_gained_as_much(replicates: int, data: st.DataObject) -> None:
    above = data.draw(st.integers(0, replicates))
    said = p_words((1 + above) / (1 + replicates), replicates)
    assert said.startswith("p <= " if above == 0 else "p = ")
    assert float(said.split()[-1]) == pytest.approx((1 + above) / (1 + replicates), rel=0.06)
