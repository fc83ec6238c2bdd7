"""The workflows: they parse, and whatever their steps call is there, with these options."""

from __future__ import annotations

import os
import re
import shlex
import shutil
from pathlib import Path
from typing import Any

import pytest
import yaml

from hjcamp.commands import command_files, load

ROOT = Path(__file__).parents[2]
OURS = ROOT / ".github" / "workflows" / "ci.yml"
#: What a machine of the service has, and what makes an environment there.
THERE = {"cat", "cd", "cp", "mkdir", "pip", "rm", "test"}


def workflows() -> dict[str, dict[Any, Any]]:
    page = (ROOT / "docs" / "ci.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```yaml\n(.*?)```", page, re.DOTALL)
    texts = {"ci.yml": OURS.read_text(encoding="utf-8")} | {f"docs/ci.md {place}": text for place, text in enumerate(blocks)}
    found = {name: yaml.safe_load(text) for name, text in texts.items()}
    return {name: content for name, content in found.items() if "jobs" in content}


def steps() -> list[tuple[str, dict[str, Any]]]:
    return [(name, step) for name, flow in workflows().items() for job in flow["jobs"].values() for step in job["steps"]]


def test_every_job_has_a_machine_and_steps_that_do_something() -> None:
    assert len(workflows()) >= 2
    for name, flow in workflows().items():
        # YAML 1.1 reads the key "on" as true.
        assert True in flow, name
        for job in flow["jobs"].values():
            assert job["runs-on"] and job["steps"][0]["uses"].startswith("actions/checkout@")
    for name, step in steps():
        assert ("uses" in step) != ("run" in step), (name, step)
        assert re.fullmatch(r"actions/[a-z-]+(/[a-z]+)?@v\d+", step.get("uses", "actions/checkout@v4")), (name, step)


def test_every_version_of_python_that_the_package_takes_is_tested() -> None:
    import tomllib

    matrix = workflows()["ci.yml"]["jobs"]["test"]["strategy"]["matrix"]["python-version"]
    classifiers = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["classifiers"]
    assert matrix == [one.rpartition(" ")[2] for one in classifiers if re.search(r":: 3\.\d+$", one)]


def test_kernels_are_cached_where_they_are_kept_and_the_page_is_uploaded() -> None:
    for name, flow in workflows().items():
        for job in flow["jobs"].values():
            kept = job["env"].get("HJCAMP_CACHE") or job["env"]["KERNELS"]
            cached = [step["with"]["path"] for step in job["steps"] if step.get("uses", "").startswith("actions/cache@")]
            assert kept == "${{ github.workspace }}/" + cached[0], name
    uploads = [step["with"]["path"] for _, step in steps() if step.get("uses", "").startswith("actions/upload-artifact@")]
    assert sum("run/report.html" in one for one in uploads) == len(workflows()) and "site/html" in uploads


@pytest.mark.parametrize("accepted", [False, True])
@pytest.mark.parametrize("branch", ["main", "topic"])
@pytest.mark.parametrize("check_passes", [True, False])
def test_the_baseline_is_renewed_by_a_check_that_passes_or_by_who_accepts(
    check_passes: bool, branch: str, accepted: bool
) -> None:
    flow = next(content for name, content in workflows().items() if name.startswith("docs/ci.md"))
    assert flow["env"]["ACCEPT"] == "${{ inputs.accept || contains(github.event.head_commit.message, 'Accept-baseline') }}"
    fine, renewed = True, False
    for step in flow["jobs"]["campaign"]["steps"]:
        # a step without always() runs where all before it passed
        condition = step.get("if", "")
        if ("always()" not in condition and not fine) or ("refs/heads/main" in condition and branch != "main"):
            continue
        renewed |= "cp -r run baseline" in step.get("run", "") and "rm -r" in step["run"]
        if "--check" in step.get("run", ""):
            assert step["continue-on-error"] == "${{ env.ACCEPT == 'true' }}"
            fine = check_passes or accepted
        if "summary.md" in step.get("run", "") and "--check" not in step["run"]:
            assert "hashFiles('summary.md')" in condition
    assert renewed is (branch == "main" and (check_passes or accepted))
    assert fine is (check_passes or accepted)


def test_what_the_steps_call_is_there() -> None:
    lines = [line for _, step in steps() for line in re.split(r"\n|&&", step.get("run", ""))]
    page = (ROOT / "docs" / "ci.md").read_text(encoding="utf-8")
    other = [yaml.safe_load(text) for text in re.findall(r"```yaml\n(.*?)```", page, re.DOTALL)]
    lines += [line for flow in other for job in flow.values() if isinstance(job, dict) for line in job.get("script", [])]
    called = [shlex.split(line) for line in lines if line.strip()]
    assert sum(words[0] == "hjcamp" and "--against" in words for words in called) == 3
    assert called
    for words in called:
        if words[0] == "hjcamp":
            # Options and arguments are read as in a call; nothing is done.
            command = load(command_files()[words[1]])
            assert command.make_context(words[1], words[2:]) is not None
        elif words[0] == "python":
            assert (ROOT / words[-1]).exists() or (ROOT / words[1]).is_file(), words
        elif words[0] not in THERE:
            file = ROOT / words[0]
            assert file.is_file() and os.access(file, os.X_OK), words
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    targets = re.findall(r"^(\w+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    assert re.findall(r"make (\w+)", script.split("\n", 4)[4]) == ["test"] and "test" in targets


@pytest.mark.skipif(shutil.which("bash") is None, reason="bash is not installed")
def test_the_script_hands_its_words_to_make(tmp_path: Path) -> None:
    import subprocess

    (tmp_path / "make").write_text('#!/bin/sh\necho "$HJCAMP_CACHE $*"\n')
    (tmp_path / "make").chmod(0o755)
    environment = {**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}", "TMPDIR": str(tmp_path)}
    for kernels in ("", "/kept"):
        done = subprocess.run(
            [str(ROOT / ".ci" / "run"), "PYTHON=python"],
            env=environment | {"KERNELS": kernels},
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0 and done.stdout.rstrip().endswith("PYTHON=python"), done.stderr
        assert done.stdout.startswith("/kept test" if kernels else str(tmp_path)), done.stdout
    assert [path.name for path in tmp_path.iterdir()] == ["make"]
