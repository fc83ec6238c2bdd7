"""Every command that README or a page of docs/ names is one: its options are there, what it would run can be planned, and (study)
it comes to its end."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from hjcamp import cli
from hjcamp.commands import command_files, load
from hjcamp.commands.campaigns.run import SWITCHES

ROOT = Path(__file__).parents[2]
PAGES = {path.name: path.read_text(encoding="utf-8") for path in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))}
PLACEHOLDER = re.compile(r"\b[A-Z][A-Z_]+\b|\.\.\.|\[")
OF_RUN = {*SWITCHES, "--like", "--live", "--no-browser"}


def in_blocks(page: str) -> list[str]:
    """Return the lines of a page's blocks that call the program, without what is said behind them."""
    blocks = re.findall(r"^```[^\n]*\n(.*?)^```", PAGES[page], re.DOTALL | re.MULTILINE)
    lines = [line.strip() for block in blocks for line in block.replace("\\\n", " ").splitlines()]
    lines = [re.sub(r"^(- run: |\$ )", "", line) for line in lines]
    return [shlex.join(shlex.split(line, comments=True)) for line in lines if line.startswith("hjcamp ")]


def in_sentences(page: str) -> list[str]:
    """Return the calls of the program in a page's sentences and tables."""
    return re.findall(r"`(hjcamp [^`]+)`", re.sub(r"^```.*?^```", "", PAGES[page], flags=re.DOTALL | re.MULTILINE))


def named() -> list[Any]:
    found = []
    for page in PAGES:
        for line in dict.fromkeys((*in_blocks(page), *in_sentences(page))):
            found.append(pytest.param(" ".join(line.split()), id=f"{page}: {' '.join(line.split())}"))
    return found


def planned() -> list[Any]:
    found = []
    lines = (line for page in PAGES for line in in_blocks(page))
    for line in dict.fromkeys(lines):
        words = shlex.split(line)[1:]
        if words[0] in ("run", "plan") and not PLACEHOLDER.search(line.replace("interval(", "")):
            found.append(pytest.param([word for word in words[1:] if word not in OF_RUN], id=line))
    return found


def options_of(words: list[str]) -> set[str]:
    """Return the options of the command that ``words`` begin with."""
    if words[0] == "run":
        from hydra._internal.utils import get_args_parser

        return {*OF_RUN, *get_args_parser()._option_string_actions}
    if words[0].startswith("-"):
        return {"--help", "--version"}
    command = load(command_files()[words[0]])
    names = iter(words[1:])
    while hasattr(command, "commands") and (found := command.commands.get(next(names, ""))) is not None:
        command = found
    return {"--help", *(text for one in command.params for text in (*one.opts, *one.secondary_opts))}


@pytest.mark.parametrize("line", named())
def test_the_command_and_its_options_are_there(line: str) -> None:
    words = re.sub(r"[\[\]|()]", " ", line).replace("'", " ").replace('"', " ").split()[1:]
    if words[0] == "COMMAND":
        return
    assert words[0].startswith("-") or words[0] in command_files(), line
    given = {word.partition("=")[0].rstrip(",;") for word in words if re.match(r"--?[a-z]", word)}
    assert given <= options_of(words), given - options_of(words)


@pytest.fixture(scope="module")
def workshop(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with what a reader of the pages has made by then."""
    folder = tmp_path_factory.mktemp("workshop")
    for name in ("campaigns", "effects", "conf/model", "conf/rig"):
        (folder / name).mkdir(parents=True)
    found = re.search(r"```yaml\n(name: mine\n.*?)```", PAGES["README.md"], re.DOTALL)
    effect = re.search(r"```python\n(.*?)```", PAGES["README.md"], re.DOTALL)
    assert found and effect
    for name in ("mine", "next_1"):
        (folder / f"campaigns/{name}.yaml").write_text(found[1].replace("name: mine", f"name: {name}"))
    (folder / "effects/cable_drag.py").write_text(effect[1])
    for name in ("bench", "mended", "tour_model"):
        (folder / f"conf/model/{name}.yaml").write_text(f"name: {name}\nparameters: {{}}\neffects: {{}}\n")
    virtual = (ROOT / "conf/rig/virtual.yaml").read_text(encoding="utf-8")
    for name in ("my_rig", "bench"):
        (folder / f"conf/rig/{name}.yaml").write_text(virtual.replace("name: virtual", f"name: {name}"))
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert cli.run(["plants", "new", "my_axis"]) == 0
    return folder


@pytest.mark.parametrize("words", planned())
def test_what_it_would_run_can_be_planned(
    words: list[str], workshop: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(workshop)
    monkeypatch.delenv("HJCAMP_CONF", raising=False)
    code = cli.run(["plan", *words])
    assert code == 0, capsys.readouterr().err


#: What has to be there before the lines of a page, and the exit code of a line where the page says that it is not 0.
BEFORE = {
    "ci.md": ["run campaign=robustness_vertical run_dir=baseline"],
    "next.md": ["run campaign=friction repetitions=2 run_dir=runs/friction_sweep/20261121T101500Z"],
}
CODES = {"localhost:31763": 3}
#: What needs files that are a reader's own, or is walked through elsewhere (tests/plants/test_own_plant.py).
NOT_HERE = ("logs/train.mcap", "mine.csv")


@pytest.mark.study
@pytest.mark.parametrize("page", ["ci.md", "identification.md", "next.md", "rig.md", "tables.md", "tour.md"])
def test_every_line_of_the_page_comes_to_its_end(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "conf/rig").mkdir(parents=True)
    virtual = (ROOT / "conf/rig/virtual.yaml").read_text(encoding="utf-8")
    (tmp_path / "conf/rig/my_rig.yaml").write_text(virtual.replace("name: virtual", "name: my_rig"))
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    serving: list[subprocess.Popen[bytes]] = []

    def words_of(line: str) -> list[str]:
        words = [sys.executable, "-m", "hjcamp", *shlex.split(line)]
        return (
            words
            + ["--yes"] * ("rig check" in line)
            + ["run_dir=runs/next_1/20261121T140000Z"] * ("run campaign=next_1" in line)
        )

    try:
        for line in [*BEFORE.get(page, []), *(line.removeprefix("hjcamp ") for line in in_blocks(page))]:
            if PLACEHOLDER.search(line) or any(name in line for name in NOT_HERE):
                continue
            if line.startswith("rig serve"):
                serving.append(subprocess.Popen(words_of(line), cwd=tmp_path))
                time.sleep(20.0)
                continue
            made = subprocess.run(words_of(line), cwd=tmp_path, input=b"q\n", capture_output=True, check=False)
            expected = next((code for name, code in CODES.items() if name in line), 0)
            assert made.returncode == expected, (line, made.stderr.decode()[-1000:])
    finally:
        for process in serving:
            process.terminate()
            process.wait()
