"""The page of a table's diagnosis, as Markdown, and its picture: simulated over measured, cell by cell."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from hjcamp.storage import whole_file

PICTURE = "cells.png"
GOAL = 0.2  # of the mean absolute log ratio
VERDICTS = {
    "nothing_missing": "Nothing is missing: the calibrated base meets the table as well as tables of its own.",
    "effect": "The table is met with {names}.",
    "one_of": "One of {names}; the table does not distinguish them.",
    "outside_library": "Something is missing that no effect of the library and no factor of the loop explains{partly}.",
    "cannot_tell": "These cells cannot tell: {lacking}.",
}


def verdict_told(found: Mapping[str, Any]) -> str:
    """Return the verdict in one sentence."""
    names = " and ".join(found["effects"])
    partly = f"; {names} take{'s' * (len(found['effects']) == 1)} the largest part" if names else ""
    return VERDICTS[found["verdict"]].format(names=names, partly=partly, lacking="; ".join(found["lacking"]))


def few_told(found: Mapping[str, Any]) -> str:
    """Return a warning where the cells are no more than the quantities of the last model, which then can hardly fail; else ""."""
    if found["lacking"]:
        return ""
    cells, fitted = len(found["cells"]), len(list(found["models"].values())[-1]["quantities"])
    if cells > fitted:
        return ""
    return f"{cells} means against {fitted} fitted quantities: so few are met nearly whatever is missing; add conditions."


def page(found: Mapping[str, Any]) -> str:
    """Return the page: verdict, errors, quantities, steps, cells."""
    tables = ", ".join(found["tables"])
    lines = [f"# What the tables say: {tables}", "", f"Made by `{found['command']}`. Angles in degrees.", ""]
    lines += [f"**{verdict_told(found)}**", ""]
    lines += [few, ""] if (few := few_told(found)) else []
    if found["lacking"]:
        return "\n".join(lines)
    lines += [*_errors(found), *_reading(found)]
    if _drawn(found):
        lines += [f"![Simulated over measured, cell by cell]({PICTURE})", ""]
    lines += [*_quantities(found), *_steps(found)]
    for key, title in (("cells", "The cells that were fitted"), ("cells_held_out", "The cells that were held out")):
        if found[key]:
            lines += [f"## {title}", "", *_cells(found[key])]
    return "\n".join(lines).rstrip() + "\n"


def _errors(found: Mapping[str, Any]) -> Iterator[str]:
    yield from ("## Error", "", "| model | table | used | mean abs log ratio | loss | within two sigma |")
    yield "|---|---|---|---:|---:|---:|"
    for key, used in (("error", "fitted"), ("error_held_out", "held out")):
        for name, one in found[key].items():
            near = f"{one['near']} of {one['cells']}"
            for number, (table, ratio) in enumerate(one["mean_abs_log_ratio"].items()):
                rest = f"{one['loss']:.0f} | {near}" if number == 0 else " | "
                yield f"| {name} | {table} | {used} | {'' if ratio is None else format(ratio, '.2f')} | {rest} |"
    yield ""
    yield "The ratio is that of simulated over measured RMSE1, RMSE2 and largest error. Loss and count are over all cells of a"
    yield "line's group. Sigma holds the scatter of the tests, the rounding of the print, and 10 % (0.1 deg for a mean error)"
    yield "for a model whose form is never quite right; beyond two sigma the loss grows linearly (Huber)."
    if not found["held_out"]:
        yield "No table is held out: nothing shows whether the model predicts what it was not fitted to."
    yield ""


def _reading(found: Mapping[str, Any]) -> Iterator[str]:
    last, first = list(found["error"].values())[-1], next(iter(found["error"].values()))
    left = found["p_left"]
    yield f"The loss falls from {first['loss']:.0f} to {last['loss']:.0f}. Of 199 tables drawn from the last model itself, a"
    yield f"share of {left:.3f} is met no better than the measured one"
    yield (
        "(the model is not refitted to them)."
        if left > 0.05
        else "(the model is not refitted to them): a residual remains that it does not explain."
    )
    yield ""


def _quantities(found: Mapping[str, Any]) -> Iterator[str]:
    models = {name: one["quantities"] for name, one in found["models"].items() if one["quantities"]}
    names = list(dict.fromkeys(key for rows in models.values() for key in rows))
    yield from (
        "## What moved",
        "",
        f"| quantity | unit | published or usual | {' | '.join(models)} | sigma from published |",
    )
    yield f"|---|---|---:|{'---:|' * len(models)}---:|"
    last = list(models.values())[-1]
    for key in names:
        rows = [one.get(key) for one in models.values()]
        given = next(row for row in rows if row)
        values = " | ".join("" if row is None else f"{row['value']:.3g}{' (bound)' if row['at_bound'] else ''}" for row in rows)
        away = last.get(key, {}).get("sigma_from_published")
        yield (
            f"| `{key}` | {given['unit']} | {given['published']:.3g} | {values} | {'' if away is None else format(away, '.1f')} |"
        )
    yield ""


def _steps(found: Mapping[str, Any]) -> Iterator[str]:
    yield from ("## The search", "")
    yield "Each step predicts what every candidate would gain, on the measured table and on null replicates, drawn from the model"
    yield "before it. What promises more than 95 % of the replicates' best is refitted."
    yield from (
        "",
        "| step | model before | best | gain | largest gain of null replicates | replicates | chance |",
        "|---:|---|---|---:|---:|---:|---:|",
    )
    for number, step in enumerate(found["steps"], start=1):
        best = best_of(step)
        replicates = step["gains_of_twins"]
        most = f"{max(replicates):.1f}" if replicates else ""
        before = " + ".join(["base", *step["before"]])
        yield f"| {number} | {before} | `{best}` | {step['gain']:.1f} | {most} | {len(replicates)} | {step['p_value']:.3g} |"
    yield from (
        "",
        "Gain: fall of the loss relative to a control that is refitted the same way, less 2 for each quantity; as "
        "predicted where nothing was",
        "refitted. In each step:",
        "",
    )
    if (form := found["steps"][0].get("form", 1.0)) < 1.0:
        yield f"The base leaves less than 10 % to the form of a model, so gains are judged by {10.0 * form:.1f} %."
        yield ""
    for number, step in enumerate(found["steps"], start=1):
        yield f"{number}. promised: {_gains(step.get('predicted', ()))}; refitted: {_gains(step['candidates'])}"
    yield ""


def best_of(step: Mapping[str, Any]) -> str:
    """Return the name of a step's best candidate, fitted or promised."""
    found = step["candidates"] or step.get("predicted", ())
    return str(found[0]["name"]) if found else "nothing"


