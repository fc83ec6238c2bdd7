"""Names of conditions as people read them."""

from __future__ import annotations

import pytest

from hjcamp.report.wording.names import axis, readable


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("cycloid_pos__ffwd_pid", "cycloid positive, feedforward PID"),
        ("frequency_hz-0.5__none/2", "frequency 0.5 Hz, none/2"),
        ("kp=0.7__pid/2", "kp 0.7, PID/2"),
        ("offset_deg=-3", "offset -3 deg"),
        ("offset_deg--3", "offset -3 deg"),
        ("kp-1e-3__my-own_law", "kp 1e-3, my-own law"),
        ("sine_0p5hz__brass_8p5g/3", "sine 0.5 Hz, brass 8.5 g/3"),
        ("-0.5", "-0.5"),
        ("1e-3", "1e-3"),
        ("speed_m_per_s2-4", "speed 4 m/s2"),
    ],
)
def test_a_condition_in_words(name: str, words: str) -> None:
    assert readable(name) == words


@pytest.mark.parametrize(
    ("parameter", "label"),
    [
        ("controller.dither.amplitude_v", "dither amplitude (V)"),
        ("procedure.preload_mpa", "preload (MPa)"),
        ("procedure.adjustment.positive_mpa", "adjustment positive (MPa)"),
        ("controller.positive.kp", "positive kp"),
        ("pump.mass_ratio", "mass ratio"),
    ],
)
def test_a_parameter_as_the_label_of_an_axis(parameter: str, label: str) -> None:
    assert axis(parameter) == label
