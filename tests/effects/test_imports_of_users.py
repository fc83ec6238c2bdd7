"""What files of users import goes on to lead to the same classes, wherever these live inside."""

from __future__ import annotations

import importlib

import pytest


@pytest.mark.parametrize(
    ("module", "names"), [("hjcamp.model.effect", ["Effect"]), ("hjcamp.model.parameter", ["Parameter", "State"])]
)
def test_older_effects_import_the_classes_of_the_face(module: str, names: list[str]) -> None:
    face = importlib.import_module("hjcamp.effect")
    for name in names:
        assert getattr(importlib.import_module(module), name) is getattr(face, name)
