"""The page docs/thesis_gap.md and its picture, from the numbers in docs/thesis_gap.json alone."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from thesis_gap_facts import near, ratios, written
from thesis_gap_rig import OPENINGS

PICTURE = "images/thesis_gap.png"


def page(found: dict[str, Any], reading: str) -> str:
    """Return the whole text; ``reading`` is the hand-written part, its numbers filled in from ``found``."""
    last = str(found["accepted"])
    parts = [
        "# The thesis gap: what makes the simulation meet Tables 5.4.1 and 5.4.2\n",
        "Made by `make thesis_gap` (`python benchmarks/thesis_gap.py`) from docs/thesis_gap.json. Angles in degrees.\n",
        written(found, reading),
        f"![Simulated over printed, cell by cell]({PICTURE})\n",
        "## The models\n",
        _models(found),
        "## What was fitted\n",
        "`range` is the smallest and largest value in the seven fits that leave one trajectory out, each from the printed",
        "constants anew: how well the cells know it. Static friction is given as its ratio to Coulomb friction.\n",
        _values(found),
        "## Every candidate, one at a time\n",
        "Fall of the loss beside the control, which is the same model searched for as long from the same start without a",
        "candidate. `here` starts at the model as fitted, `fresh` at printed constants without a drop of friction and with the",
        "loop as the ramps ask for it; `longer` is the search of the best two of either start, beside the longer control.\n",
        _gains(found),
        "## Responses of the cells\n",
        _alike(found),
        "## Twins\n",
        _twins(found),
        "## Left-out trajectories\n",
        "Loss of the cells of the trajectory that was left out of the fit.\n",
        _left_out(found),
        "## The fitted cells\n",
        _cells(found["fitted"], last),
        "## The predicted cells: Tables 5.5.1 and 5.5.2, nothing fitted to them\n",
        _cells(found["predicted"], last),
    ]
    return "\n".join(parts).rstrip() + "\n"


def table(heads: Sequence[str], rows: Sequence[Sequence[Any]], texts: int = 1) -> str:
    """Return a table whose first ``texts`` columns are text and the others numbers."""
    lines = [f"| {' | '.join(heads)} |", "|---" * texts + "|---:" * (len(heads) - texts) + "|"]
    lines += [f"| {' | '.join('' if cell is None else str(cell) for cell in row)} |" for row in rows]
    return "\n".join(lines) + "\n"


def _title(found: dict[str, Any], name: str) -> str:
    if name == "published":
        return "as printed"
    number, names = int(name), found["models"][int(name)]["names"]
    if number < 2:
        return ("base", "base and loop")[number]
    return "and " + " and ".join(names[2:]) + (" (accepted)" if number == found["accepted"] else "")


def _models(found: dict[str, Any]) -> str:
    fitted, predicted = found["fitted"], found["predicted"]
    rows = []
    for column, name in enumerate(fitted["loss"]):
        model = None if name == "published" else found["models"][int(name)]
        held = [row[column] for row in found["left_out"].values() if column < len(row)]
        rows.append(
            [
                _title(found, name),
                model["quantities"] if model else 0,
                f"{fitted['loss'][name]:.0f}",
                near(fitted["errors"][name]),
                f"{sum(held):.0f}" if held else "",
                f"{statistics.median(ratios(fitted, name)):.2f}",
                f"{predicted['loss'][name]:.0f}",
                near(predicted["errors"][name]),
                f"{statistics.median(ratios(predicted, name)):.2f}",
            ]
        )
    count, other = len(fitted["printed"]), len(predicted["printed"])
    heads = ["model", "quantities", "loss", f"near, of {count}", "loss left out", "ratio"]
    return table([*heads, "loss predicted", f"near, of {other}", "ratio predicted"], rows) + (
        "\nLoss: Huber loss summed over the cells, seven repetitions; about 1 a cell is as good as it gets. Near: within two"
        "\nstandard errors. Loss left out: sum over the trajectories of the loss when they were not fitted (three"
        "\nrepetitions). Ratio: median of simulated over printed.\n"
    )


def _values(found: dict[str, Any]) -> str:
    models = found["models"]
    names = list(dict.fromkeys(name for model in models for name in model["values"]))
    rows = []
    for name in names:
        owner = next(model for model in models if name in model["values"])
        row: list[Any] = [f"`{name}`", owner["units"][name], f"{owner['printed'][name]:.3g}"]
        row += [f"{model['values'][name]:.3g}" if name in model["values"] else "" for model in models]
        pair = models[1]["ranges"].get(name)
        rows.append([*row, "{:.3g} to {:.3g}".format(*pair) if pair else ""])
    heads = ["quantity", "unit", "printed or start", *(_title(found, str(n)) for n in range(len(models)))]
    text = table([*heads, "range of base and loop"], rows, 2)
    return text + "\n" + "\n".join(f"* `{name}`: {one.text}" for name, one in OPENINGS.items()) + "\n"


def _gains(found: dict[str, Any]) -> str:
    steps = found["steps"]
    names = sorted(steps[0]["gains"], key=lambda name: -max(value or -1e9 for value in steps[0]["gains"][name]))
    rows = []
    for name in names:
        cells: list[Any] = [f"`{name}`"]
        for step in steps:
            cells += step["gains"].get(name, [None] * 3)
        rows.append(cells)
    heads = ["candidate", *(("here", "fresh", "longer") * len(steps))]
    rows.insert(0, ["(loss of the control)", *(value for step in steps for value in step["control"])])
    return table(heads, rows)


def _alike(found: dict[str, Any]) -> str:
    inside, pairs = found["alike"]["inside"], found["alike"]["pairs"]
    lines = [
        "About the accepted model, a change of the candidate by 0.15 on its fitted scale, three repetitions. Without any trace",
        f"or within the span of what is fitted already: {', '.join(f'`{name}`' for name in inside) or 'none'}.\n",
    ]
    if pairs:
        lines.append(
            "Pairs that change the cells alike, beyond what the fitted quantities take up (cosine above 0.8):\n"
        )
        lines.append(table(["candidate", "like", "cosine"], [[f"`{a}`", f"`{b}`", c] for a, b, c in pairs], 2))
    else:
        lines.append(
            "No two others change the cells alike (cosine above 0.8) beyond what the fitted quantities take up.\n"
        )
    return "\n".join(lines)


def _twins(found: dict[str, Any]) -> str:
    lines = [
        "Twins are tables simulated from a fitted model with the rig's scatter and 10 % error of form, rounded as printed.",
        "Gain: twins of 'base and loop', in which the accepted candidates are absent; both models are refitted to each from",
        "where they were fitted, and the gain is the fall of the loss. Loss: the accepted model on twins of its own, not refitted.",
        "",
    ]
    twins = found["twins"]
    rows = []
    for what, real, drawn, p in (
        ("gain of the accepted", twins["gain"], twins["gains"], twins["p_gain"]),
        ("loss of the accepted", twins["loss"], twins["losses"], twins["p_loss"]),
    ):
        spread = f"{statistics.median(drawn):.1f} ({drawn[0]:.1f} to {drawn[-1]:.1f})"
        rows.append([what, f"{real:.1f}", spread, f"{p:.2f}"])
    return "\n".join(lines) + "\n" + table(["", "thesis", f"{len(twins['gains'])} twins", "p"], rows)


def _left_out(found: dict[str, Any]) -> str:
    names = list(found["fitted"]["loss"])[:3]
    rows = [[trajectory, *(f"{value:.0f}" for value in row)] for trajectory, row in found["left_out"].items()]
    sums = [sum(row[place] for row in found["left_out"].values()) for place in range(len(names))]
    rows.append(["sum", *(f"{value:.0f}" for value in sums)])
    return table(["trajectory", *(_title(found, name) for name in names)], rows)


def _cells(cells: dict[str, Any], last: str) -> str:
    rows = []
    for place, label in enumerate(cells["labels"]):
        trajectory, controller, _, orientation, indicator = label
        row = [trajectory, controller, orientation, indicator.removesuffix("_deg"), f"{cells['printed'][place]:.1f}"]
        for name in ("published", last):
            row += [f"{cells['means'][name][place]:.2f}", f"{cells['errors'][name][place]:.1f}"]
        rows.append(row)
    heads = [
        "trajectory",
        "controller",
        "arm",
        "indicator",
        "printed",
        "as printed",
        "in sigma",
        "last model",
        "in sigma",
    ]
    return table(heads, rows, 4)


def draw(found: dict[str, Any], path: Path) -> None:
    """Draw simulated over printed of every cell, as printed and fitted, for both groups of tables."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    last = str(found["accepted"])
    figure, axes = pyplot.subplots(1, 2, figsize=(9.0, 4.2), sharey=True, layout="constrained")
    titles = {"fitted": "Table 5.4.1 (fitted)", "predicted": "Table 5.5.1 (predicted)"}
    for axis, (kind, title) in zip(axes, titles.items(), strict=True):
        for name, colour, label in (("published", "0.6", "as printed"), (last, "tab:blue", "accepted model")):
            values = ratios(found[kind], name)
            axis.plot(range(1, len(values) + 1), values, "o", ms=4, color=colour, label=label)
        axis.axhspan(0.8, 1.25, color="tab:green", alpha=0.15, lw=0)
        axis.axhline(1.0, color="black", lw=0.8)
        axis.set(yscale="log", title=title, xlabel="cell, in the order of the table")
        axis.set_yticks([0.5, 1, 2, 5, 10, 20, 50], ["0.5", "1", "2", "5", "10", "20", "50"])
    axes[0].set_ylabel("simulated over printed")
    axes[0].legend(loc="upper left")
    figure.savefig(path, dpi=110)
    pyplot.close(figure)
