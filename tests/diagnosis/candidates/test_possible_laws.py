"""The kernel that is compiled ahead has every law that tests may ask for: none is compiled twice."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import flywheel
import numpy as np
import pytest
import slide

from hjcamp.diagnosis.candidates.nonparametric_terms import possible_laws, ranges_of, unknowns_of
from hjcamp.diagnosis.residuals.kernels import Kernels
from hjcamp.effects import load_effects
from hjcamp.known_plants import find_plant
from hjcamp.model.compile.compose import MOST_GATED
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.language.vocabulary import read_vocabulary

PLANTS = ["pump_joint", "valve_joint", "two_pumps", "slide", "flywheel"]


def plant_of(name: str, folder: Path) -> Any:
    for own, module in (("slide", slide), ("flywheel", flywheel)):
        (folder / f"{own}.py").write_text(module.PLANT, encoding="utf-8")
    return find_plant(name, folders=[folder])


@pytest.mark.parametrize("name", PLANTS)
@pytest.mark.parametrize("seed", range(4))
def test_whatever_tests_visit_its_laws_were_possible(name: str, seed: int, tmp_path: Path) -> None:
    plant, draw = plant_of(name, tmp_path), np.random.default_rng(seed)
    names = [*read_vocabulary(plant).signals, *plant.states, *plant.inputs]
    courses = {one: np.cumsum(draw.normal(size=300)) * 10.0 ** draw.uniform(-2.0, 2.0) for one in names}
    courses |= {one: np.zeros(300) for one in names if draw.uniform() < 0.3}
    asked = unknowns_of(plant, ranges_of(courses, np.linspace(0.0, 9.0, 300)), courses)
    possible = possible_laws(plant)
    assert asked and {one: law.effect for one, law in asked.items()}.items() <= possible.items()


def test_the_first_kernel_stays_the_same_when_laws_come_in(tmp_path: Path) -> None:
    plant = plant_of("slide", tmp_path)
    library, laws = load_effects(plant=plant), possible_laws(plant)
    kernels = Kernels(plant, library)
    kernels.foresee(laws)
    first, law = next(iter(library)), next(iter(laws))
    before = kernels._chosen([first])
    assert set(before) == {*library, *laws} and len(before) <= MOST_GATED
    kernels.add({law: laws[law]})
    assert kernels._chosen([first, law]) == before
    assert kernels.model(Candidate({}, {law: {}}))[0] is kernels._simulator(before)
    # what is too much for one kernel is left out until it is asked for
    many = {f"more_{k}": laws[law] for k in range(MOST_GATED - len(library))}
    kernels.add(many)
    assert set(kernels._chosen([first])) == {*library, law, *many} - {list(many)[-1]}
