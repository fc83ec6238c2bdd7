"""Provenance: commit, changes on top of it, the user's own code, in each log and in the run folder."""

from __future__ import annotations

import hashlib
import io
import subprocess
from pathlib import Path

import pytest
from rich.console import Console

from hjcamp.campaign.files import code_changes, provenance
from hjcamp.campaign.files import run_folder as folder
from hjcamp.campaign.files.code_changes import CodeState, code_state
from hjcamp.campaign.files.provenance import PACKAGES, own_code_sha256
from hjcamp.campaign.files.run_folder import folder_for, open_folder
from hjcamp.campaign.plan.planning import make_plan
from hjcamp.campaign.runner import run_plan
from hjcamp.configuration.composer import Composer
from hjcamp.records.plan import Plan
from hjcamp.records.read import read_log

WHO = ("-c", "user.name=a", "-c", "user.email=a@b")


def git(folder: Path, *arguments: str) -> bytes:
    return subprocess.run(["git", *WHO, *arguments], cwd=folder, check=True, capture_output=True).stdout


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A clean checkout with a file in each part."""
    path = tmp_path / "checkout"
    for name in ("hjcamp", "conf", "campaigns"):
        (path / name).mkdir(parents=True)
        (path / name / "a.yaml").write_text("1\n")
    git(path, "init", "-q")
    git(path, "add", "-A")
    git(path, "commit", "-qm", "x")
    return path


def test_no_checkout_knows_nothing(tmp_path: Path) -> None:
    assert code_state(tmp_path) == CodeState(None)
    assert code_state(tmp_path).sha256 is None


def test_changes_and_new_files_show(checkout: Path) -> None:
    clean = code_state(checkout)
    assert clean.commit == git(checkout, "rev-parse", "HEAD").decode().strip()
    assert (clean.sha256, clean.file_name) == (None, None)
    (checkout / "hjcamp" / "a.yaml").write_text("2\n")
    changed = code_state(checkout).sha256
    new = checkout / "hjcamp" / "b.py"
    new.write_text("3\n")
    added = code_state(checkout).sha256
    new.write_text("4\n")
    assert len({changed, added, code_state(checkout).sha256} - {None}) == 3


def test_the_kept_changes_give_the_same_code_again(checkout: Path, tmp_path: Path) -> None:
    (checkout / "conf" / "a.yaml").write_bytes(b"latin \xe9\n")
    (checkout / "campaigns" / "a.yaml").unlink()
    (checkout / "hjcamp" / "new with a space.py").write_text("new = 1\n")
    (checkout / "hjcamp" / "picture.bin").write_bytes(bytes(range(256)))
    state = code_state(checkout)
    kept = tmp_path / "kept.diff"
    kept.write_bytes(state.changes)
    other = tmp_path / "other"
    git(tmp_path, "clone", "-q", str(checkout), str(other))
    git(other, "apply", str(kept))
    for part in ("hjcamp", "conf", "campaigns"):
        assert {path.name: path.read_bytes() for path in (checkout / part).iterdir()} == (
            {path.name: path.read_bytes() for path in (other / part).iterdir()} if (other / part).exists() else {}
        )


def test_changes_that_are_too_large_are_a_hash_and_a_size(checkout: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (checkout / "hjcamp" / "a.yaml").write_text("two\n" * 100)
    monkeypatch.setattr(code_changes, "LARGEST_BYTES", 100)
    state = code_state(checkout)
    assert state.sha256 and len(state.changes) > 100
    assert state.file_name is None


def test_the_users_effects_count(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("HJCAMP_CONF", raising=False)
    assert own_code_sha256() is None
    (tmp_path / "effects").mkdir()
    (tmp_path / "effects" / "mine.py").write_text("1\n")
    before = own_code_sha256()
    (tmp_path / "effects" / "mine.py").write_text("2\n")
    assert None not in (before, own_code_sha256()) and before != own_code_sha256()
    # one process may write effects and move on between two runs
    assert provenance.log_provenance()["own_code_sha256"] == own_code_sha256()
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert "own_code_sha256" not in provenance.log_provenance() and provenance.code_identity()["own_code_sha256"] is None


@pytest.fixture(scope="module")
def plan(composer: Composer) -> Plan:
    return make_plan(composer.compose(["repetitions=2"]).config, None, ["repetitions=2"], composer)


@pytest.mark.usefixtures("quick_backend")
def test_log_and_run_folder_say_what_made_them(plan: Plan, empty_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    changes = CodeState("0123abcd" * 5, b"diff --git a/x b/x\n")
    for module in (provenance, folder):
        monkeypatch.setattr(module, "code", lambda: changes)
    run = folder_for(plan, {}, [], Path("run"))[0]
    run_plan(run, Console(file=io.StringIO()), workers=1)
    digest = hashlib.sha256(changes.changes).hexdigest()
    log = read_log(run.path / plan.tests[0].log)
    assert log.metadata["git"] == f"{changes.commit}+{digest[:12]}"
    assert log.metadata["git_changes_sha256"] == digest
    assert log.metadata["config_sha256"] == plan.conditions[0].sha256
    for name in PACKAGES:
        assert f"{name} " in log.metadata["packages"], name
    manifest = open_folder(run.path).manifest
    session = manifest["sessions"][0]
    assert manifest["plan_sha256"] == plan.sha256
    kept = run.path / session["git_changes_file"]
    assert kept.read_bytes() == changes.changes
    assert hashlib.sha256(kept.read_bytes()).hexdigest() == digest == session["git_changes_sha256"]
    assert session["git_changes_bytes"] == len(changes.changes)
    assert {"version", "git", "packages", "host", "python"} <= set(session)
    assert digest[:12] in kept.name
    assert not list(run.path.rglob("*.part"))
