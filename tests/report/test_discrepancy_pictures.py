"""Pictures and pages of a comparison and a diagnosis: what is zoomed, equal content, nothing unescaped."""

from __future__ import annotations

import numpy as np

from hjcamp.report.discrepancy_figures import Overlay, draw_errors, draw_map, draw_overlay, worst_part
from hjcamp.report.discrepancy_page import bullets, discrepancy_page, place_table
from hjcamp.report.unexplained_figure import draw_unexplained

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
    short = Overlay("short", TIME[:40], np.zeros((40, 3)), {"published": np.ones((40, 3))})
    assert worst_part(short) == slice(0, 40)


def test_equal_content_gives_equal_pictures() -> None:
    svg = draw_overlay(overlay())
    assert svg == draw_overlay(overlay()) and "the 0.5 s shaded" in svg and "bench" in svg


def test_bars_and_maps_name_what_they_show() -> None:
    errors = draw_errors([("published", 15.5), ("calibrated", 14.1), ("with leakage", 1.15), ("floor", 1.0)])
    assert all(name in errors for name in ("published", "calibrated", "with leakage", "floor", "15.50"))
    nothing = np.zeros(0)
    svg = draw_map(nothing, nothing, nothing, [("", "joint", 0.9), ("joint, by direction", "positive", 0.5)])
    assert "joint, by direction" in svg and "all: all" not in svg and "hardly slides" in svg


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
