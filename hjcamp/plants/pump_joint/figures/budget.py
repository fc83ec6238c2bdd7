"""The bars of a budget: the error of the rig as it is, and with each part made better."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hjcamp.report.pictures.conditions import BLUE, INK, RED, own_settings
from hjcamp.report.pictures.drawing import dress
from hjcamp.storage import whole_file


def draw_budget(path: Path, title: str, rows: Sequence[tuple[str, NDArray[np.float64]]]) -> None:
    """Write bars of mean RMSE1 and largest error with their deviations; the first row is the rig as it is.

    Dark: as it is; blue: an error that is not larger; red: a larger one. ``rows`` are names and errors in deg, (repetitions, 2).
    """
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    names = [name for name, _ in rows]
    places = np.arange(len(rows))[::-1]
    with own_settings():
        figure = Figure(figsize=(8.4, 1.4 + 0.32 * len(rows)), layout="constrained")
        figure.suptitle(title, x=0.01, ha="left", fontsize=10)
        for column, (axes, label) in enumerate(
            zip(figure.subplots(1, 2, sharey=True), ("RMSE1 (deg)", "Largest error (deg)"), strict=True)
        ):
            means = [float(errors[:, column].mean()) for _, errors in rows]
            spread = [float(errors[:, column].std(ddof=1)) if len(errors) > 1 else 0.0 for _, errors in rows]
            colours = [INK, *(BLUE if mean <= means[0] else RED for mean in means[1:])]
            axes.barh(places, means, xerr=spread, color=colours, height=0.62, error_kw={"elinewidth": 0.9, "ecolor": INK})
            axes.axvline(means[0], color=INK, linewidth=0.7, linestyle=(0, (4, 2.5)))
            dress(axes, "")
            axes.set_yticks(places, names)
            axes.set_xlabel(label, fontsize=8.5)
        handles = [Patch(color=colour, label=told) for colour, told in ((BLUE, "not larger"), (RED, "larger than as it is"))]
        figure.legend(handles=handles, loc="upper right", ncols=2, fontsize=8, frameon=False)
        with whole_file(path) as stream:
            figure.savefig(stream, dpi=150, format=path.suffix[1:].lower())
