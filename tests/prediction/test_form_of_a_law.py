"""A further name that takes no more than another form of a law that is there is no second thing that is missing."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from hjcamp.effects import load_effects
from hjcamp.known_plants import find_plant
from hjcamp.model.candidate import Candidate
from hjcamp.model.vocabulary import read_vocabulary
from hjcamp.prediction.laws import alike_laws
from hjcamp.prediction.selection import Search
from hjcamp.prediction.unknowns import Unknown, unknowns_of


@pytest.fixture
def known(tanks: Path) -> tuple[dict, dict[str, Unknown]]:  # type: ignore[type-arg]
    plant = find_plant("tanks")
    ranges = dict.fromkeys((*plant.states, *read_vocabulary(plant).signals), (0.5, 8.0))
    return load_effects(plant=plant), unknowns_of(plant, ranges)


def test_which_free_laws_are_other_forms_of_a_name(known) -> None:  # type: ignore[no-untyped-def]
    library, unknowns = known
    exponent = library["flow_exponent_at_outflow"]
    assert {name for name, one in unknowns.items() if alike_laws(one, exponent)} == {
        "unknown_flow_over_upstream_at_outflow", "unknown_loss_over_level_at_lower",
    }  # fmt: skip
    # of the level, too, but of what the gauge makes of it
    assert not alike_laws(unknowns["unknown_reading_over_true"], exponent)
    assert alike_laws(unknowns["unknown_reading_over_true"], library["sensor_gain"])


@pytest.mark.parametrize(
    ("free", "left", "mends"),
    [
        ("unknown_loss_over_level_at_lower", 1.51, True),
        # it takes less than the further name
        ("unknown_loss_over_level_at_lower", 1.56, False),
        # over the same level, but another thing
        ("unknown_reading_over_true", 1.51, False),
    ],
)
def test_a_further_name_is_none_where_the_law_of_the_first_is_off(known, free: str, left: float, mends: bool) -> None:  # type: ignore[no-untyped-def]
    library, unknowns = known
    first = Candidate({}).with_effect("flow_exponent_at_outflow", {"exponent": 0.2})

    def scored(candidate: Candidate, error: float) -> SimpleNamespace:
        return SimpleNamespace(fitted=SimpleNamespace(candidate=candidate), left_out=error, names=tuple(candidate.effects))

    model, further = scored(first, 1.67), scored(first.with_effect("sensor_offset", {"offset": 0.1}), 1.53)
    step = SimpleNamespace(unknown=(scored(first.with_effect(free, {}), left),), level_of_unknown=0.025)
    search = Search.__new__(Search)
    search.library, search.unknowns, search.windows = library, unknowns, SimpleNamespace(forms=frozenset())  # type: ignore[assignment]
    search.matters = lambda model, before, level=0.05: True  # type: ignore[method-assign]
    assert search.mends(further, model, step) == mends  # type: ignore[arg-type]
