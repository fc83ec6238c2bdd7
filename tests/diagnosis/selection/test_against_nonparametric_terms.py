"""A free law shows that something is missing; a name that leaves less is it where that is shown by itself."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from hjcamp.diagnosis.selection import forward
from hjcamp.diagnosis.selection.forward import Search
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.model.declare.candidate import Candidate

CLAIMS = 0.05


def scored(left: float, *names: str) -> SimpleNamespace:
    candidate = Candidate({})
    for name in names:
        candidate = candidate.with_effect(name, {})
    return SimpleNamespace(fitted=SimpleNamespace(candidate=candidate), left_out=left, names=names)


@pytest.mark.parametrize(("p", "named"), [(0.02, True), (0.3, False)])
def test_a_name_that_leaves_less_than_a_free_law_has_to_be_shown_by_itself(
    p: float, named: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    before, lag, free = scored(3.7), scored(3.4, "sensor_lag"), scored(3.5, "force_over_time")
    chance = {"sensor_lag": p, "force_over_time": 0.001}
    monkeypatch.setattr(forward, "equivalent_laws", lambda free, name: False)
    search = Search.__new__(Search)
    search.library, search.unknowns = {"sensor_lag": None}, {"force_over_time": None}  # type: ignore[dict-item]
    search.matters = lambda model, before, level=CLAIMS: chance[model.names[0]] < level  # type: ignore[method-assign]
    # the best of four: none of them stands out among all
    step = SimpleNamespace(named=[lag], unknown=[free], claims=CLAIMS, level=CLAIMS / 4.0, level_of_unknown=CLAIMS / 2.0)
    found = search.better_than_free_laws(before, step)  # type: ignore[arg-type]
    assert found is (lag if named else None)


def test_models_are_told_apart_though_they_hold_arrays() -> None:
    one, other = (Scored(("spring",), None, np.zeros((2, 3)), 1.0, None) for _ in range(2))  # type: ignore[arg-type]
    assert one in (other, one) and one not in (other,)
