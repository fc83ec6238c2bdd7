"""A home that cannot be written and a full disk: work goes on where it can, else one message says what is wrong."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from pathlib import Path

import pytest

from hjcamp.campaign.execution.one_test import no_place
from hjcamp.model.compile import kernel_cache


def test_without_a_cache_kernels_are_kept_for_this_call(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("HJCAMP_CACHE", str(tmp_path / "file" / "cache"))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(kernel_cache.tempfile, "tempdir", None)
    kernel_cache._temporary_folder.cache_clear()
    kernel_cache.say_once.cache_clear()
    folder = kernel_cache.cache_folder()
    assert folder.is_dir() and tmp_path in folder.parents
    assert os.environ["HJCAMP_CACHE"] == str(folder.parent), "worker processes would each make their own"
    assert kernel_cache.cache_folder() == folder
    assert capsys.readouterr().err.count("cannot be written") == 1
    kernel_cache._temporary_folder.cache_clear()


def test_with_a_home_that_takes_nothing_a_picture_is_drawn_and_one_line_says_what_is_lost(empty_folder: Path) -> None:
    nowhere = {"HOME": "/dev/null", "USERPROFILE": "nul", "PATH": os.environ["PATH"]}
    command = [sys.executable, "-m", "hjcamp", "plants", "pump_joint", "--figure", "plant.svg"]
    done = subprocess.run(command, env=nowhere, capture_output=True, text=True)
    assert done.returncode == 0 and Path("plant.svg").read_text(encoding="utf-8").count("<svg") == 1
    # matplotlib would say at length where it keeps its fonts
    assert len(done.stderr.splitlines()) <= 1, done.stderr


def test_a_full_disk_is_named_even_where_the_error_names_no_file() -> None:
    message = no_place(OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)), Path("runs/one/logs/rep_01.mcap"))
    assert "runs/one/logs" in message and "kernels" in message and "No space left" in message
