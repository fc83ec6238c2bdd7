"""Published benchmark sets: their splits, and the whole way from a file as it is published to our number, on made-up records."""

from __future__ import annotations

import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat
from scipy.signal import cheby1, cheby2, lsim

from benchmarks.public.sets import SETS

ROOT = Path(__file__).parents[3]
NOISE = 0.02


def tanks(pump: np.ndarray, start: tuple[float, float]) -> np.ndarray:
    """Return the levels of the lower tank by small explicit steps."""
    upper, lower = start
    found = []
    for volts in pump:
        found.append(lower)
        for _ in range(400):
            flow, out = 0.06 * np.sqrt(max(upper, 0.0)), 0.05 * np.sqrt(max(lower, 0.0))
            upper, lower = upper + 0.01 * (0.04 * volts - flow), lower + 0.01 * (flow - out)
    return np.array(found)


def write_tanks(folder: Path) -> None:
    generator = np.random.default_rng(1)
    records = {}
    for part, start in (("Est", (4.0, 5.0)), ("Val", (3.0, 6.0))):
        pump = np.repeat(generator.uniform(1.0, 5.0, 64), 16)
        records[f"u{part}"] = pump[:, None]
        records[f"y{part}"] = (tanks(pump, start) + NOISE * generator.standard_normal(len(pump)))[:, None]
    savemat(folder / "dataBenchmark.mat", {**records, "Ts": 4.0})


def test_a_set_is_split_as_its_loader_does(tmp_path: Path) -> None:
    write_tanks(tmp_path)
    train, test = SETS["cascaded_tanks"].read([tmp_path / "dataBenchmark.mat"])
    assert len(train["train"]["level_v"]) == len(test["test"]["level_v"]) == 1024 and train["train"]["time_s"][1] == 4.0
    rows = np.arange(131072.0)
    savemat(tmp_path / "SNLS80mV.mat", {"V1": rows, "V2": -rows})
    train, test = SETS["silverbox"].read([tmp_path / "SNLS80mV.mat"])
    ends = {name: (table["drive_voltage_v"][0], table["output_v"][-1]) for name, table in {**train, **test}.items()}
    assert ends == {"train": (40650, -105711), "multisine": (105712, -127399), "arrow": (100, -40574)}
    rows = np.arange(188_000.0)[:, None]
    savemat(tmp_path / "WienerHammerBenchMark.mat", {"uBenchMark": rows, "yBenchMark": -rows, "fs": 51200.0})
    train, test = SETS["wiener_hammerstein"].read([tmp_path / "WienerHammerBenchMark.mat"])
    ends = {name: (table["drive_voltage_v"][0], table["output_v"][-1]) for name, table in {**train, **test}.items()}
    assert ends == {"train": (5200, -105_199), "test": (105_200, -183_999)} and train["train"]["time_s"][1] == 1.0 / 51200.0
    names = {"t": rows[:9], "qm": rows[:9], "vir": rows[:9], "qg": rows[:9]}
    for name in ("DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"):
        savemat(tmp_path / name, names)
    train, test = SETS["emps"].read([tmp_path / "DATA_EMPS.mat", tmp_path / "DATA_EMPS_PULSES.mat"])
    assert (
        list(train) == ["train"] and list(test) == ["pulses"] and set(train["train"]) == {"time_s", "position_m", "voltage_v"}
    )


def test_the_circuit_is_the_two_filters_that_its_authors_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from hjcamp.cli import run

    monkeypatch.chdir(tmp_path)
    Path("plants").mkdir()
    shutil.copy(ROOT / "benchmarks" / "public" / "plants" / "wiener_hammerstein.py", "plants")
    assert run(["model", "export", "wiener_hammerstein", "--as", "python", "--into", "circuit.py"]) == 0
    circuit = runpy.run_path("circuit.py")
    filters = (
        cheby1(3, 0.5, 2 * np.pi * 4400, analog=True, output="zpk"),
        cheby2(3, 40, 2 * np.pi * 5000, analog=True, output="zpk"),
    )
    values = {"zero_2": abs(filters[1][0][0]), "slope": 0.6, "threshold": 0.2, "bend": 0.1, "gain": 0.9}
    for number, (_, poles, _) in enumerate(filters, 1):
        pair = next(one for one in poles if one.imag > 0.0)
        real = next(one for one in poles if abs(one.imag) < 1.0)
        values |= {f"pole_{number}": -real.real, f"frequency_{number}": abs(pair), f"damping_{number}": -pair.real / abs(pair)}
    # slow enough for an input that the file holds at its mean from sample to sample
    fine, many = 20, 400
    given = sum(np.sin(2 * np.pi * hertz / 51200.0 * np.arange(many)) for hertz in (700.0, 1600.0, 2900.0))
    time = np.arange((many - 1) * fine + 1) / (51200.0 * fine)
    inner = lsim(cheby1(3, 0.5, 2 * np.pi * 4400, analog=True), np.interp(time, time[::fine], given), time)[1]
    limited = inner - 0.6 * 0.1 * np.logaddexp(0.0, (inner - 0.2) / 0.1)
    # the states begin at 0, where the diode lets a little through already
    expected = 0.9 * lsim(cheby2(3, 40, 2 * np.pi * 5000, analog=True), limited, time)[1][::fine]
    found = circuit["simulate"]({"drive_voltage": given}, parameters=values)[0]["probe"]
    assert np.max(np.abs(found - expected)) < 2e-3 * np.ptp(expected)


@pytest.mark.parametrize("name", SETS)
def test_a_plant_comes_along_with_each_set(name: str) -> None:
    from hjcamp.known_plants import find_plant

    plant = find_plant(SETS[name].plant, folders=[ROOT / "benchmarks" / "public" / "plants"])
    known = {*plant.base_parameters, "test", "arrow", "multisine"}
    assert all(what in known for _, what, _ in SETS[name].published)


def test_a_folder_without_a_whole_set_is_said_so(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.public", str(tmp_path)], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 2 and "no whole set" in done.stderr and not (tmp_path / "results.md").exists()


@pytest.mark.study
def test_a_made_up_record_gives_its_own_noise(tmp_path: Path) -> None:
    write_tanks(tmp_path)
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.public", str(tmp_path)], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    rows = [line for line in (tmp_path / "results.md").read_text().splitlines() if line.startswith("| cascaded_tanks")]
    assert len(rows) == 4 and "PNLSS-I | 0.4498" in "".join(rows)
    assert float(rows[0].split("|")[5]) == pytest.approx(NOISE, rel=0.2)
