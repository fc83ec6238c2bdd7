"""One set of Python versions: in the package, in make, in the README and in the tests that run on every push."""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[2]
VERSIONS = ["3.11", "3.12", "3.13"]


def test_every_place_names_the_same_versions() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert project["requires-python"] == ">=3.11,<3.14"
    assert [one.rpartition(" ")[2] for one in project["classifiers"] if "Python :: 3." in one] == VERSIONS
    make = (ROOT / "Makefile").read_text()
    assert re.findall(r"python(3\.\d+)", make.splitlines()[1]) == VERSIONS[::-1]
    assert "(3, 11) <= sys.version_info < (3, 14)" in make
    assert "Python 3.11, 3.12 or 3.13 and make" in (ROOT / "README.md").read_text()
    workflow = yaml.safe_load((ROOT / ".github" / "workflows" / "ci.yml").read_text())
    job = workflow["jobs"]["test"]
    assert job["strategy"]["matrix"]["python-version"] == VERSIONS
    assert job["steps"][-1]["run"] == ".ci/run PYTHON=python"
    assert f"{sys.version_info.major}.{sys.version_info.minor}" in VERSIONS


def test_one_place_says_how_long_the_setup_takes() -> None:
    said = re.findall(r"make setup[^\n]*\d+ (?:minutes|s)\b", (ROOT / "README.md").read_text().replace("`", ""))
    assert len(said) == 1
    assert "minute" not in next(line for line in (ROOT / "Makefile").read_text().splitlines() if "make setup " in line)
