"""What a release needs: one version, a short changelog, whole archives, a workflow that can publish, and a container file."""

from __future__ import annotations

import json
import re
import tomllib
from importlib.metadata import version
from pathlib import Path

import pytest
import yaml

import hjcamp
from hjcamp.commands import command_files

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")


def test_the_version_stands_in_one_place() -> None:
    assert "version" not in PROJECT["project"] and PROJECT["project"]["dynamic"] == ["version"]
    assert PROJECT["tool"]["hatch"]["version"]["path"] == "hjcamp/__init__.py"
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["version"] == hjcamp.__version__ == version("hjcamp")
    assert {"cff-version", "message", "title", "authors", "license"} <= set(citation)
    assert citation["license"] == PROJECT["project"]["license"]


def test_the_changelog_begins_with_this_version_and_is_short() -> None:
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    first = re.findall(r"^## (\S+)$(.*?)(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)[0]
    assert first[0] == hjcamp.__version__ and len(first[1].splitlines()) <= 60
    named = {one for line in re.findall(r"^\* (.*?):", first[1], re.MULTILINE) for one in re.findall(r"`(\w+)[^`]*`", line)}
    assert named and named - set(command_files()) <= {"hjcamp", "unlock", "verify", "export", "view", "import"}


def test_the_sdist_holds_what_its_tests_read() -> None:
    included = {one.split("/")[0] for one in PROJECT["tool"]["hatch"]["build"]["targets"]["sdist"]["include"]}
    texts = [path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("*.py")]
    read = {found for text in texts for found in re.findall(r'ROOT / "([\w.-]+)', text)} | {
        "CITATION.cff",
        "Containerfile",
    }
    written = {"site", "dist"}
    assert read - included - written <= {"pyproject.toml", ".git"}
    assert all((ROOT / one).exists() for one in included)


@pytest.mark.parametrize("extra", sorted(PROJECT["project"]["optional-dependencies"]))
def test_every_extra_is_pinned(extra: str) -> None:
    pinned = {line.partition("==")[0] for line in (ROOT / "constraints.txt").read_text().splitlines()}
    for line in (*PROJECT["project"]["optional-dependencies"][extra], *PROJECT["project"]["dependencies"]):
        name = re.match(r"[\w-]+", line)
        assert name and (name[0] in pinned or name[0] == "hjcamp"), line


def test_a_tag_releases_with_attestations_and_without_a_password() -> None:
    text = (ROOT / ".github" / "workflows" / "release.yml").read_text(encoding="utf-8")
    flow = yaml.safe_load(text)
    assert flow[True] == {"push": {"tags": ["v*"]}} and "secrets." not in text
    build, publish = flow["jobs"]["build"], flow["jobs"]["publish"]
    assert publish["needs"] == "build" and publish["permissions"] == {"id-token": "write"} and publish["environment"]
    assert build["permissions"]["attestations"] == build["permissions"]["id-token"] == "write"
    uses = [step.get("uses", "") for step in build["steps"] + publish["steps"]]
    assert all(re.fullmatch(r"[\w/-]+@(v\d+|release/v1)", one) for one in uses if one)
    assert any(one.startswith("actions/attest-build-provenance@") for one in uses)
    targets = set(re.findall(r"^(\w+):", MAKEFILE, re.MULTILINE))
    called = {found for step in build["steps"] for found in re.findall(r"make (\w+)", step.get("run", ""))}
    assert called == {"dist"} and called <= targets


def test_the_container_copies_and_calls_what_is_there() -> None:
    lines = (ROOT / "Containerfile").read_text(encoding="utf-8").splitlines()
    copied = [word for line in lines if line.startswith("COPY ") for word in line.split()[1:-1]]
    assert all((ROOT / one).exists() for one in copied)
    needed = {"hjcamp", PROJECT["project"]["readme"], "LICENSE", "pyproject.toml"}
    assert needed | set(PROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"]) <= set(copied)
    started = json.loads(lines[-1].removeprefix("CMD "))
    assert started[0] == "hjcamp" and started[1] in command_files()


def test_every_file_of_tests_has_a_name_of_its_own() -> None:
    """Pytest imports them by their name alone."""
    names = [path.name for path in (ROOT / "tests").rglob("test_*.py")]
    assert sorted(names) == sorted(set(names))
