"""Published benchmark sets: the files as they are published, their split, and what was published of it. Nothing is fetched.

Splits are those of the sets' official loader (nonlinear_benchmarks, github.com/GerbenBeintema/nonlinear_benchmarks).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Table = dict[str, Array]  # columns of one recording by the fields of the plant's logs, SI


@dataclass(frozen=True)
class PublicSet:
    """A set: how its files become recordings to fit (``train``) and to judge (``test``), and what was published of them.

    ``window``: samples of a test from which its start may be found, which do not count. ``published``: who, what (a parameter, or
    rms of the free simulation of a test), the number in ``unit``.
    """

    plant: str
    source: str
    files: tuple[tuple[str, ...], ...]
    read: Callable[[list[Path]], tuple[dict[str, Table], dict[str, Table]]]
    window: int
    unit: str
    scale: float
    published: tuple[tuple[str, str, float], ...]
    note: str = ""


def _mat(path: Path) -> dict[str, Array]:
    from scipy.io import loadmat

    return {name: np.asarray(value, float).ravel() for name, value in loadmat(path).items() if not name.startswith("__")}


def _emps(paths: list[Path]) -> tuple[dict[str, Table], dict[str, Table]]:
    names = {"time_s": ("t", "time_s"), "position_m": ("qm", "position_m"), "voltage_v": ("vir", "voltage_v")}
    tables = []
    for path in paths:
        if path.suffix == ".csv":
            found = np.genfromtxt(path, delimiter=",", names=True)
            columns = {name: found[name] for name in found.dtype.names}
        else:
            columns = _mat(path)
        tables.append({field: columns[next(one for one in known if one in columns)] for field, known in names.items()})
    return {"train": tables[0]}, {"pulses": tables[1]}


def _tanks(paths: list[Path]) -> tuple[dict[str, Table], dict[str, Table]]:
    if paths[0].suffix == ".csv":
        found = np.genfromtxt(paths[0], delimiter=",", names=True)
        raw = {name: found[name] for name in ("uEst", "uVal", "yEst", "yVal")}
    else:
        raw = _mat(paths[0])
    rows = len(raw["uEst"])
    time = 4.0 * np.arange(rows)
    made = {
        name: {"time_s": time, "pump_v": raw[f"u{part}"], "level_v": raw[f"y{part}"]}
        for name, part in (("train", "Est"), ("test", "Val"))
    }
    return {"train": made["train"]}, {"test": made["test"]}


def _silverbox(paths: list[Path]) -> tuple[dict[str, Table], dict[str, Table]]:
    raw = _mat(paths[0])
    u, y = raw["V1"], raw["V2"]
    first, last = 40650, 127400
    part = first + int(0.75 * (last - first))

    def table(begin: int, end: int) -> Table:
        return {"time_s": np.arange(end - begin) / 610.35, "drive_voltage_v": u[begin:end], "output_v": y[begin:end]}

    return {"train": table(first, part)}, {"multisine": table(part, last), "arrow": table(100, 40575)}


def _wiener_hammerstein(paths: list[Path]) -> tuple[dict[str, Table], dict[str, Table]]:
    raw = _mat(paths[0])
    first, part, last = 5200, 105_200, 184_000

    def table(begin: int, end: int) -> Table:
        time = np.arange(end - begin) / raw["fs"][0]
        return {"time_s": time, "drive_voltage_v": raw["uBenchMark"][begin:end], "output_v": raw["yBenchMark"][begin:end]}

    return {"train": table(first, part)}, {"test": table(part, last)}


SETS = {
    "emps": PublicSet(
        "emps",
        "Janot, Gautier & Brunot (2019), Data set and reference models of EMPS, Workshop on Nonlinear System Identification Benchmarks",
        (("DATA_EMPS.mat", "emps_train.csv"), ("DATA_EMPS_PULSES.mat", "emps_pulses.csv")),
        _emps,
        20,
        "",
        1.0,
        (
            ("its authors", "mass", 95.11),
            ("its authors", "viscous", 203.5),
            ("its authors", "coulomb", 20.39),
        ),
        "An integrator in a closed loop: parameters are held against each other, not a free simulation.",
    ),
    "cascaded_tanks": PublicSet(
        "cascaded_tanks",
        "Schoukens & Noel (2017), Three benchmarks addressing open challenges in nonlinear system identification",
        (("dataBenchmark.mat", "dataBenchmark.csv"),),
        _tanks,
        0,
        "V",
        1.0,
        (
            ("best linear approximation", "test", 0.7574),
            ("Volterra, 3rd degree, transient removed", "test", 0.54),
            ("PNLSS-I", "test", 0.4498),
            ("NLSS2", "test", 0.3433),
        ),
        "Published numbers as table 2 of doi:10.1155/2021/6613425 quotes them. The whole validation record counts.",
    ),
    "silverbox": PublicSet(
        "silverbox",
        "Wigren & Schoukens (2013), Three free data sets for development and benchmarking in nonlinear system identification, ECC",
        (("SNLS80mV.mat",),),
        _silverbox,
        50,
        "mV",
        1e3,
        (),
        "Published numbers on this split: Champneys et al. (2024), arXiv:2405.10779; they could not be checked and are not repeated.",
    ),
    "wiener_hammerstein": PublicSet(
        "wiener_hammerstein",
        "Schoukens, Suykens & Ljung (2009), Wiener-Hammerstein benchmark, 15th IFAC Symposium on System Identification",
        (("WienerHammerBenchMark.mat",),),
        _wiener_hammerstein,
        50,
        "mV",
        1e3,
        (),
        "Published numbers are quoted in many papers, on several splits; they could not be checked and are not repeated.",
    ),
}
