"""What `make` does for a fresh clone: the demo waits for nothing that it does not need."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def steps(target: str, folder: Path) -> str:
    """Return the commands of a target in a clone without anything installed."""
    if shutil.which("make") is None or not (ROOT / "Makefile").is_file():
        pytest.skip("no make, or no Makefile here")
    command = ["make", "--dry-run", target, f"VENV={folder / 'none'}"]
    # below `make test` a make would take over its options, and say which folder it enters
    outside = {
        name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "MAKEOVERRIDES")
    }
    return subprocess.run(command, cwd=ROOT, env=outside, capture_output=True, text=True, check=True).stdout


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


@pytest.mark.skipif(os.name == "nt", reason="the stand-in for an old Python is a shell script")
@pytest.mark.parametrize("target", ["setup", "demo", "test"])
def test_an_old_python_is_named_and_nothing_is_made(target: str, tmp_path: Path) -> None:
    make, shell = shutil.which("make"), shutil.which("sh")
    if make is None or shell is None or not (ROOT / "Makefile").is_file():
        pytest.skip("no make, no shell, or no Makefile here")
    for name, place in (("make", make), ("sh", shell)):
        (tmp_path / name).symlink_to(place)
    old = tmp_path / "python3"
    old.write_text('#!/bin/sh\n[ "$1" = --version ] && echo Python 3.10.12\n', encoding="utf-8")
    old.chmod(0o755)
    command = [make, target, f"VENV={tmp_path / 'none'}"]
    done = subprocess.run(command, cwd=ROOT, env={"PATH": str(tmp_path)}, capture_output=True, text=True)
    assert done.returncode == 2 and "3.11, 3.12 or 3.13 with its venv module is needed; found: Python 3.10.12" in done.stderr
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize("target", ["setup", "demo", "test"])
def test_a_target_says_what_it_does_and_how_long_before_it_begins(target: str, tmp_path: Path) -> None:
    first, *rest = steps(target, tmp_path).splitlines()
    assert first.startswith(f'echo "make {target}: ') and first.endswith('on two cores"')
    assert not [line for line in rest if line.startswith("echo")] and "pip install" in "".join(rest)


def test_the_tests_show_progress_and_end_with_their_count(tmp_path: Path) -> None:
    (tmp_path / "test_two.py").write_text("def test_a(): pass\ndef test_b(): pass\n")
    last = steps("test", tmp_path).splitlines()[-1].split("-m pytest ")[1]
    options = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["pytest"]["ini_options"]["addopts"]
    words = [*shlex.split(options), *last.replace("--numprocesses auto", "-p xdist -n 0").split()]
    command = [sys.executable, "-m", "pytest", "-c", "/dev/null", *words, "-o", "markers=study", str(tmp_path)]
    alone = {**os.environ, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    done = subprocess.run(command, cwd=tmp_path, env=alone, capture_output=True, text=True, check=True)
    lines = done.stdout.split("\n")
    assert "[100%]" in lines[-3] and lines[-2].startswith("2 passed in ")
