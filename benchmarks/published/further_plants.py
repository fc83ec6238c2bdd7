"""Write docs/further_plants.md and its figures from runs of the campaigns previous_joint, valve_timing and two_pumps.

python -m benchmarks.published.further_plants previous_joint three_mode valve_timing two_pumps    (four run folders)

``three_mode`` is a run of `campaign=previous_joint controller=three_mode`.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl

from hjcamp.plants.pump_joint.published.values import constants
from hjcamp.records.read import read_log

PAGE = Path("docs/further_plants.md")
IMAGES = Path("docs/images")
LAWS = ("pva", "ffwd_pva", "sliding_mode")
TRAJECTORIES = ("ramp_pos", "sine_0p5hz", "cycloid_pos", "mixed")
TIMES = {"0p5ms": 0.5, "1p5ms": 1.5, "2p5ms": 2.5, "3p5ms": 3.5, "5ms": 5.0}
LOW_MPA, LEAK_MPA = 0.1, 0.58
LAYOUTS = ("single_0p26", "single_0p39", "opposite_2_percent", "sum_difference", "push_hold")


def law_means(frame: pl.DataFrame) -> dict[str, tuple[float, float]]:
    """Return mean and deviation, over the repetitions, of each law's RMSE averaged over the four trajectories."""
    found = {}
    for law in LAWS:
        tests = frame.filter(pl.col("controller") == law)
        each = tests.group_by("repetition").agg(pl.col("rmse1_deg").mean())["rmse1_deg"]
        found[law] = (float(each.mean() or 0.0), float(each.std() or 0.0))  # type: ignore[arg-type]
    return found


def judged(frame: pl.DataFrame) -> list[str]:
    """Return the four criteria of success, each with what was found."""
    means, printed = law_means(frame), constants()["table_6_3_1"]["rmse1"]
    cells = frame.group_by("trajectory", "controller").agg(pl.col("rmse1_deg").mean())
    value = {(t, c): v for t, c, v in cells.iter_rows()}
    pairs = [(value[t, c], printed[t][c]) for t in TRAJECTORIES for c in LAWS if printed[t][c] is not None]
    near = sum(0.5 <= ours / theirs <= 2.0 for ours, theirs in pairs)
    best = sum(printed[t]["ffwd_pid"] < min(value[t, c] for c in LAWS) for t in TRAJECTORIES)
    texts = {law: f"{mean:.2f} ± {std:.2f}" for law, (mean, std) in means.items()}
    gap = means["pva"][0] - means["ffwd_pva"][0]
    first = gap > means["pva"][1] + means["ffwd_pva"][1]
    second = means["sliding_mode"][0] <= means["ffwd_pva"][0]
    return [
        "| criterion | found | |",
        "|---|---|---|",
        f"| PVA above FFWD + PVA, mean of the four trajectories | {texts['pva']} against {texts['ffwd_pva']} deg | {told(first)} |",
        f"| sliding mode not above FFWD + PVA in that mean | {texts['sliding_mode']} against {texts['ffwd_pva']} | {told(second)} |",
        f"| at least 9 of the 11 printed cells within a factor of 2 | {near} of {len(pairs)} | {told(near >= 9)} |",
        f"| printed FFWD + PID of the new joint below all three in every row | {best} of 4 rows | {told(best == 4)} |",
    ]


def told(shown: bool) -> str:
    """Return the verdict of a criterion."""
    return "shown" if shown else "not shown"


def timing_rows(frame: pl.DataFrame) -> dict[float, dict[str, tuple[float, float]]]:
    """Return the means of the laws for each dead time, ms."""
    return {ms: law_means(frame.filter(pl.col("condition").str.starts_with(f"{label}__"))) for label, ms in TIMES.items()}


