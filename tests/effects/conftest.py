"""One gated kernel with the whole library and an effect of the user's: compiling it once serves all tests here."""

from __future__ import annotations

import pytest

from hjcamp.effects import load_effects
from hjcamp.effects._template import write_template
from hjcamp.model.declare.effect import Effect
from hjcamp.model.run.simulator import Simulator
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.effect_checks import EffectBench, bench_simulator

THEIRS = "arm_spring"


@pytest.fixture(scope="session")
def library(tmp_path_factory: pytest.TempPathFactory) -> dict[str, type[Effect]]:
    """Our effects, and one that ``hjcamp effects new`` wrote."""
    folder = tmp_path_factory.mktemp("theirs") / "effects"
    write_template(THEIRS, folder, PumpJoint, load_effects([]))
    return load_effects([folder])


@pytest.fixture(scope="session")
def simulator(library: dict[str, type[Effect]]) -> Simulator:
    """All effects behind gates, driven by the pump position."""
    return bench_simulator(PumpJoint, tuple(library.values()))


@pytest.fixture(scope="session")
def benches(library: dict[str, type[Effect]], simulator: Simulator) -> dict[str, EffectBench]:
    """One bench for each effect."""
    courses = PumpJoint.courses()
    return {name: EffectBench(effect, simulator, courses) for name, effect in library.items()}
