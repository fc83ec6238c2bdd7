"""Effects of the pump joint that became generic are, number by number and line by line, what they were."""

from __future__ import annotations

import ast

import pytest
from laws_before import BEFORE

from hjcamp.effects import load_effects
from hjcamp.model.compile.compose import Composition
from hjcamp.model.compile.function_sources import (
    balance_source,
    contact_source,
    memory_source,
    rates_source,
    readings_source,
    signals_source,
    terms_source,
)
from hjcamp.model.declare.effect import Effect
from hjcamp.plants.pump_joint import PumpJoint

LIBRARY = load_effects([])
CUTS = [cut.name for cut in PumpJoint.cuts]


class _Names(ast.NodeTransformer):
    """Give each function's arguments their place as name, and drop what is for readers alone."""

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        self.names = {argument.arg: f"a{place}" for place, argument in enumerate(node.args.args)}
        if "__" in node.name:
            self.generic_visit(node)
        if ast.get_docstring(node) is not None:
            del node.body[0]
        return node

    def visit_arg(self, node: ast.arg) -> ast.AST:
        return ast.arg(self.names[node.arg])

    def visit_Name(self, node: ast.Name) -> ast.AST:
        return ast.Name(self.names.get(node.id, node.id))


def sources(effects: list[type[Effect]], cut: str, gated: bool) -> list[str]:
    """Return all generated source of the pump joint with these effects, by the places of arguments."""
    composition = Composition(PumpJoint, tuple(effects), PumpJoint.cut(cut), gated)
    parts = [
        terms_source(composition),
        rates_source(composition),
        contact_source(composition),
        readings_source(composition),
        balance_source(composition),
        signals_source(composition),
        memory_source(composition),
    ]
    return [ast.unparse(_Names().visit(ast.parse(part))) for part in parts]


@pytest.mark.parametrize("name", BEFORE)
def test_names_numbers_and_units_are_as_before(name: str) -> None:
    before, now = BEFORE[name], LIBRARY[name]
    assert list(now.parameters.items()) == list(before.parameters.items())
    assert list(now.states.items()) == list(before.states.items())
    assert (now.subsystem, now.same_as, now.exact_in) == (before.subsystem, before.same_as, before.exact_in)


@pytest.mark.parametrize("name", BEFORE)
def test_the_kernel_of_one_effect_is_as_before(name: str) -> None:
    before = BEFORE[name]
    before.name = name
    for cut in CUTS:
        assert sources([LIBRARY[name]], cut, False) == sources([before], cut, False)


@pytest.mark.parametrize("gated", [False, True])
def test_the_kernel_of_the_whole_library_is_as_before(gated: bool) -> None:
    for name, before in BEFORE.items():
        before.name = name
    for cut in CUTS:
        before = [BEFORE.get(name, effect) for name, effect in LIBRARY.items()]
        assert sources(list(LIBRARY.values()), cut, gated) == sources(before, cut, gated)


def test_another_law_would_be_seen() -> None:
    class Wrong(BEFORE["leakage"]):  # type: ignore[misc,name-defined]
        @staticmethod
        def leak1(pressure1, conductance, threshold, conductance_above):  # type: ignore[no-untyped-def]
            return conductance * pressure1 + conductance_above * max(pressure1 - threshold, 1.0)

        leak2 = leak1

    Wrong.name = "leakage"
    assert sources([LIBRARY["leakage"]], "whole", False) != sources([Wrong], "whole", False)
