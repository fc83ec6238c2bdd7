r"""The forms that a found curve is compared with: laws that engineers write, of at most three parameters.

``x`` is what drives the law, y its value; a, b, c are its parameters. Each text is a formula of Python, as effect files have them.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.language.amount import unit_product

Array = NDArray[Any]
# What a formula may call; an effect file gets them from Python's own mathematics.
CALLED = ("copysign", "exp", "log1p", "pow", "sin", "sqrt", "tanh")
VECTORS: dict[str, Callable[..., Any]] = {
    "abs": np.abs, "copysign": np.copysign, "exp": np.exp, "log1p": np.log1p, "max": np.maximum, "min": np.minimum, "pow": np.power,
    "sin": np.sin, "sqrt": np.sqrt, "tanh": np.tanh,
}  # fmt: skip


# What stands in a formula of Python, and how people read it, in this order.
SAID = (
    ("((x - b) / c) * ((x - b) / c)", "((x - b) / c)^2"),
    ("(x / c) * (x / c)", "(x / c)^2"),
    ("x * x * x * x", "x^4"),
    ("x * x * x", "x^3"),
    ("x * x", "x^2"),
    ("copysign(1.0, x)", "sgn(x)"),
    ("copysign(sqrt(abs(x)), x)", "sgn(x) sqrt(|x|)"),
    ("copysign(log1p(abs(x / b)), x)", "sgn(x) ln(1 + |x / b|)"),
    ("pow(abs(x / r), b)", "|x / r|^b"),
    ("abs(x)", "|x|"),
    ("0.0)", "0)"),
    (" * ", " "),
)


@dataclass(frozen=True)
class Shape:
    """A parameter that enters non-linearly: its ``kind`` says where it is looked for.

    A place lies in the range of the driver, a pole outside it, a width, a length (of either sign) and a threshold are parts of that
    range, a rate is so many radians over one unit of the driver, a phase an angle, an exponent a number.
    """

    kind: str
    starts: Callable[[float, float, float], Array]
    bounds: Callable[[float, float, float], tuple[float, float]]


PLACE = Shape("place", lambda low, high, gap: np.linspace(low, high, 11), lambda low, high, gap: (low, high))
# narrower than the knots are apart nothing is seen of it, wider than the range it is another form
WIDTH = Shape(
    "width",
    lambda low, high, gap: np.asarray(np.geomspace(0.7 * gap, high - low, 7)),
    lambda low, high, gap: (0.5 * gap, 3.0 * (high - low)),
)
THRESHOLD = Shape(
    "threshold",
    lambda low, high, gap: max(abs(low), abs(high)) * np.linspace(0.08, 0.9, 9),
    lambda low, high, gap: (0.02 * max(abs(low), abs(high)), max(abs(low), abs(high))),
)
SCALE = Shape(
    "scale",
    lambda low, high, gap: max(abs(low), abs(high)) * np.geomspace(0.03, 3.0, 9),
    lambda low, high, gap: (0.01 * max(abs(low), abs(high)), 10.0 * max(abs(low), abs(high))),
)
LENGTH = Shape(
    "length",
    lambda low, high, gap: (high - low) * np.array([-2.0, -1.0, -0.5, -0.25, -0.12, 0.12, 0.25, 0.5, 1.0, 2.0]),
    lambda low, high, gap: (-5.0 * (high - low), 5.0 * (high - low)),
)
POLE = Shape(
    "pole",
    lambda low, high, gap: np.concatenate(
        [low - (high - low) * np.geomspace(0.03, 3.0, 7), high + (high - low) * np.geomspace(0.03, 3.0, 7)]
    ),
    lambda low, high, gap: (low - 10.0 * (high - low), high + 10.0 * (high - low)),
)
# from half a turn over the range to one turn over two and a half knots
RATE = Shape(
    "rate",
    lambda low, high, gap: 2.0 * math.pi * np.arange(0.25, (high - low) / (2.5 * gap) + 0.1, 0.125) / (high - low),
    lambda low, high, gap: (math.pi / (2.0 * (high - low)), 2.0 * math.pi / (2.2 * gap)),
)
PHASE = Shape(
    "phase", lambda low, high, gap: np.arange(4) * math.pi / 4.0, lambda low, high, gap: (-2.0 * math.pi, 2.0 * math.pi)
)
EXPONENT = Shape(
    "exponent",
    lambda low, high, gap: np.array([0.2, 0.35, 0.5, 0.75, 1.3, 1.5, 2.0, 3.0, 4.0, 5.0]),
    lambda low, high, gap: (0.1, 8.0),
)


@dataclass(frozen=True)
class Form:
    """One form: its ``text`` in x and the names of its parameters, in order, each with the powers of y and x that its unit has.

    ``shapes`` are those that enter non-linearly; ``reference`` says that x comes as a share of its largest size r.
    """

    name: str
    words: str
    text: str
    latex: str
    parameters: dict[str, tuple[float, float]]
    shapes: dict[str, Shape]
    reference: bool = False

    @cached_property
    def linear(self) -> list[str]:
        """The parameters that enter linearly."""
        return [name for name in self.parameters if name not in self.shapes]

    @cached_property
    def _code(self) -> Any:
        return compile(self.text, f"<form {self.name}>", "eval")

    def __call__(self, x: Array, values: Sequence[float] | Array, reference: float = 1.0) -> Array:
        """Return the law at ``x`` (n,) for its parameters in order."""
        scope = VECTORS | dict(zip(self.parameters, values, strict=True)) | {"x": x, "r": reference, "__builtins__": {}}
        with np.errstate(all="ignore"):
            return np.broadcast_to(np.asarray(eval(self._code, scope), dtype=np.float64), x.shape)

    @property
    def said(self) -> str:
        """The formula as people read it: ``a exp(-((x - b) / c)^2)``."""
        text = self.text
        for written, read in SAID:
            text = text.replace(written, read)
        return text

    def written(self, expression: str) -> str:
        """Return the formula with an expression in the place of the driver."""
        inner = expression if expression.isidentifier() else f"({expression})"
        return re.sub(r"\bx\b", lambda _: inner, self.text).replace(" r)", " reference)")


SIGN = r"\operatorname{sgn}"
FORMS: dict[str, Form] = {
    one.name: one
    for one in (
        Form("constant", "a constant", "a", "a", {"a": (1, 0)}, {}),
        Form("proportional", "proportional", "a * x", "a x", {"a": (1, -1)}, {}),
        Form("linear", "a straight line", "a * x + b", "a x + b", {"a": (1, -1), "b": (1, 0)}, {}),
        Form(
            "parabola", "a parabola", "a * x * x + b * x + c", "a x^2 + b x + c", {"a": (1, -2), "b": (1, -1), "c": (1, 0)}, {}
        ),
        Form("signed_square", "the square with its sign", "a * x * abs(x)", r"a x |x|", {"a": (1, -2)}, {}),
        Form(
            "square_and_linear", "the square with its sign, and linear", "a * x * abs(x) + b * x", r"a x |x| + b x",
            {"a": (1, -2), "b": (1, -1)}, {},
        ),
        Form("cubic", "the cube", "a * x * x * x", "a x^3", {"a": (1, -3)}, {}),
        Form("cubic_and_linear", "the cube, and linear", "a * x * x * x + b * x", "a x^3 + b x", {"a": (1, -3), "b": (1, -1)}, {}),
        Form("fourth_power", "the fourth power", "a * x * x * x * x", "a x^4", {"a": (1, -4)}, {}),
        Form(
            "root", "the root with its sign", "a * copysign(sqrt(abs(x)), x)", rf"a {SIGN}(x) \sqrt{{|x|}}", {"a": (1, -0.5)}, {}
        ),
        Form(
            "power", "a power with its sign", "a * copysign(1.0, x) * pow(abs(x / r), b)", rf"a {SIGN}(x) |x / r|^b",
            {"a": (1, 0), "b": (0, 0)}, {"b": EXPONENT}, reference=True,
        ),
        Form(
            "even_power", "a power of the size", "a * pow(abs(x / r), b)", r"a |x / r|^b", {"a": (1, 0), "b": (0, 0)},
            {"b": EXPONENT}, reference=True,
        ),
        Form("coulomb", "a constant with the sign", "a * copysign(1.0, x)", rf"a {SIGN}(x)", {"a": (1, 0)}, {}),
        Form(
            "coulomb_and_viscous", "a constant with the sign, and linear", "a * copysign(1.0, x) + b * x", rf"a {SIGN}(x) + b x",
            {"a": (1, 0), "b": (1, -1)}, {},
        ),
        Form(
            "stribeck", "Stribeck's", "copysign(1.0, x) * (a + b * exp(-(x / c) * (x / c)))",
            rf"{SIGN}(x) \left(a + b\,e^{{-(x / c)^2}}\right)", {"a": (1, 0), "b": (1, 0), "c": (0, 1)}, {"c": SCALE},
        ),
        Form("saturation", "a smooth saturation", "a * tanh(x / b)", r"a \tanh\frac{x}{b}", {"a": (1, 0), "b": (0, 1)}, {"b": SCALE}),
        Form(
            "limit", "linear up to a limit", "a * max(-b, min(x, b))", r"a \max(-b, \min(x, b))", {"a": (1, -1), "b": (0, 1)},
            {"b": THRESHOLD},
        ),
        Form(
            "dead_band", "linear beyond a dead band", "a * (x - max(-b, min(x, b)))", r"a \left(x - \max(-b, \min(x, b))\right)",
            {"a": (1, -1), "b": (0, 1)}, {"b": THRESHOLD},
        ),
        Form(
            "stop_above", "linear above a place", "a * max(x - b, 0.0)", r"a \max(x - b, 0)", {"a": (1, -1), "b": (0, 1)}, {"b": PLACE}
        ),
        Form(
            "stop_below", "linear below a place", "a * min(x - b, 0.0)", r"a \min(x - b, 0)", {"a": (1, -1), "b": (0, 1)}, {"b": PLACE}
        ),
        Form(
            "exponential", "an exponential", "a * exp(x / b) + c", "a\\,e^{x / b} + c", {"a": (1, 0), "b": (0, 1), "c": (1, 0)},
            {"b": LENGTH},
        ),
        Form(
            "logarithm", "a logarithm with its sign", "a * copysign(log1p(abs(x / b)), x)", rf"a {SIGN}(x) \ln\left(1 + |x / b|\right)",
            {"a": (1, 0), "b": (0, 1)}, {"b": SCALE},
        ),
        Form("hyperbola", "a hyperbola", "a / (x - b)", r"\frac{a}{x - b}", {"a": (1, 1), "b": (0, 1)}, {"b": POLE}),
        Form(
            "shifted_hyperbola", "a hyperbola and a constant", "a / (x - b) + c", r"\frac{a}{x - b} + c",
            {"a": (1, 1), "b": (0, 1), "c": (1, 0)}, {"b": POLE},
        ),
        Form(
            "sine", "a sine", "a * sin(b * x + c)", r"a \sin(b x + c)", {"a": (1, 0), "b": (0, -1), "c": (0, 0)},
            {"b": RATE, "c": PHASE},
        ),
        Form(
            "bell", "a bell", "a * exp(-((x - b) / c) * ((x - b) / c))", r"a\,e^{-((x - b) / c)^2}",
            {"a": (1, 0), "b": (0, 1), "c": (0, 1)}, {"b": PLACE, "c": WIDTH},
        ),
    )
}  # fmt: skip


def unit_of(form: Form, name: str, y_unit: str, x_unit: str) -> str:
    """Return the unit of a parameter of a form in SI: ``N*s/m`` of the slope of a force over a velocity."""
    power_y, power_x = form.parameters[name]
    return unit_product(((y_unit, power_y), (x_unit, power_x)))
