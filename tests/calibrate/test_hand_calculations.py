"""The thesis's hand calculations from the code's own formulas; where its arithmetic does not close, a test says so."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import hjcamp.backends
from hjcamp import cli
from hjcamp.configuration.setups import configuration_for
from hjcamp.plants.pump_joint.calibrate.string_slip import string_warning
from hjcamp.plants.pump_joint.sizing import pulley, tubing

PUMP_BORE, INNER, OUTER, LENGTH = 6.35e-3, 2.69e-3, 3.99e-3, 0.3
VISCOSITY, DENSITY, water = 1.002e-3, 1000.0, 2150e6
RADIUS = 3.41e-3
ldpe = tubing.tubing_modulus(INNER, OUTER, 300e6, 0.4)
hdpe = tubing.tubing_modulus(INNER, OUTER, 2000e6, 0.4)


def test_flow_and_resistance_of_section_4_4_1() -> None:
    speed = tubing.tubing_speed(0.060, PUMP_BORE, INNER)
    assert speed == pytest.approx(0.334, abs=5e-4)
    assert tubing.reynolds_number(0.334, INNER, DENSITY, VISCOSITY) == pytest.approx(897, abs=0.5)
    assert tubing.resistance_drop(0.334, LENGTH, INNER, VISCOSITY) == pytest.approx(4.44e-4 * 1e6, abs=0.5)


def test_inertance_of_section_4_4_2() -> None:
    acceleration = tubing.tubing_speed(0.125, PUMP_BORE, INNER)
    assert acceleration == pytest.approx(0.697, abs=5e-4)
    assert tubing.inertance_drop(acceleration, LENGTH, DENSITY) == pytest.approx(2.09e-4 * 1e6, abs=0.5)


def test_bulk_modulus_of_the_tubing_and_the_three_compressibilities_of_section_4_4_3() -> None:
    assert ldpe * 1e-6 == pytest.approx(48.9, abs=0.05)
    assert 1e6 / water == pytest.approx(0.465e-3, abs=5e-7)
    assert 1e6 / ldpe == pytest.approx(20.4e-3, abs=5e-5)
    for share, pressure, printed in ((0.001, 0.8, 1.25e-3), (0.01, 0.2, 50e-3)):
        with_air = 1e6 / tubing.effective_modulus(water, ldpe, share, pressure * 1e6)
        assert with_air - 1e6 / water - 1e6 / ldpe == pytest.approx(printed, rel=1e-6)


def test_wall_ratio_does_not_close() -> None:
    # The text finds 4.2 for r_i / t with 4.4.3.7. The radius gives 2.07; 4.1 is the diameter over the wall.
    wall = 0.5 * (OUTER - INNER)
    assert 0.5 * INNER / wall == pytest.approx(2.07, abs=0.005)
    assert INNER / wall == pytest.approx(4.14, abs=0.005)
    assert INNER / wall < 10


def test_stiff_tubing_of_section_5_6_does_not_close() -> None:
    # The text says 0.15 MPa/mm3 for E = 2000 MPa and S = 0.5 % above 0.5 MPa gauge, from 4.4.3.11 to 4.4.3.14.
    volume, pressure = tubing.tubing_volume(INNER, LENGTH), 0.5e6 + tubing.ATMOSPHERE
    as_printed = tubing.effective_modulus(water, hdpe, 0.005, pressure) / volume * 1e-15
    assert as_printed == pytest.approx(0.050, abs=5e-4)
    # With the bubbles' share taken at atmospheric pressure the printed value lies between 0.5 MPa gauge and no air.
    compressed = tubing.compressed_air_modulus(water, hdpe, 0.005, pressure) / volume * 1e-15
    without_air = tubing.compressed_air_modulus(water, hdpe, 0.0, pressure) / volume * 1e-15
    assert compressed == pytest.approx(0.119, abs=5e-4)
    assert without_air == pytest.approx(0.166, abs=5e-4)
    at = tubing.compressed_air_modulus(water, hdpe, 0.005, 1.05e6 + tubing.ATMOSPHERE) / volume * 1e-15
    assert compressed < 0.15 < without_air and at == pytest.approx(0.150, abs=1e-3)


def test_air_content_undoes_the_effective_modulus() -> None:
    effective = tubing.effective_modulus(water, ldpe, 0.003, 0.4e6)
    assert tubing.air_fraction(effective, water, ldpe, 0.4e6) == pytest.approx(0.003, rel=1e-9)


def test_effective_masses_of_section_4_5_2_and_5_5() -> None:
    pulley, arm = (tubing.effective_mass(inertia, 3.4e-3) * 1e3 for inertia in (9.1e-9, 51.6e-9))
    assert pulley == pytest.approx(0.8, abs=0.05) and arm == pytest.approx(4.5, abs=0.05)
    assert 5.2 + 4.0 + 4.0 + round(pulley, 1) + round(arm, 1) == pytest.approx(18.5)
    assert tubing.effective_mass(8.5e-3 * 0.02**2, RADIUS) == pytest.approx(0.292, abs=5e-4)
    assert tubing.weight_at_sliders(8.5e-3, 0.02, RADIUS) == pytest.approx(0.49, abs=5e-3)


def test_string_of_section_3_6() -> None:
    assert pulley.least_tension(20e-3, 2.5, 0.22, RADIUS) == pytest.approx(0.19, abs=5e-3)
    assert pulley.largest_torque(0.19, 2.5, 0.22, RADIUS) == pytest.approx(20e-3, rel=0.01)


def test_string_warns_where_a_test_would_slip_it() -> None:
    names = (("payload", "brass_8p5g"), ("orientation", "vertical"), ("trajectory", "cycloid_pos"))
    config = configuration_for(names)
    assert string_warning(config) is None
    heavy = {**config, "payload": {**config["payload"], "mass_g": 120.0}}
    warning = string_warning(heavy)
    assert warning is not None and "slips" in warning and "0.19 N" in warning


def test_run_says_when_a_test_would_slip_the_string(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def quick_test(config: dict, seed: int) -> tuple[dict[str, np.ndarray], dict[str, str]]:
        time = np.arange(300) * 1e-3
        columns = dict.fromkeys(("arm_deg", "pressure1_mpa", "pressure2_mpa", "pump_deg"), 0.1 * time)
        return {"time_s": time, "reference_deg": time, **columns}, {}

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(hjcamp.backends, "run_test", quick_test)
    call = ["run", "payload=brass_8p5g", "orientation=vertical", "repetitions=1", "workers=1"]
    assert cli.run([*call, "run_dir=light"]) == 0
    assert "slips" not in capfd.readouterr().out
    assert cli.run([*call, "run_dir=heavy", "payload.mass_g=200"]) == 0
    assert "slips on the pulley" in " ".join(capfd.readouterr().out.split())
