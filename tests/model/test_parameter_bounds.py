"""A value at its bound may stand beyond it by the last of the digits that a file has; no more."""

from __future__ import annotations

import pytest

from hjcamp.configuration.saved_model import rounded
from hjcamp.errors import UsageError
from hjcamp.model.declare.parameter import Parameter


@pytest.mark.parametrize("bounds", [(0.1 * 12.0, 120.0), (1e-7 / 3.0, 2e-3 / 3.0), (-2.0 / 3.0, 2.0 / 3.0)])
def test_a_bound_that_was_written_is_read_again(bounds: tuple[float, float]) -> None:
    parameter = Parameter("V", 0.5 * sum(bounds) or 0.1, bounds)
    for bound in bounds:
        assert parameter.checked(rounded(bound), "reference") == bound
    low, high = bounds
    for value in (low - 1e-4 * abs(low), high + 1e-4 * abs(high)):
        with pytest.raises(UsageError, match="a number from"):
            parameter.checked(value, "reference")
