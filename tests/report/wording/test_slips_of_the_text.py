"""The seven slips of the thesis's text, each worked out here a second time."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hjcamp.plants.pump_joint.published import slips


def test_pid_alone_is_worse_than_the_earlier_sliding_mode_in_three_rows() -> None:
    assert slips.worse_than_sliding_mode() == {"ramp_pos": (1.7, 1.55), "sine_0p5hz": (2.3, 1.69), "cycloid_pos": (1.3, 1.19)}


def test_the_bandwidth_is_20_7_hz_and_not_18() -> None:
    at = 2j * math.pi * np.array([18.0, 20.7])
    gain = np.abs(2205000.0 / (at**3 + 245.0 * at**2 + 35700.0 * at + 2205000.0))
    assert 20 * np.log10(gain[0]) > -2.0 and 20 * np.log10(gain[1]) == pytest.approx(-3.01, abs=0.01)
    assert slips.fastest_bandwidth() == pytest.approx(20.7, abs=0.05)


def test_the_payload_adds_1580_percent_and_not_1480() -> None:
    alone, whole = slips.mass_increase()
    assert alone == pytest.approx(29200 / 18.5) and round(alone, -1) == 1580
    assert whole == pytest.approx(alone + 100.0) and round(100 * (292 - 18.5) / 18.5, -1) == 1480


def test_oil_is_not_300_times_stiffer_than_water() -> None:
    assert slips.oil_modulus_if_true() == pytest.approx(645.0)
    assert slips.oil_modulus_if_true() > 4.0 * slips.STEEL_GPA
    assert slips.OIL_GPA < slips.water_modulus() == 2.15


def test_the_string_needs_0_19_n_and_not_0_3() -> None:
    assert slips.least_string_tension() == pytest.approx(20e-3 / (3.41e-3 * (math.exp(0.22 * 5 * math.pi) - 1)))
    assert round(slips.least_string_tension(), 2) == 0.19


def test_the_earlier_pinion_had_12_deg_per_mm() -> None:
    assert slips.deg_per_mm_of_rack() == pytest.approx([12.0] * 4, rel=0.015)
    assert 360.0 / (math.pi * 6.82) == pytest.approx(16.8, abs=0.01)


def test_all_seven_are_on_the_page_with_their_numbers() -> None:
    found = slips.slips()
    assert [one.place for one in found] == [
        "6.3", "5.3, footnote", "5.5", "4.4.3", "3.6.3", "2.4 and 6.3", "caption of Figure 5.2.5"
    ]  # fmt: skip
    assert "20.7 Hz" in found[1].follows and "1578 %" in found[2].follows and "645 GPa" in found[3].follows
    assert "12.1 deg/mm" in found[5].follows and "4.75" in found[5].follows
