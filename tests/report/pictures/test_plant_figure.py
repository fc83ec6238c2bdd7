"""The block diagram of a plant: its links are those of the equations, however its places were declared."""

from __future__ import annotations

from typing import Any

import pytest
from matplotlib.figure import Figure

from hjcamp.known_plants import find_plant
from hjcamp.model.language.vocabulary import read_vocabulary
from hjcamp.report.pictures.plant import columns, links, paint_plant, without_partitions


def test_the_links_of_the_pump_joint_are_those_of_its_equations() -> None:
    direct, through = links(read_vocabulary(find_plant("pump_joint", folders=[])))
    lines = {("line1", "gauge1"), ("line2", "gauge2"), ("line1", "crossing"), ("line2", "crossing")}
    pushes = {("line1", "sliders"), ("line2", "sliders"), ("seal", "sliders"), ("sliders", "seal")}
    assert direct == lines | pushes | {("motor", "pistons"), ("sliders", "encoder")}
    # dp/dt = K (A1 dx - A2 dy - q12): pressures are states, moved by pistons, sliders and the flow between the lines
    assert through == {(source, line) for source in ("pistons", "sliders", "crossing") for line in ("line1", "line2")}


@pytest.mark.parametrize(
    ("name", "first"),
    [
        ("pump_joint", [["motor"], ["pistons"], ["line1", "line2"]]),
        ("two_pumps", [["pistons1", "pistons2", "motor1", "motor2"], ["line1", "line2"]]),
        ("valve_joint", [["flow1", "flow2", "flow3", "flow4"], ["line1", "line2"]]),
    ],
)
def test_it_begins_where_the_command_comes_in_and_draws_each_place(name: str, first: list[list[str]]) -> None:
    plant = find_plant(name, folders=[])
    vocabulary = without_partitions(plant)
    direct, through = links(vocabulary)
    found = columns(vocabulary, direct | through)
    assert found[: len(first)] == first
    assert sorted(one for column in found for one in column) == sorted(vocabulary.ports)
    figure: Any = Figure()
    paint_plant(figure, plant)
    drawn = {one.get_text() for one in figure.axes[0].texts}
    assert set(vocabulary.ports) <= drawn and any(plant.sentence()[:20] in one for one in drawn)
    # each pair has one arrow, with two heads where both depend on each other
    pairs = {frozenset(pair) for pair in direct | through}
    arrows = [one for one in figure.axes[0].patches if type(one).__name__ == "FancyArrowPatch"]
    assert len(arrows) == len(pairs)
