"""Calls and data that cannot be used: one clear message, exit code 2, nothing written."""

from __future__ import annotations

from pathlib import Path

import pytest
from discrepancy_answers import Call


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("compare", "nowhere"), "no such file or folder"),
        (("compare", "{empty}"), "no logs"),
        (("compare", "{leak}", "--model", "publishd"), "did you mean 'published'"),
        (("compare", "{leak}", "--model", "published", "--model", "published"), "each model once"),
        (("compare", "{leak}", "--json", "{empty}"), "is a folder"),
        (("diagnose", "{empty}"), "no logs"),
        (("diagnose", "nowhere"), "no such file or folder"),
        (("diagnose", "{leak}", "--json", "{empty}"), "is a folder"),
        (("diagnose", "{leak}", "--workers", "0"), "--workers 0"),
        (("diagnose", "{leak}", "--workers", "1" * 50), "a number of about 50 digits: give a whole number from 1 to 1024"),
        (("diagnose", "--tables", "5.4.1", "--workers", "1025"), "--workers 1025"),
        (("next", "{leak}", "--workers", "1" * 50), "give a whole number from 1 to 1024"),
        (("diagnose", "{leak}", "--effort", "quick", "--cluster", ""), "--cluster is empty"),
        (("diagnose", "{leak}", "--model", "publishd"), "did you mean 'published'"),
        (("diagnose", "{leak}", "--effort", "quik"), "did you mean 'quick'"),
        (("diagnose", "{leak}", "--seed", "-1"), "--seed -1"),
        (("add", "leakge", "{leak}", "--as", "new"), "did you mean 'leakage'"),
        (("add", "leakage", "--as", "new"), "no logs were named"),
        (("add", "leakage", "leakage", "{leak}", "--as", "new"), "named twice"),
        (("add", "leakage", "{leak}", "--as", "published"), "exists already"),
        (("add", "leakage", "{leak}", "--as", "a/b"), "cannot be the name"),
        (("add", "leakage", "nowhere/logs", "--as", "new"), "no such file or folder"),
        (("add", "leakage", "nowhere", "--as", "new"), "no such file or folder"),
        (("add", "leakage", "leakge", "--as", "new"), "did you mean 'leakage'"),
        (("add", "leakage", "{empty}", "--as", "new"), "no logs"),
        (("add", "leakage", "{leak}", "--as", "new", "--model", "publishd"), "did you mean 'published'"),
        (("add", "leakage", "{leak}", "--as", "new", "--json", "{empty}"), "is a folder"),
    ],
)
def test_one_clear_message(call: Call, leak: Path, tmp_path: Path, arguments: tuple[str, ...], told: str) -> None:
    empty = tmp_path / "empty"
    empty.mkdir()
    answer = call(*(one.format(leak=leak, empty=empty) for one in arguments))
    assert answer.code == 2
    assert told in answer.err and len(answer.err.strip().splitlines()) == 1
    assert not (tmp_path / "conf").exists()
    assert not (tmp_path / "compare").exists() and not (tmp_path / "diagnose").exists()
