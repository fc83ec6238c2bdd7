"""Elements that get the wrong thing first say what they take."""

from __future__ import annotations

import ast

import pytest

from hjcamp.errors import UsageError
from hjcamp.model.declare.element import expand


def test_a_store_takes_what_flows_in_not_its_state() -> None:
    [line] = ast.parse("rate.upper = store(state.upper, inflow - between)").body
    assert isinstance(line, ast.Assign) and isinstance(line.value, ast.Call)
    said = r"^line 9: store\(\.\.\.\) takes inflow, capacity, stiffness; the first is inflow, not the state: rate.upper"
    with pytest.raises(UsageError, match=said):
        expand(line.value, "upper", "upper", False, "line 9")
