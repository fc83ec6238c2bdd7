"""A square root or a logarithm outside its range is told with the line of the file, not as a 'math domain error'."""

from __future__ import annotations

from math import log, sqrt
from pathlib import Path

import pytest

from hjcamp.errors import UsageError
from hjcamp.model.compile.compose import Composition
from hjcamp.model.compile.kernel import kernel_source
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.marks import signal
from hjcamp.model.declare.parameter import Parameter
from hjcamp.plants.pump_joint import PumpJoint

LINES = Path(__file__).read_text(encoding="utf-8").splitlines()


class Orifice(Effect):
    """A leak through an orifice, whose root is not held within its range."""

    subsystem = "lines"
    size = Parameter("m^3/(s*Pa**0.5)", 1e-12, (0.0, 1e-9))

    @staticmethod
    def leak1(
        pressure1: float,
        size: float,
    ) -> float:
        """Return the flow."""
        # a comment, which the copy does not have
        twice = 2.0 * size
        return twice * sqrt(pressure1)  # WRONG HERE


class Grown(Effect):
    """A force by a logarithm, in a branch."""

    subsystem = "joint"
    size = Parameter("N", 1.0, (0.0, 10.0))

    @staticmethod
    def load_force(slider_position: float, size: float) -> float:
        """Return the force."""
        if slider_position < 1e9:
            return size * log(slider_position / 1e-3)  # GROWN HERE
        return 0.0


def line_with(mark: str) -> int:
    """Return the number of the line of this file that ends with a mark."""
    return next(number for number, text in enumerate(LINES, start=1) if text.endswith(f"  # {mark}"))


@pytest.mark.parametrize(
    ("effect", "mark", "told"),
    [(Orifice, "WRONG HERE", "outside its range"), (Grown, "GROWN HERE", "sqrt or log of a negative")],
)
@pytest.mark.parametrize("gated", [False, True])
def test_an_effect_names_its_line(effect: type[Effect], mark: str, told: str, gated: bool) -> None:
    effect.name = effect.__name__.lower()
    with pytest.raises(UsageError) as caught:
        kernel_source(Composition(PumpJoint, (effect,), gated=gated))
    said = str(caught.value)
    assert f"test_outside_range.py, line {line_with(mark)}: '" in said and told in said and "max(x, 0.0)" in said
    assert "\n" not in said and "math domain error" not in said


def test_a_plant_names_its_line() -> None:
    class Rooted(PumpJoint):
        """The pump joint with one more line."""

        name = "rooted"

        @staticmethod
        def equations(state, parameter, drive, rate):  # type: ignore[no-untyped-def]
            """Give the rates."""
            depth = signal(
                log(state.pressure1 / 1.0),  # the statement begins a line before
                "1",
                "logarithm of the pressure",
            )
            rate.pump_position = depth
            rate.pump_velocity = state.pump_velocity
            rate.pump_acceleration = state.pump_acceleration
            rate.pressure1 = state.pressure1
            rate.pressure2 = state.pressure2
            rate.slider_position = state.slider_velocity
            rate.slider_velocity = state.slider_velocity
            return depth, depth, depth, depth

    with pytest.raises(UsageError) as caught:
        kernel_source(Composition(Rooted))
    number = next(number for number, text in enumerate(LINES, start=1) if "depth = signal(" in text and "in text" not in text)
    assert f"test_outside_range.py, line {number}: 'depth = signal('" in str(caught.value)
