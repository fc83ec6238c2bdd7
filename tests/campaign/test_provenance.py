"""Provenance: commit, changes on top of it, the user's own code."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from hjcamp.campaign.provenance import git_state, own_code_sha256


def commit_all(folder: Path) -> None:
    who = ["-c", "user.name=a", "-c", "user.email=a@b"]
    subprocess.run(["git", "add", "-A"], cwd=folder, check=True)
    subprocess.run(["git", *who, "commit", "-qm", "x"], cwd=folder, check=True)


def test_changes_and_new_files_show(tmp_path: Path) -> None:
    assert git_state(tmp_path) == {"git": None, "git_changes_sha256": None}
    subprocess.run(["git", "init", "-q"], cwd=tmp_path, check=True)
    (tmp_path / "hjcamp").mkdir()
    for name in ("conf", "campaigns"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "a.yaml").touch()
    file = tmp_path / "hjcamp" / "a.py"
    file.write_text("1\n")
    commit_all(tmp_path)
    clean = git_state(tmp_path)
    assert clean["git"] and clean["git_changes_sha256"] is None
    file.write_text("2\n")
    changed = git_state(tmp_path)["git_changes_sha256"]
    new = tmp_path / "hjcamp" / "b.py"
    new.write_text("3\n")
    added = git_state(tmp_path)["git_changes_sha256"]
    new.write_text("4\n")
    assert len({changed, added, git_state(tmp_path)["git_changes_sha256"]} - {None}) == 3


def test_the_users_effects_count(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("HJCAMP_CONF", raising=False)
    assert own_code_sha256() is None
    (tmp_path / "effects").mkdir()
    (tmp_path / "effects" / "mine.py").write_text("1\n")
    before = own_code_sha256()
    (tmp_path / "effects" / "mine.py").write_text("2\n")
    assert None not in (before, own_code_sha256()) and before != own_code_sha256()
