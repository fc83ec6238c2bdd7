"""Write docs/fidelity.md: every published cell beside the simulated mean."""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import polars as pl
from fidelity_remarks import COMMON_CAUSE, remark

from hjcamp.records.find import find_logs
from hjcamp.records.read import read_log
from hjcamp.report.runs.varied import indicators_frame
from hjcamp.report.tables.aggregation import against_published
from hjcamp.report.tables.declared import declared_tables

MEASURED = ("controllers", "robustness_horizontal", "robustness_vertical")
GROUPS: tuple[tuple[tuple[str, ...], tuple[str, ...]], ...] = (
    (MEASURED, ("table_5_4_1", "table_5_4_2", "table_5_5_1", "table_5_5_2", "table_5_5_3")),
    (("friction_compliance",), ("table_5_6_1",)),
    (("feedforward_simulation",), ("table_5_3_2",)),
)
HEADING = """# Fidelity: the published cells and the simulated means

Made by `python benchmarks/published/fidelity.py`: 7 repetitions of each test, seed {seed}, model `published`. Nothing here is tuned;
a cell that is off stays off. Angles in degrees; the deviation is that of the 7 repetitions. `in std` is the difference in
units of the published deviation (empty where none is printed). The measured cells come from a real joint, those of 5.3.2
and 5.6.1 from the author's own simulation program. Table 5.5.3 repeats means of 5.4.1 to 5.5.2 in another arrangement.
"""


def run(campaign: str, folder: Path, seed: int) -> pl.DataFrame:
    """Run one campaign into ``folder`` unless it is there; return its indicators, with what stands beside them."""
    if not (folder / campaign / "tables" / "indicators.parquet").exists():
        command = [sys.executable, "-m", "hjcamp", "run", f"campaign={campaign}", f"run_dir={folder / campaign}"]
        subprocess.run([*command, "repetitions=7", f"seed={seed}"], check=True)
    return indicators_frame(read_log(path) for path in find_logs([folder / campaign]))


def compared(folder: Path, seed: int) -> pl.DataFrame:
    """Return one row for each published cell of every table, in the tables' order."""
    parts = []
    for campaigns, tables in GROUPS:
        indicators = pl.concat([run(name, folder, seed) for name in campaigns], how="diagonal")
        parts.append(against_published(indicators, declared_tables(tables)))
    return pl.concat(parts, how="diagonal")


def number(value: float | None, digits: int = 2) -> str:
    """Return a number as it stands in a cell; nothing where there is none."""
    return "" if value is None else f"{value:.{digits}f}"


def section(name: str, cells: pl.DataFrame) -> list[str]:
    """Return the lines of one table: its cells, then a line on each group that is off."""
    keys = [
        key
        for key in ("trajectory", "controller", "payload", "orientation", "friction", "tubing")
        if key in cells.columns and cells[key].drop_nulls().n_unique() > 1
    ]
    title = name.removeprefix("table_").replace("_", ".")
    lines = [f"## {title}", "", f"| {' | '.join([*keys, 'indicator'])} | published | simulated | difference | in std |"]
    lines.append("|---" * (len(keys) + 1) + "|---:|---:|---:|---:|")
    for row in cells.iter_rows(named=True):
        places = [str(row[key]) for key in keys] + [row["indicator"].removesuffix("_deg")]
        simulated = f"{number(row['mean'])} ± {number(row['std'])}"
        lines.append(
            f"| {' | '.join(places)} | {number(row['published_mean'])} | {simulated} | {number(row['difference'])} "
            f"| {number(row['difference_in_std'], 1)} |"
        )
    return [*lines, "", *[f"* {line}" for line in remark(name, cells)], ""]


def page(cells: pl.DataFrame, seed: int) -> str:
    """Return the whole text."""
    near = cells.filter(pl.col("difference").abs() <= pl.max_horizontal(pl.lit(0.5), 0.3 * pl.col("published_mean").abs()))
    lines = [HEADING.format(seed=seed)]
    lines.append(f"{near.height} of {cells.height} cells are within 0.5 deg or 30 % of what is printed.\n")
    lines += [*COMMON_CAUSE, ""]
    for name in cells["table"].unique(maintain_order=True):
        lines += section(name, cells.filter(pl.col("table") == name))
    return "\n".join(lines).rstrip() + "\n"


def main() -> None:
    """Run what is missing and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, help="folder of the runs; finished ones are not run again")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[2] / "docs" / "fidelity.md")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        cells = compared(given.folder or Path(temporary), given.seed)
    given.out.write_text(page(cells, given.seed), encoding="utf-8")
    print(f"{given.out}: {cells.height} cells")


if __name__ == "__main__":
    main()