def draw_timing(rows: dict[float, dict[str, tuple[float, float]]]) -> None:
    """Draw RMSE against valve time, with the printed FFWD + PID of the new joint as a line."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.0, 3.6), layout="constrained")
    axes = figure.add_subplot()
    for law in LAWS:
        means = [rows[ms][law] for ms in rows]
        axes.errorbar(list(rows), [m for m, _ in means], [s for _, s in means], marker="o", capsize=3, label=law)
    printed = constants()["table_6_3_1"]["rmse1"]
    axes.axhline(
        float(np.mean([printed[t]["ffwd_pid"] for t in TRAJECTORIES])),
        color="k",
        ls="--",
        label="FFWD + PID, new joint, printed",
    )
    axes.set(xlabel="dead time of the valves (ms)", ylabel="RMSE, mean of 4 trajectories (deg)", ylim=(0.0, None))
    axes.legend(frameon=False, fontsize=8)
    figure.savefig(IMAGES / "valve_timing.svg", metadata={"Date": None})


def valve_cycles(runs: list[Path]) -> list[str]:
    """Return a table of RMSE and of how often a valve opens in a second, mean of the four valves."""
    found: dict[str, list[tuple[float, float]]] = {}
    for path in sorted(path for run in runs for path in (run / "logs").glob("*/*.mcap")):
        log = read_log(path)
        phase = log.command_phase
        opened = [np.sum(np.diff((phase[f"valve{k}_ratio"] > 0.0).astype(int)) == 1) for k in range(1, 5)]
        error = phase["reference_deg"] - phase["arm_deg"]
        rates = float(np.mean(opened)) / (len(error) * 1e-3)
        found.setdefault(log.metadata["controller"], []).append((float(np.sqrt(np.mean(error**2))), rates))
    lines = ["| law | RMSE, deg | openings of a valve in 1 s |", "|---|---:|---:|"]
    means = {law: np.mean(pairs, axis=0) for law, pairs in found.items()}
    return [*lines, *(f"| {law} | {means[law][0]:.2f} | {means[law][1]:.1f} |" for law in (*LAWS, "three_mode"))]


def pressures(run: Path) -> pl.DataFrame:
    """Return one row for each log of ``two_pumps``: tracking and what the lines went through."""
    rows: list[dict[str, Any]] = []
    for path in sorted((run / "logs").glob("*/*.mcap")):
        layout, trajectory, air = path.parent.name.split("__")
        phase = read_log(path).command_phase
        p1, p2 = phase["pressure1_mpa"], phase["pressure2_mpa"]
        error = phase["reference_deg"] - phase["arm_deg"]
        mean, low, high = 0.5 * (p1 + p2), np.minimum(p1, p2), np.maximum(p1, p2)
        rows.append(
            {
                "layout": layout, "trajectory": trajectory, "air": air, "rmse": float(np.sqrt(np.mean(error**2))),
                "e_max": float(np.max(np.abs(error))), "lowest": float(low.min()), "highest": float(high.max()),
                "below": float(np.sum(low < LOW_MPA)) * 1e-3, "above": float(np.sum(high > LEAK_MPA)) * 1e-3,
                "drift": float(mean[-50:].mean() - mean[:50].mean()),
            }
        )  # fmt: skip
    return pl.DataFrame(rows)


def two_pumps_table(frame: pl.DataFrame) -> list[str]:
    """Return the table: means over trajectories and repetitions, extremes of all."""
    lines = [
        "| layout | air | RMSE, deg | largest error, deg | lowest, MPa | highest, MPa | below 0.1, s | above 0.58, s | drift, MPa |",
        "|---|---|---:|---:|---:|---:|---:|---:|---:|",
    ]
    for layout in LAYOUTS:
        for air, share in (("none", "none"), ("tenth_percent", "0.1 %"), ("half_percent", "0.5 %")):
            one = frame.filter((pl.col("layout") == layout) & (pl.col("air") == air))
            mean = one.select(pl.col("rmse", "e_max", "below", "above", "drift").mean()).row(0, named=True)
            lines.append(
                f"| {layout} | {share} | {mean['rmse']:.2f} | {mean['e_max']:.1f} | "
                f"{one['lowest'].min():.3f} | {one['highest'].max():.3f} | "
                f"{mean['below']:.2f} | {mean['above']:.2f} | {mean['drift']:+.3f} |"
            )
    return lines


def draw_pressures(run: Path) -> None:
    """Draw both lines and their mean over the slow sine, a column for each layout."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 3.2), layout="constrained")
    for place, layout in enumerate(("single_0p26", "single_0p39", "sum_difference")):
        phase = read_log(run / "logs" / f"{layout}__sine_0p5hz__none" / "rep_01.mcap").command_phase
        axes = figure.add_subplot(1, 3, place + 1)
        time, p1, p2 = phase["time_s"][::4], phase["pressure1_mpa"][::4], phase["pressure2_mpa"][::4]
        for values, label in ((p1, "line 1"), (p2, "line 2"), (0.5 * (p1 + p2), "mean")):
            axes.plot(time, values, lw=0.9, label=label)
        for level in (LOW_MPA, LEAK_MPA, 0.69):
            axes.axhline(level, color="k", lw=0.5, ls=":")
        axes.set(title=layout, xlabel="time (s)", ylim=(-0.15, 0.8), ylabel="pressure (MPa gauge)" if not place else "")
    axes.legend(frameon=False, fontsize=7)
    figure.savefig(IMAGES / "two_pumps.svg", metadata={"Date": None})


def main() -> None:
    """Read three run folders and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("previous_joint", "three_mode", "valve_timing", "two_pumps"):
        parser.add_argument(name, type=Path)
    given = parser.parse_args()
    before, timing = (pl.read_parquet(run / "tables/indicators.parquet") for run in (given.previous_joint, given.valve_timing))
    rows = timing_rows(timing)
    draw_timing(rows)
    frame = pressures(given.two_pumps)
    draw_pressures(given.two_pumps)
    table = (given.previous_joint / "tables/table_6_3_1_valves.md").read_text().split("\n", 2)[2]
    times = ["| dead time, ms | PVA | FFWD + PVA | sliding mode |", "|---:|---:|---:|---:|"]
    times += [f"| {ms:g} | " + " | ".join(f"{m:.2f} ± {s:.2f}" for m, s in laws.values()) + " |" for ms, laws in rows.items()]
    text = Path(__file__).with_name("further_plants_reading.md").read_text()
    for mark, lines in (
        ("<!-- table -->", [table]),
        ("<!-- criteria -->", judged(before)),
        ("<!-- timing -->", times),
        ("<!-- cycles -->", valve_cycles([given.previous_joint, given.three_mode])),
        ("<!-- pumps -->", two_pumps_table(frame)),
    ):
        text = text.replace(mark, "\n".join(lines))
    PAGE.write_text(text)


if __name__ == "__main__":
    main()
