"""The picture of all conditions: means with their deviations, none of them cut at the end of an axis."""

from __future__ import annotations

from typing import Any

import pytest
from matplotlib.figure import Figure

from hjcamp.report.pictures import dot_plot
from hjcamp.report.pictures.dot_plot import Dots, draw_dots


def test_values_that_lie_close_together_are_not_cut(monkeypatch: pytest.MonkeyPatch) -> None:
    figure = Figure()

    def paint_only(size: Any, name: str, paint: Any) -> str:
        paint(figure)
        return ""

    monkeypatch.setattr(dot_plot, "draw", paint_only)
    values = {("a", "rmse1_deg"): (2.10, 0.05), ("b", "rmse1_deg"): (2.57, 0.02)}
    draw_dots(["a", "b"], ["rmse1_deg"], [Dots("simulated", values)])
    assert figure.axes[0].get_xlim() == pytest.approx((0.0, 1.05 * 2.59))
