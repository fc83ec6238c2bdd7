"""What `make` does for a fresh clone: the demo waits for nothing that it does not need."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def steps(target: str, folder: Path) -> str:
    """Return the commands of a target in a clone without anything installed."""
    if shutil.which("make") is None or not (ROOT / "Makefile").is_file():
        pytest.skip("no make, or no Makefile here")
    command = ["make", "--dry-run", target, f"VENV={folder / 'none'}"]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout


def test_the_demo_needs_an_installation_and_compiles_its_own_kernels_only(tmp_path: Path) -> None:
    demo = steps("demo", tmp_path)
    assert "pip install" in demo and "campaign=robustness_vertical" in demo
    assert "[test]" not in demo and "--no-compile" in demo
    # what the tour needs is compiled once the answer is there, in the background, and not where nobody reads it
    run, reader, background = (demo.index(one) for one in ("campaign=robustness_vertical", 'test -n "$CI" ||', "--detach"))
    assert demo.count("--warm") == 1 and run < reader < background


def test_what_tests_need_is_installed_for_them(tmp_path: Path) -> None:
    for target in ("test", "lint", "faults"):
        assert ".[test]" in steps(target, tmp_path)
    assert "--warm" in steps("setup", tmp_path) and ".[test]" not in steps("setup", tmp_path)
