"""Pictures and pages of a comparison and a diagnosis: what is zoomed, equal content, nothing unescaped."""

from __future__ import annotations

import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hjcamp.plants.pump_joint.answers.compare_map import blamed
from hjcamp.plants.pump_joint.figures.discrepancy import (
    HorizonCurve,
    Map,
    Overlay,
    cells_of,
    draw_horizon,
    draw_map,
    draw_overlay,
    largest,
    worst_part,
)
from hjcamp.plants.pump_joint.figures.unexplained import draw_unexplained
from hjcamp.report.pages.discrepancy_page import bullets, discrepancy_page, picture, place_table
from hjcamp.report.pictures.conditions import PAPER, tidy
from hjcamp.report.pictures.drawing import draw_errors

TIME = np.arange(500) * 0.004


def overlay() -> Overlay:
    """Return a test whose first model is off between 1.2 and 1.5 s, the second one everywhere."""
    measured = np.zeros((500, 3))
    first = measured.copy()
    first[300:375, 0] = 5.0
    return Overlay("ramp", TIME, measured, {"published": first, "bench": measured + 9.0})


def test_the_zoom_is_where_the_first_model_is_worst() -> None:
    part = worst_part(overlay())
    assert part.start <= 300 and part.stop >= 375 and part.stop - part.start == 125
    short = Overlay("short", TIME[:40], np.zeros((40, 3)), {"published": np.ones((40, 3))}, "simulated")
    assert ">simulated<" in draw_overlay(short)
    assert worst_part(short) == slice(0, 40)


def test_equal_content_gives_equal_pictures() -> None:
    svg = draw_overlay(overlay())
    assert svg == draw_overlay(overlay()) and "the 0.5 s shaded" in svg and "bench" in svg


def test_bars_and_maps_name_what_they_show() -> None:
    errors = draw_errors(
        [("published", 15.5), ("calibrated", 14.1), ("with leakage", 1.15), ("floor", 1.0)], "error / noise floor"
    )
    assert all(name in errors for name in ("published", "calibrated", "with leakage", "floor", "15.50"))
    empty = Map(*[np.zeros(0)] * 4, "Speed of the sliders (mm/s)", "Arm angle (deg)", "Missing force (N)")
    svg = draw_map(empty, [("", "joint", 0.9), ("joint, by direction", "positive", 0.5)])
    assert "joint, by direction" in svg and "all: all" not in svg and "nowhere slides long and steadily enough" in svg
    assert "Speed of the sliders" not in svg  # no empty grid


def scattered(size: float) -> Map:
    """Return 12 tests with a force of 1 N at speeds above zero and none below, with noise of ``size`` (N)."""
    random = np.random.default_rng(5)
    test = np.repeat(np.arange(12), 400)
    x, y = random.uniform(-10.0, 10.0, (2, len(test)))
    values = np.where(x > 0.0, 1.0, 0.0) + size * random.standard_normal(len(x))
    return Map(x, y, values, test, "x", "y", "Missing force (N)")


@pytest.mark.parametrize(("size", "clear"), [(0.01, True), (20.0, False)])
def test_cells_of_a_map_are_clear_where_tests_agree(size: float, clear: bool) -> None:
    edges, mean, error = cells_of(scattered(size))
    right = edges[0][:-1] > 0.0
    shown = np.abs(mean) > 2.0 * error
    assert shown[right].mean() > 0.95 if clear else shown.mean() < 0.3
    if clear:
        assert mean[right] == pytest.approx(1.0, abs=0.05) and largest(scattered(size)) == pytest.approx(1.0, abs=0.05)
    # one test alone tells nothing of scatter: all of it is pale
    one = scattered(size)
    alone = one._replace(of_test=np.zeros(len(one.x)))
    assert np.isinf(cells_of(alone)[2]).all()


