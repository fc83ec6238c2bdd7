"""The values that the thesis prints, as frames with the names of the indicators."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import polars as pl
import yaml

FOLDER = Path(__file__).parent
#: What identifies a published cell beside its indicator.
CONDITION = ("trajectory", "controller", "payload", "orientation", "friction", "tubing")
#: The choices of every measured test of chapter 5; a log that does not name its friction or tubing counts as these.
MEASURED_WITH = {"friction": "bidirectional", "tubing": "ldpe_300mm"}
CAMPAIGN_OF_TABLE = {"5.4.1": "controllers", "5.4.2": "controllers"}
CASES_OF_TABLE_5_6_1 = {
    "unidirectional_friction": {"friction": "unidirectional", "tubing": "ldpe_300mm"},
    "reduced_friction": {"friction": "reduced", "tubing": "ldpe_300mm"},
    "reduced_compliance": {"friction": "reduced", "tubing": "hdpe_300mm"},
}
#: The campaigns whose conditions are the tests of a published table.
CAMPAIGNS = {
    "5.4.1": ("controllers",),
    "5.4.2": ("controllers",),
    "5.5.1": ("robustness_horizontal", "robustness_vertical"),
    "5.5.2": ("robustness_horizontal", "robustness_vertical"),
    "5.6.1": ("friction_compliance",),
    "5.3.2": ("feedforward_simulation",),
    "6.3.1": ("previous_joint",),
}


@lru_cache(maxsize=1)
def constants() -> dict[str, Any]:
    """Return published.yaml: constants, unrepeated tables and statements."""
    return yaml.safe_load((FOLDER / "published.yaml").read_text(encoding="utf-8"))


@lru_cache(maxsize=1)
def printed_rows() -> pl.DataFrame:
    """Return the 96 printed rows: table, condition, indicator, test1 ... test7 (deg), mean_printed, std_printed."""
    return pl.read_csv(FOLDER / "measured_indicators.csv", schema_overrides={"table": pl.String, "std_printed": pl.Float64})


def measured_indicators() -> pl.DataFrame:
    """Return the measured repetitions as an indicators frame: one row per test, inputs rounded to 0.1 deg."""
    from hjcamp.report.runs.indicators import STANDING, frame_of

    tests: dict[tuple[str, ...], dict[str, Any]] = {}
    for printed in printed_rows().iter_rows(named=True):
        condition = {name: printed[name] for name in ("trajectory", "controller", "payload", "orientation")}
        for repetition in range(1, 8):
            key = (*condition.values(), str(repetition))
            row = tests.setdefault(key, {"condition": "__".join(condition.values()), "repetition": repetition})
            row |= condition | MEASURED_WITH | constants()["hardware"]
            row["campaign"] = CAMPAIGN_OF_TABLE.get(printed["table"], f"robustness_{printed['orientation']}")
            row[f"{printed['indicator']}_deg"] = printed[f"test{repetition}"]
            own = {"table": printed["table"], "cell": " ".join(cell_key(row)), "differs": ""}
            row[STANDING] = [one for one in row.get(STANDING, []) if one != own] + [own]
    return frame_of(tests.values())


def cell_key(choices: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the choices that name a published cell; friction and tubing as measured where they are not named."""
    return tuple(str(choices.get(group) or MEASURED_WITH.get(group, "")) for group in CONDITION)


@lru_cache(maxsize=1)
def published_cells() -> pl.DataFrame:
    """Return every published cell: table, condition, indicator, mean, std, decimals, simulated.

    ``std`` is the printed deviation, which divides by n (see `docs/published_inconsistencies.md`). Where none is
    printed (the steady state errors) it is that of the printed repetitions, formed in the same way; where the thesis gives one
    value alone (simulations, previous work) it is null.
    """
    cells = [*_measured_cells(), *_simulated_cells(), *_previous_work()]
    numbers: dict[str, Any] = {"mean": pl.Float64, "std": pl.Float64, "decimals": pl.Int64, "simulated": pl.Boolean}
    texts: dict[str, Any] = dict.fromkeys(("table", *CONDITION, "indicator"), pl.String)
    return pl.DataFrame(cells, schema=texts | numbers)


def _measured_cells() -> list[dict[str, Any]]:
    cells = []
    for printed in printed_rows().iter_rows(named=True):
        tests = pl.Series([printed[f"test{number}"] for number in range(1, 8)])
        std = printed["std_printed"] if printed["std_printed"] is not None else tests.std(ddof=0)
        names = ("table", "trajectory", "controller", "payload", "orientation")
        values = {"mean": printed["mean_printed"], "std": std, "decimals": 1, "simulated": False}
        cell = {name: printed[name] for name in names} | MEASURED_WITH | values
        cells.append(cell | {"indicator": f"{printed['indicator']}_deg"})
    return cells


def _cell(table: str, trajectory: str, controller: str, indicator: str, mean: float, **more: Any) -> dict[str, Any]:
    cell: dict[str, Any] = {"table": table, "trajectory": trajectory, "controller": controller}
    cell["indicator"] = f"{indicator}_deg"
    cell |= {"payload": "none", "orientation": "horizontal", "mean": mean, "std": None, "decimals": 2}
    return cell | MEASURED_WITH | more


def _simulated_cells() -> list[dict[str, Any]]:
    cells = []
    for name, values in constants()["simulation_figures_5_3"].items():
        trajectory = name.removesuffix("_ffwd_pid")
        for indicator, mean in values.items():
            cells.append(_cell("5.3.2", trajectory, "ffwd_pid", indicator, mean, simulated=True))
    for trajectory, cases in constants()["table_5_6_1"].items():
        for case, values in cases.items():
            for indicator, mean in values.items():
                more = CASES_OF_TABLE_5_6_1[case] | {"simulated": True}
                cells.append(_cell("5.6.1", trajectory, "ffwd_pid", indicator, mean, **more))
    return cells


def _previous_work() -> list[dict[str, Any]]:
    """Return the columns of Table 6.3.1 that no other table holds: the earlier, valve-driven joint."""
    return [
        _cell("6.3.1", trajectory, controller, indicator, mean, simulated=False)
        for indicator, rows in constants()["table_6_3_1"].items()
        for trajectory, columns in rows.items()
        for controller, mean in columns.items()
        if controller not in ("pid", "ffwd_pid") and mean is not None
    ]
