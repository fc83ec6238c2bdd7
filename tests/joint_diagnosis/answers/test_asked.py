"""Which effects get a row whatever they explain, and the band of a named law."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from hjcamp.analyses.diagnosing import asked_names, own_and_asked, with_asked
from hjcamp.commands.any_plant.evidence import amplitude_band
from hjcamp.effects import effect_files
from hjcamp.errors import UsageError

OURS = effect_files([])


def test_the_users_own_effects_and_those_asked_for_get_a_row() -> None:
    own = SimpleNamespace(__module__="hjcamp_file_mine_0123")
    library = {"mine": own, "leakage": OURS["leakage"], "spring": OURS["spring"]}
    assert own_and_asked(library, None) == ["mine"]
    assert own_and_asked(library, "spring, mine") == ["spring", "mine"]
    rows = with_asked([{"effect": "leakage"}, {"effect": "mine"}], [{"effect": "spring"}], ["mine", "spring"])
    assert [(row["effect"], row.get("asked", False)) for row in rows] == [
        ("leakage", False),
        ("mine", True),
        ("spring", True),
    ]
    with pytest.raises(UsageError, match="give the names"):
        asked_names("")


def test_the_band_of_a_law_is_that_of_its_amplitude() -> None:
    rows = [
        {
            "effect": "spring",
            "parameters": {
                "rest_position": {"value": 1.0, "ci95": [0.0, 2.0]},
                "stiffness": {"value": 140.0, "ci95": [126.0, 147.0]},
            },
        }
    ]
    assert amplitude_band(rows, ["spring"], OURS) == pytest.approx((0.9, 1.05))
    assert amplitude_band(rows, ["spring", "leakage"], OURS) == (1.0, 1.0)
    assert amplitude_band([], ["spring"], OURS) == (1.0, 1.0)
    turned = [{"effect": "spring", "parameters": {"stiffness": {"value": -2.0, "ci95": [-3.0, -1.0]}}}]
    assert amplitude_band(turned, ["spring"], OURS) == (0.5, 1.5)