def _gains(candidates: Sequence[Mapping[str, Any]]) -> str:
    return ", ".join(f"`{one['name']}` {one['gain']:.1f}" for one in candidates) or "nothing"


def _cells(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    names = list(rows[0]["simulated"])
    yield f"| table | condition | indicator | measured | {' | '.join(names)} | last, in sigma |"
    yield f"|---|---|---|---:|{'---:|' * len(names)}---:|"
    for row in rows:
        values = " | ".join(f"{row['simulated'][name]:.2f}" for name in names)
        error = row["error_in_sigma"][names[-1]]
        yield f"| {row['table']} | {row['condition']} | {row['indicator']} | {row['measured']:g} | {values} | {error:.1f} |"
    yield ""


def _drawn(found: Mapping[str, Any]) -> list[tuple[str, dict[int, Mapping[str, Any]]]]:
    """Return each group of cells that has a ratio to draw, by the line of the cell in its table; a mean error has none."""
    groups = []
    for key, title in (("cells", "fitted"), ("cells_held_out", "held out")):
        rows = {line: row for line, row in enumerate(found[key], start=1) if row["indicator"] != "sse_deg"}
        if rows:
            groups.append((title, rows))
    return groups


def draw(found: Mapping[str, Any], path: Path) -> None:
    """Write the picture: simulated over measured of every RMSE and largest error, fitted and held out; none without such."""
    from matplotlib.figure import Figure

    from hjcamp.report.pictures.conditions import own_settings

    if not (groups := _drawn(found)):
        return
    with own_settings({}), whole_file(path) as stream:
        figure = Figure(figsize=(9.0, 3.4), layout="constrained")
        axes = figure.subplots(1, len(groups), sharey=True, squeeze=False)[0]
        for axis, (title, rows) in zip(axes, groups, strict=True):
            names = list(next(iter(rows.values()))["simulated"])
            for name, colour, size in zip(names, ("#b03030", "#909090", "#2060a0"), (12, 10, 16), strict=False):
                ratio = [max(row["simulated"][name], 1e-3) / row["measured"] for row in rows.values()]
                axis.scatter(list(rows), ratio, s=size, color=colour, label=name, linewidths=0)
            axis.axhspan(math.exp(-GOAL), math.exp(GOAL), color="#000000", alpha=0.07, linewidth=0)
            axis.axhline(1.0, color="black", linewidth=0.8)
            axis.set_yscale("log")
            axis.set_yticks([0.25, 0.5, 1, 2, 4, 8, 16, 32], labels=["1/4", "1/2", "1", "2", "4", "8", "16", "32"])
            axis.minorticks_off()
            axis.set_title(f"{title}: {', '.join(dict.fromkeys(row['table'] for row in rows.values()))}", fontsize=9)
            axis.xaxis.get_major_locator().set_params(integer=True)
            axis.set_xlabel(f"line of its table of cells; grey: log ratio within {GOAL:g}", fontsize=8)
            axis.tick_params(labelsize=8)
        axes[0].set_ylabel("simulated / measured", fontsize=8)
        axes[0].legend(fontsize=8, frameon=False)
        figure.savefig(stream, format=path.suffix[1:], dpi=120)
