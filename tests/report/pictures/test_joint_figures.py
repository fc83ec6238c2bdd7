"""The figures of the configured joint: its friction (4.5.2), the load of its payload (5.5.9)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from hjcamp.configuration.composer import Composer
from hjcamp.plants.pump_joint.figures.joint import figures_of, largest_load, load_over_angle


def painted(name: str, *overrides: str) -> Any:
    """Return the axes of a figure of a configuration."""
    figure = Figure()
    figures_of(Composer().compose(list(overrides)).config)[name][1](figure)
    return figure.axes[0]


def test_the_load_of_the_payload_is_that_of_the_print() -> None:
    # 8.5 g at 20 mm round a pulley of 3.41 mm: 0.0085 * 9.81 * 20 / 3.41 = 0.489 N, printed 0.49
    config = Composer().compose(["payload=brass_8p5g", "orientation=vertical"]).config
    largest, rest = largest_load(config)
    assert largest == pytest.approx(0.0085 * 9.81 * 20 / 3.41) and round(largest, 2) == 0.49 and rest == 0.0
    # it pulls back to where it hangs, and most at a right angle
    angle = np.radians([-90.0, 0.0, 30.0, 90.0])
    assert load_over_angle(angle, largest, 0.0) == pytest.approx([largest, 0.0, -largest / 2, -largest])
    assert load_over_angle(angle, largest, math.pi / 2)[3] == pytest.approx(0.0)


def test_twice_the_payload_pulls_twice_and_none_does_not() -> None:
    curves = [
        painted("figure_5_5_9", *words).lines[0].get_ydata()
        for words in (["payload=brass_8p5g"], ["payload=brass_8p5g", "payload.mass_g=17"], [])
    ]
    assert curves[1] == pytest.approx(2.0 * curves[0]) and np.ptp(curves[0]) > 0.9 and not np.any(curves[2])


def test_no_payload_has_an_axis_in_newtons() -> None:
    axes = painted("figure_5_5_9")
    axes.figure.canvas.draw()
    assert axes.get_ylim() == (-0.1, 0.1)


def test_the_friction_drawn_is_the_configured_one() -> None:
    for friction, numbers in (("first_state", (2.02, 1.22, 19.9)), ("bidirectional", (7.20, 5.27, 23.5))):
        axes = painted("figure_4_5_2", f"friction={friction}")
        static, coulomb, viscous = numbers
        label = f"positive: static {static:g} N, Coulomb {coulomb:g} N, viscous {viscous:g} N s/m"
        line = next(one for one in axes.lines if one.get_label() == label)
        speed, force = line.get_xdata() * 1e-3, line.get_ydata()
        assert force == pytest.approx(coulomb + viscous * speed)
        assert any(max(one.get_ydata()) == static for one in axes.lines)
