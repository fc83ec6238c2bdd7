"""Longer windows say more where all that they leave has what shorter ones have named, and something beside it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from hjcamp.diagnosis.decision import verdict


@pytest.mark.parametrize(
    ("word", "sets", "more"),
    [
        ("effect", (("lag", "leak"),), True),
        ("one_of", (("lag", "leak"), ("lag", "brim")), True),
        # that or nothing more, another lag, and what names nothing
        ("one_of", (("lag", "leak"), ("lag",)), False),
        ("one_of", (("lag", "leak"), ("late", "leak")), False),
        ("effect", (("lag",),), False),
        ("outside_library", (), False),
    ],
)
def test_more_is_named_where_no_set_lacks_what_was_named(
    monkeypatch: pytest.MonkeyPatch, word: str, sets: tuple[tuple[str, ...], ...], more: bool
) -> None:
    other = SimpleNamespace(word=word, confidence_set=sets, effects=())
    seen: Any = SimpleNamespace(search=SimpleNamespace(claims=0.05))
    monkeypatch.setattr(verdict, "judged", lambda analysis: other)
    monkeypatch.setattr(verdict, "_over", lambda analysis, at, width: seen)
    analysis: Any = SimpleNamespace(windows=SimpleNamespace(layout=SimpleNamespace(width=16)))
    before: Any = SimpleNamespace(effects=("lag",))
    found = verdict._more_in_longer(analysis, before, lambda width: seen)
    assert (found == (seen, other)) == more and (found is None) != more
    assert seen.search.claims == pytest.approx(0.025)


@pytest.mark.parametrize(("samples", "width", "looks"), [(1993, 24, [48, 83]), (9600, 100, [200, 400]), (600, 24, [48])])
def test_of_few_samples_longer_windows_are_as_long_as_leaves_enough_of_them(
    monkeypatch: pytest.MonkeyPatch, samples: int, width: int, looks: list[int]
) -> None:
    asked: list[int] = []
    nothing = SimpleNamespace(word="nothing_missing", follows=0.0, refused=(), effects=(), unknown=None)
    few = SimpleNamespace(**{**vars(nothing), "word": "cannot_tell"})
    measured = SimpleNamespace(tests=[SimpleNamespace(samples=samples)], repeated=False)

    def look(analysis: Any, at: Any, wide: int) -> Any:
        asked.append(wide)
        return SimpleNamespace(search=SimpleNamespace(claims=0.05), windows=layout(wide))

    def layout(wide: int) -> Any:
        return SimpleNamespace(layout=SimpleNamespace(width=wide, memory=0))

    monkeypatch.setattr(verdict, "_over", look)
    monkeypatch.setattr(verdict, "judged", lambda one: nothing if samples // one.windows.layout.width >= 24 else few)
    analysis: Any = SimpleNamespace(windows=layout(width), measured=measured)
    verdict._looked_at(analysis, lambda wide: analysis)
    assert asked == looks
