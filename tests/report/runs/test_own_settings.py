"""Figures are drawn by settings of the program's own: what a matplotlibrc of the user's other work asks for changes none."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import matplotlib
import numpy as np
import pytest

import hjcamp
from hjcamp.known_plants import find_plant
from hjcamp.plants.pump_joint.figures.budget import draw_budget
from hjcamp.plants.pump_joint.figures.sizing import FIGURES, draw_figures
from hjcamp.report.pictures.drawing import draw_errors
from hjcamp.report.pictures.map import draw_map
from hjcamp.report.pictures.plant import draw_plant

# What people ask for in papers and dark notebooks; LaTeX need not be there.
ASKED = {
    "text.usetex": True, "font.size": 30.0, "axes.facecolor": "black", "figure.dpi": 300.0, "savefig.bbox": "tight",
    "axes.prop_cycle": matplotlib.cycler(color=["red", "lime"]), "axes.grid": True, "axes.unicode_minus": False, "lines.linewidth": 7.0,
}  # fmt: skip


def written(draw: Callable[[Path], object]) -> Callable[[Path], str]:
    def content(folder: Path) -> str:
        draw(folder)
        [path] = folder.iterdir()
        return path.read_bytes().hex()

    return content


DRAWN: dict[str, Callable[[Path], str]] = {
    "bars": lambda _: draw_errors([("model", 2.0), ("floor", 1.0)], "over the floor"),
    "a map": lambda _: draw_map("50 % of it", ("x_1 (mm)", [0.0, 1.0]), ("v (m/s)", [0.0, 1.0]), np.eye(2)),
    "sizing": written(lambda folder: draw_figures(folder, figures={"string_torque": FIGURES["string_torque"]})),
    "a plant": written(lambda folder: draw_plant(folder / "plant.png", find_plant("pump_joint", folders=[]))),
    "a budget": written(lambda folder: draw_budget(folder / "b.png", "90 %", [("a_b", np.array([[1.0, 2.0], [2.0, 4.0]]))])),
}


@pytest.fixture
def asked() -> Iterator[dict[str, object]]:
    with matplotlib.rc_context(ASKED):
        yield {key: matplotlib.rcParams[key] for key in ASKED}


@pytest.mark.parametrize("name", DRAWN)
def test_a_figure_is_the_same_whatever_a_matplotlibrc_asks_for(name: str, tmp_path: Path, asked: dict[str, object]) -> None:
    (tmp_path / "asked").mkdir()
    (tmp_path / "plain").mkdir()
    found = DRAWN[name](tmp_path / "asked")
    # a notebook keeps what its user set
    assert {key: matplotlib.rcParams[key] for key in ASKED} == asked
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        assert found == DRAWN[name](tmp_path / "plain")


def test_every_file_that_makes_figures_draws_by_them() -> None:
    root = Path(hjcamp.__file__).parent
    makers = [path for path in root.rglob("*.py") if "matplotlib.figure import Figure" in path.read_text(encoding="utf-8")]
    assert len(makers) > 8
    assert [path.name for path in makers if "own_settings(" not in path.read_text(encoding="utf-8")] == []
