"""The study of `hjcamp next`: which duels it fights, how it goes on, and what its page says of them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import pytest

from benchmarks.next_value import running as next_value
from benchmarks.next_value.page import MOST, page

NEVER = MOST + 1


def test_more_rigs_leave_the_seeds_of_the_others_as_they_are() -> None:
    few, many = next_value.questions(14, 1, 4), next_value.questions(14, 3, 4)
    assert set(few) < set(many) and len(many) == 2 * 14 * 3
    assert len({one.number for one in many}) == len({one.name for one in many}) == len(many)
    assert set(next_value.questions(3, 2, 4)) < set(many)


def lines_of(results: list[tuple[int | None, list[int]]]) -> list[Any]:
    asked = next_value.questions(14, 1, 2)[: len(results)]
    return [
        (one, {"name": one.name, "ours": ours, "theirs": theirs}) for one, (ours, theirs) in zip(asked, results, strict=True)
    ]


def test_the_page_counts_the_duels_that_say_anything() -> None:
    text = page(lines_of([(None, []), (NEVER, [NEVER, NEVER]), (1, [4, 6]), (3, [2, 2])]), "1a2b3c4")
    assert "apart from the start" in text and f"| {NEVER} | {NEVER}, {NEVER} |" in text
    # (4 + 6 + 2 + 2) / 4 over (1 + 3) / 2, from two duels of four
    found = re.search(r"([\d.]+) times fewer, over (\d+) duels of (\d+)", text)
    assert found is not None and found.groups() == ("1.8", "2", "4")
    assert "random orders in 1." in text
    # the root of 5 times 2 / 3; none of the four random orders was cut short
    assert "mean of the ratios): 1.8 times" in text and "0 of 2 proposed\nand 0 of 4 random" in text
    assert "No duel says anything" in page(lines_of([(None, []), (NEVER, [NEVER, NEVER])]), "1a2b3c4")


class Pool:
    """Fights at once, in this process."""

    def __init__(self, *given: Any, **options: Any) -> None: ...

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, *given: object) -> None: ...

    def submit(self, call: Any, one: Any) -> Future[Any]:
        found: Future[Any] = Future()
        found.set_result(call(one))
        return found

    def shutdown(self, **options: Any) -> None: ...


def in_turn(futures: list[Future[Any]]) -> Iterator[Future[Any]]:
    yield from futures


def test_only_the_duels_that_are_left_are_fought(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fought: list[str] = []

    def outcome(one: Any) -> dict[str, Any]:
        fought.append(one.name)
        return {"name": one.name, "ours": 1, "theirs": [2, 2]}

    def stops_after_two(futures: list[Future[Any]]) -> Iterator[Future[Any]]:
        yield from futures[:2]
        raise KeyboardInterrupt

    monkeypatch.setattr(next_value, "outcome", outcome)
    monkeypatch.setattr(next_value, "ProcessPoolExecutor", Pool)
    target = tmp_path / "page.md"
    options = ["--pairs", "2", "--rigs", "1", "--random", "2", "--ledger", str(tmp_path / "duels.jsonl")]
    options += ["--page", str(target), "--tag", "made-up"]
    monkeypatch.setattr(next_value, "as_completed", stops_after_two)
    assert next_value.main(options) == 130 and not target.exists()
    first = list(fought)
    monkeypatch.setattr(next_value, "as_completed", in_turn)
    assert next_value.main(options) == 0
    assert len(first) == 4 and fought[4:] == first[2:]
    assert "2.0 times fewer, over 4 duels of 4" in target.read_text()
