"""What no push changes is computed once, and what closed gates leave unused not at all; no rate is another one for that."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from plant_texts import ROTOR
from two_contacts import FREE_PENDULUM, FREE_SPRING

from hjcamp.effects import library_of
from hjcamp.known_plants import find_plant
from hjcamp.model.compile.compose import Composition
from hjcamp.model.compile.function_sources import contact_source, rates_source, terms_source
from hjcamp.model.compile.source_text import behind_one_test, where_used
from hjcamp.model.compile.structure import regimes
from hjcamp.model.language.amount_formula import plain_functions

PLANTS = {"free_spring": FREE_SPRING, "free_pendulum": FREE_PENDULUM, "rotor": ROTOR}


@pytest.fixture
def plants(folder: Path) -> Path:
    for name, text in PLANTS.items():
        (folder / "plants" / f"{name}.py").write_text(text)
    return folder


def of(composition: Composition) -> tuple[str, dict[str, Any]]:
    """Return the text of a composition's rates and contacts, and its functions as plain Python."""
    text = rates_source(composition)
    return text, plain_functions(terms_source(composition) + text + contact_source(composition))


@pytest.mark.parametrize("name", PLANTS)
def test_with_any_gates_open_rates_and_contacts_are_those_of_these_effects_alone(plants: Path, name: str) -> None:
    plant, generator = find_plant(name), np.random.default_rng(11)
    library = library_of(plant, []).effects
    whole = Composition(plant, tuple(library.values()), gated=True)
    _, gated = of(whole)
    for _ in range(60):
        names = sorted(str(one) for one in generator.choice(list(library), 3, replace=False))
        alone = Composition(plant, tuple(library[one] for one in names))
        _, plain = of(alone)
        values = {key: one.default * generator.uniform(0.5, 1.5) for key, one in whole.parameters.items()}
        values |= {f"gate.{one}": float(one in names) for one in library}
        values["gates"] = float(sum(1 << list(library).index(one) for one in names))
        states = {key: one.typical * generator.normal() for key, one in whole.states.items()}
        u = np.array([generator.normal() for _ in whole.inputs])
        for direction in regimes(whole, generator):
            found = []
            for composition, functions in ((whole, gated), (alone, plain)):
                z = np.array([states[key] for key in composition.states])
                p = np.array([values[key] for key in composition.parameters])
                rates = np.zeros(len(z))
                with np.errstate(all="ignore"):
                    functions["rates"](-1, 0.3, direction, z, u, p, rates)
                    held = [functions["contact"](k, 0.3, direction, z, u, p) for k in range(len(composition.contacts))]
                one = dict(zip(composition.states, rates, strict=True))
                found.append([*(one[key] for key in alone.states), *np.ravel(held)])
            assert np.array_equal(*found, equal_nan=True), (names, direction)


def test_what_depends_on_no_push_is_computed_once(plants: Path) -> None:
    plant = find_plant("free_spring")
    text, _ = of(Composition(plant, tuple(library_of(plant, []).effects.values()), gated=True))
    assert text.count(" spring__load(") == 1 and text.count(" hard_stop__load(") == 1
    # the side to which an asymmetry is decided at rest by the push
    assert text.count(" coulomb_asymmetry_at_first__first_coulomb(") == 2


def test_what_only_one_effect_uses_is_changed_only_beside_it() -> None:
    lines = ["a = 1.0", "if gates & 1: a = a + 2.0", "if gates & 8: a = a * 3.0", "b = 5.0", "if gates & 4: b = b + a"]
    text = behind_one_test(where_used(lines, ["c = b"]))
    assert text[1:4] == ["if gates & 4:", "    if gates & 9:", "        if gates & 1: a = a + 2.0"]
    for gates in range(16):
        found, wanted = {"gates": gates}, {"gates": gates}
        exec("\n".join(text), found)
        exec("\n".join(lines), wanted)
        assert found["b"] == wanted["b"]
    assert where_used(lines, ["if gates & 2: d = a", "c = b"])[1] == "if gates & 6 and gates & 1: a = a + 2.0"
    assert where_used(lines, ["c = a"]) == lines
