"""Which formula a curve is: fitted through its straight pieces with its covariance, ranked, with intervals, or none at all."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.formulas.__main__ import OUTSIDE, rig_curve
from hjcamp.diagnosis.decision.formulas import Fit, formulas_of, proposed
from hjcamp.effects._forms import CALLED, FORMS, unit_of
from hjcamp.model.language.amount import dimension

HIDDEN = {
    "linear": (1.2, 0.4),
    "signed_square": (0.8,),
    "stribeck": (0.7, 1.1, 0.3),
    "exponential": (0.6, 0.5, -0.2),
    "dead_band": (1.5, 0.3),
    "sine": (0.9, 5.0, 1.1),
    "bell": (1.0, 0.2, 0.3),
    "hyperbola": (0.4, -1.4),
}


@pytest.mark.parametrize("name", HIDDEN)
def test_a_hidden_law_is_proposed_with_its_values(name: str) -> None:
    generator = np.random.default_rng(7)
    found = formulas_of(rig_curve(lambda x: FORMS[name](x, HIDDEN[name]), generator, 12, 0.02))
    one = next(each for each in proposed(found) if each.form.name == name)
    assert one.fits and len(proposed(found)) <= 3
    errors = np.sqrt(np.diag(one.covariance))
    # a sine turned by half a turn with the other sign is the same
    assert np.all(np.abs(one.values - HIDDEN[name]) <= 4.0 * errors) or name == "sine"
    x = np.linspace(-1.0, 1.0, 50)
    scale = np.ptp(FORMS[name](x, HIDDEN[name]))
    assert np.sqrt(np.mean((one.form(x, one.values) - FORMS[name](x, HIDDEN[name])) ** 2)) < 0.02 * scale


def test_a_law_that_no_form_is_fits_none() -> None:
    generator = np.random.default_rng(8)
    for law in OUTSIDE.values():
        seed = int(generator.integers(2**31))
        found = formulas_of(rig_curve(lambda x, s=seed, one=law: one(x, np.random.default_rng(s)), generator, 12, 0.02))
        assert not any(one.fits for one in found)
        # the nearest is there to be shown
        assert proposed(found) == found[:1]


def test_intervals_hold_the_hidden_value_as_often_as_they_say() -> None:
    generator, inside = np.random.default_rng(9), []
    for _ in range(60):
        curve = rig_curve(lambda x: FORMS["signed_square"](x, (1.0,)), generator, 12, 0.03)
        one = Fit(curve).fitted(FORMS["signed_square"])
        assert one is not None
        inside.append(abs(one.values[0] - 1.0) <= 1.96 * np.sqrt(one.covariance[0, 0]))
    # 95 %, and no more than chance beside it: 50 of 60 are fewer than once in 2000
    assert sum(inside) > 50


@pytest.mark.parametrize("form", FORMS.values(), ids=list(FORMS))
def test_every_form_has_units_and_reads_as_python(form: object) -> None:
    name = form.name  # type: ignore[attr-defined]
    one = FORMS[name]
    assert set(one.shapes) <= set(one.parameters) and len(one.parameters) <= 3
    for y_unit, x_unit in (("N*m", "rad"), ("m^3/s", "Pa"), ("1", "m/s")):
        for parameter in one.parameters:
            dimension(unit_of(one, parameter, y_unit, x_unit))
    scope = {
        "__builtins__": {},
        **{each: getattr(__import__("math"), each) for each in CALLED},
        "abs": abs,
        "min": min,
        "max": max,
    }
    values = [0.7, 0.4, 0.3][: len(one.parameters)]
    known = dict(zip(one.parameters, values, strict=True))
    for x in (-0.8, 0.1, 0.9):
        written = eval(one.written("speed - other"), scope | known | {"speed": x + 1.0, "other": 1.0, "reference": 2.0})
        assert written == pytest.approx(float(one(np.array([x]), values, 2.0)[0]), rel=1e-9)
    assert "*" not in one.said and "copysign" not in one.said


def test_units_are_as_engineers_write_them() -> None:
    assert unit_of(FORMS["proportional"], "a", "N", "m/s") == "N*s/m"
    assert unit_of(FORMS["cubic"], "a", "N*m", "rad") == "N*m/rad^3"
    assert unit_of(FORMS["sine"], "b", "N", "rad") == "1/rad" and unit_of(FORMS["sine"], "c", "N", "rad") == "1"
