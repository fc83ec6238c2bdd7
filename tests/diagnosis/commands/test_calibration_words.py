"""What the answer says of base parameters that their bounds hold."""

from __future__ import annotations

import pytest

from hjcamp.commands.any_plant.remarks.bound_words import ends_of_laws, held_by_bounds, late_inputs, other_sizes
from hjcamp.commands.any_plant.remarks.outside_words import seldom
from hjcamp.commands.any_plant.words import calibration_table
from hjcamp.effects import effect_files


def row(value: float, low: float, high: float, at_bound: bool) -> dict[str, dict[str, object]]:
    return {"push_gain": {"published": 1.0, "value": value, "unit": "N", "ci95": [low, high], "at_bound": at_bound}}


def test_a_parameter_that_its_bound_keeps_from_what_is_declared_asks_for_a_sign() -> None:
    at_bound = row(0.02, 0.02, 0.3, True)
    at_bound["push_gain"]["held"] = True
    [said] = held_by_bounds(at_bound)
    assert said.startswith("push gain is held by its bound, 0.02 N, far") and "a sign or a unit" in said
    assert calibration_table(at_bound)[0][-1].endswith("  at its bound")


def test_a_parameter_at_its_bound_that_the_tests_do_not_tell_asks_whether_they_can() -> None:
    untold = row(0.02, 0.02, 3.0, True)
    assert held_by_bounds(untold) == []
    untold["push_gain"]["told"] = False
    [said] = held_by_bounds(untold)
    assert (
        said.startswith("push gain stands at its bound, 0.02 N, and these tests do not determine it")
        and "a sign or a unit" in said
    )


def test_what_was_found_beside_is_marked_where_a_bound_stops_it() -> None:
    [line] = calibration_table(row(0.3, 0.2, 0.4, False), row(3.0, 1.0, 3.0, True))
    assert line == ["push gain", "1 N", "0.30 N", "0.20 to 0.40", "3.0 N  at its bound"]


def test_no_friction_at_all_and_a_delay_at_its_longest_are_no_wrong_sign() -> None:
    none = row(0.0, 0.0, 0.3, True)
    none["push_gain"]["told"] = False
    assert held_by_bounds(none) == [] and not calibration_table(none)[0][-1].endswith("bound")
    late = {"delay.current": row(0.004, 0.003, 0.004, True)["push_gain"] | {"published": 0.0, "unit": "s"}}
    assert held_by_bounds(late) == [] and calibration_table(late)[0][-1].endswith("at its bound")


@pytest.mark.parametrize(
    ("value", "low", "at_bound", "said"),
    [
        (0.004, 0.003, True, ["stands at the most"]),
        (0.0022, 0.0021, False, ["The current acts 0.0022 s late, more than"]),
        (0.0022, 0.0019, False, []),
        (-0.002, -0.002, True, []),
    ],
)
def test_a_delay_that_no_log_is_off_by_is_said(value: float, low: float, at_bound: bool, said: list[str]) -> None:
    late = {"delay.current": row(value, low, 0.004, at_bound)["push_gain"]}
    found = late_inputs(late, ["spring"], 0.002)
    assert len(found) == len(said) and all(one in whole for one, whole in zip(said, found, strict=True))
    beside = late_inputs(late, ["sensor_lag_at_scale"], 0.002)
    assert len(beside) == len(said) and all("the total lag is the sum" in one and "current by" in one for one in beside)


@pytest.mark.parametrize(
    ("value", "told", "width", "at_bound", "said"),
    [
        (6.8e-5, True, 9e-4, True, True),
        (3e-5, True, 9e-4, True, False),  # not far from what is declared
        (6.8e-5, False, 9e-4, True, False),
        (6.8e-5, True, 9e-4, False, False),
        (6.8e-5, True, 0.0, True, False),  # a natural bound
        (0.4e-5, True, 9e-4, True, True),
    ],
)
def test_bounds_that_follow_from_declared_sizes_are_told(
    value: float, told: bool, width: float, at_bound: bool, said: bool
) -> None:
    base = {"gain": {"published": 2e-5, "value": value, "unit": "N*m", "ci95": [value, value], "at_bound": False}}
    if not told:
        base["gain"]["told"] = False
    row = {"value": width, "unit": "N*m", "ci95": [0.0, 9e-4], "at_bound": at_bound}
    found = other_sizes(base, [{"effect": "dead_band", "heldout_error_ratio": 0.9, "parameters": {"width": row}}])
    assert bool(found) == said
    assert not said or ("gain is" in found[0] and "dead_band may stand at a bound" in found[0])
    # nor of a share, which has the same bounds on every plant
    share = {"blocked": row | {"unit": "1"}}
    assert other_sizes(base, [{"effect": "check_valve", "heldout_error_ratio": 0.1, "parameters": share}]) == []
    # of what predicts worse than nothing no bound is of interest
    assert other_sizes(base, [{"effect": "dead_band", "heldout_error_ratio": 1.04, "parameters": {"width": row}}]) == []


@pytest.mark.parametrize(("at_bound", "told", "named", "said"), [
    (True, True, "stribeck_excess", 1), (False, True, "stribeck_excess", 0), (True, False, "stribeck_excess", 0),
    (True, True, "spring", 0),
])  # fmt: skip
def test_a_shape_at_its_bound_asks_for_another_law(at_bound: bool, told: bool, named: str, said: int) -> None:
    shape = {"value": 250.0, "unit": "rad/s", "ci95": [205.0, 250.0], "at_bound": at_bound, **({} if told else {"told": False})}
    excess = {"value": 0.04, "unit": "N*m", "ci95": [0.03, 0.05], "at_bound": True}
    rows = [{"effect": "stribeck_excess", "parameters": {"excess": excess, "stribeck_speed": shape}}]
    found = ends_of_laws([named], rows, effect_files())
    assert len(found) == said and all(one.startswith("stribeck speed of stribeck_excess stands at the end") for one in found)


def test_what_acts_in_few_parts_of_the_tests_is_said_though_it_is_not_shown() -> None:
    rows = [
        {"effect": "leakage", "heldout_error_ratio": 0.88, "t": 4.5, "t_needed": 83.0, "parameters": {}},
        {"effect": "overflow", "heldout_error_ratio": 0.856, "t": 4.2, "t_needed": 85.0, "parameters": {}},
    ]
    [said] = seldom(rows, 0.24)
    assert (
        said.startswith("overflow would take 14 %, but in too few parts of the tests") and "record more of the motion" in said
    )
    delay = {"delay": {"value": 0.372, "unit": "s"}, "dead_share": {"value": 0.5, "unit": "1"}}
    [said] = seldom([rows[1] | {"effect": "command_delay", "parameters": delay}], 0.24)
    assert "a window of 0.24 s is short relative to its 0.37 s: longer tests have longer windows" in said
    assert "record more" in seldom([rows[1] | {"parameters": delay}], 1.2)[0]
    # too little, no better than none, and shown
    others = ({"heldout_error_ratio": 0.95}, {"t": -0.5}, {"t": 90.0})
    assert not any(seldom([rows[1] | other], 0.24) for other in others)
