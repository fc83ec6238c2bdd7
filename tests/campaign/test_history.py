"""An indicator over commits and runs: which count, what changed, what cannot be shown."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from hjcamp.campaign.runs.finding import FoundRun
from hjcamp.campaign.runs.history import history_rows, moments_of, read_words
from hjcamp.errors import UsageError
from hjcamp.report.pictures.history import draw_history

Means = dict[str, tuple[float, float | None]]


def run(folder: Path, day: int, git: str, means: Means | None, changes: str | None = None) -> FoundRun:
    """Return a run of which only the session and the metrics are looked at."""
    path = folder / f"{day}"
    path.mkdir()
    if means is not None:
        content = {name: {"n": 7, "rmse1_deg": {"mean": mean, "std": std}} for name, (mean, std) in means.items()}
        (path / "metrics.json").write_text(json.dumps(content))
    session = {
        "started_at": f"2026-01-{day:02d}T00:00:00Z",
        "git": git * 40,
        "git_changes_sha256": changes,
        "version": "0.1.0",
    }
    plan: Any = None
    return FoundRun(path, plan, {"sessions": [session]})


@pytest.fixture
def runs(tmp_path: Path) -> Sequence[FoundRun]:
    same: Means = {"a": (1.0, 0.1), "b": (3.0, 0.1)}
    return [
        run(tmp_path, 5, "c", {"a": (1.5, 0.1), "b": (3.0, 0.1), "more": (9.0, 0.1)}),
        run(tmp_path, 1, "a", {"a": (5.0, 0.1), "b": (5.0, 0.1)}),
        run(tmp_path, 2, "a", same),
        run(tmp_path, 3, "b", None),
        run(tmp_path, 4, "a", same, "f00d" * 16),
    ]


def test_the_newest_run_of_each_commit_counts(runs: Sequence[FoundRun]) -> None:
    moments, without = moments_of(runs, "rmse1_deg", "commits")
    assert [one.run[-1] for one in moments] == ["2", "4", "5"] and [path[-1] for path in without] == ["3"]
    assert [one.commit for one in moments] == ["a" * 10, "a" * 10 + "+f00d", "c" * 10]
    shared, rows = history_rows(moments)
    assert shared == ["a", "b"] and [row["mean"] for row in rows] == [2.0, 2.0, 2.25]
    # Two means of seven tests each, deviation 0.1: the error of their mean is 0.1 / sqrt(14).
    assert rows[0]["standard_error"] == pytest.approx(0.1 / 14**0.5)
    assert [[one["condition"] for one in row["changed"]] for row in rows] == [[], [], ["a"]]
    assert rows[2]["changed"][0]["difference"] == 0.5 and rows[2]["changed"][0]["p_holm"] < 1e-3
    assert len(moments_of(runs, "rmse1_deg", "runs")[0]) == 4


def test_the_figure(runs: Sequence[FoundRun], tmp_path: Path) -> None:
    _, rows = history_rows(moments_of(runs, "rmse1_deg", "runs")[0])
    draw_history(tmp_path / "h.svg", "title", "rmse1_deg", rows, [f"commit {k}" for k in range(4)])
    drawn = (tmp_path / "h.svg").read_text()
    assert "conditions changed" in drawn and "commit 3" in drawn and "RMSE1 (deg)" in drawn


def test_bad_calls(runs: Sequence[FoundRun], tmp_path: Path) -> None:
    assert read_words(["campaign=x", "git=abc", "sse_deg"]) == (["campaign=x", "git=abc"], "sse_deg")
    for words, said in (
        (["campaign=x", "e_max"], "unknown indicator 'e_max'.*did you mean 'e_max_deg'"),
        (["rmse1_deg"], "a history is of one campaign"),
        (["campaign=x", "rmse1_deg", "sse_deg"], "one indicator at a time"),
    ):
        with pytest.raises(UsageError, match=said):
            read_words(words)
    with pytest.raises(UsageError, match=r"unknown choice 'commit'.*did you mean 'commits'"):
        moments_of(runs, "rmse1_deg", "commit")
    with pytest.raises(UsageError, match=r"none of 5 runs has sse_deg"):
        moments_of(runs, "sse_deg", "commits")
    other = run(tmp_path, 9, "d", {"else": (1.0, None)})
    with pytest.raises(UsageError, match=r"/2 and .*/9 have no condition in common"):
        history_rows(moments_of([*runs, other], "rmse1_deg", "commits")[0])
    (runs[0].path / "metrics.json").write_text('{"a": {"n": "x"}}')
    assert len(moments_of(runs, "rmse1_deg", "commits")[1]) == 2