def test_the_map_is_of_what_is_to_blame_first() -> None:
    def model(*subsystems: str) -> Any:
        return SimpleNamespace(places=[SimpleNamespace(variable="all", subsystem=one) for one in subsystems])

    found = [blamed(model(*one)) for one in (("joint", "lines"), ("lines", "joint"), ("pump", "lines"), ("pump",), ())]
    assert found == ["joint", "lines", "lines", "joint", "joint"]


def test_coordinates_lose_decimals_and_what_people_read_does_not() -> None:
    assert tidy('<svg><path d="M 1.23456 0.98765"/><text x="3.14159">0.00125</text></svg>') == (
        '<svg><path d="M 1.23 0.98"/><text x="3.14">0.00125</text></svg>'
    )


def test_the_unexplained_curve_leaves_out_what_was_not_seen() -> None:
    angle = np.linspace(-60.0, 60.0, 12)
    svg = draw_unexplained("Arm angle (deg)", "Force (N)", angle, np.where(angle > 0, np.nan, angle), angle)
    assert "Arm angle (deg)" in svg and "even: " in svg and "nan" not in svg


def test_a_page_escapes_what_it_is_given() -> None:
    row = {"subsystem": "joint", "variable": "arm_angle", "bin": "positive, 0 to 20 deg", "share": 0.123, "z": -9.0}
    page = discrepancy_page("<b>", "a & b", [bullets(["<i>"]), place_table([row] * 9), ""])
    assert "<b>" not in page and "<i>" not in page and "a &amp; b" in page
    assert page.count("positive, 0 to 20 deg") == 8 and "8 of 9 rows" in page
    assert place_table([]) == "" and bullets([]) == ""


LINE, NOTHING = np.linspace(0.0, 1.0, 12), np.zeros(0)
BARS = [("", "joint", 0.9), ("joint, by direction", "positive", 0.5)]
# Every picture of the pages of compare and diagnose, but the cells of the map.
PICTURES = {
    "overlay": lambda: draw_overlay(overlay()),
    "errors": lambda: draw_errors([("published", 6.1), ("floor", 1.0)], "error / noise floor"),
    "horizon": lambda: draw_horizon([HorizonCurve("published", LINE, LINE)], LINE),
    "where": lambda: draw_map(Map(NOTHING, NOTHING, NOTHING, NOTHING, "", "", ""), BARS),
    "unexplained": lambda: draw_unexplained("Arm angle (deg)", "Force (N)", LINE, LINE, -LINE),
}


@pytest.mark.parametrize("name", PICTURES)
def test_ink_and_paper_of_pictures_follow_the_page(name: str) -> None:
    svg = PICTURES[name]()
    assert PAPER in svg, "a picture of its own has its own paper"
    shown = picture("Where", svg)
    assert re.findall(r"#[0-9a-fA-F]{6}", shown) == [] and "black" not in shown
    assert "var(--paper)" in shown and 'aria-label="Where"' in shown
    texts = re.findall(r"<text[^>]*>", shown)
    assert texts and all("currentColor" in text for text in texts)


def test_letters_stay_readable_on_a_narrow_page() -> None:
    svg = draw_overlay(overlay())
    wide = float(re.search(r'viewBox="0 0 ([\d.]+) ', svg)[1])  # type: ignore[index]
    least = float(re.search(r"min-width: (\d+)px", picture("x", svg))[1])  # type: ignore[index]
    # the smallest letters have 8 points in it
    assert 8 * least / wide > 9.0
    page = discrepancy_page("t", "", [])
    assert "figure { margin: 0 0 1rem; overflow-x: auto; }" in page


@pytest.mark.parametrize("scheme", ["--ink", "--paper", "--grid", "--blue", "--red", "--green"])
def test_the_page_has_every_shade_for_light_and_dark(scheme: str) -> None:
    style = discrepancy_page("t", "", [])
    light, dark = style.split("@media (prefers-color-scheme: dark)")
    assert f"{scheme}: #" in light and f"{scheme}: #" in dark
