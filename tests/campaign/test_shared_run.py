"""A run as one archive: what is shared opens elsewhere as it was; what is not sound is refused, with nothing written."""

from __future__ import annotations

import json
import os
import stat
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hjcamp import cli
from hjcamp.campaign.files.lock import run_lock
from hjcamp.campaign.files.run_folder import folder_for
from hjcamp.campaign.files.shared_run import CRATE, KINDS
from hjcamp.campaign.plan.planning import make_plan
from hjcamp.configuration.composer import Composer
from hjcamp.records.log import TestLog
from hjcamp.records.write import write_log

PAGE = "<html><script>fetch('http://127.0.0.1')</script></html>"


@pytest.fixture
def run(composer: Composer, empty_folder: Path) -> Path:
    """A run folder with logs, a table and a page."""
    words = ["repetitions=2"]
    folder, _ = folder_for(make_plan(composer.compose(words).config, None, words, composer), {"seed": 1}, words, Path("mine"))
    time = 0.001 * np.arange(200)
    for repetition in (1, 2):
        columns = {"time_s": time, "arm_deg": 10.0 * np.sin(9.0 * time + repetition)}
        columns |= {name: 0.2 + 0.01 * np.cos(7.0 * time + repetition) for name in ("pressure1_mpa", "pressure2_mpa")}
        write_log(folder.path / f"logs/ramp_pos__pid/rep_{repetition:02d}.mcap", TestLog({**columns, "pump_deg": 50.0 * time}))
    (folder.path / "tables").mkdir()
    (folder.path / "tables/indicators.csv").write_text("a,b\n1,2\n")
    (folder.path / "report.html").write_text(PAGE)
    return folder.path


def content(folder: Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file() and path.suffix in KINDS)
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def test_a_run_comes_back_as_it_was_without_its_pages(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["share", "mine"]) == 0
    assert "1 page or picture left out" in capsys.readouterr().out
    assert cli.run(["open", "mine.zip", "--into", "theirs"]) == 0, capsys.readouterr().err
    said = capsys.readouterr().out
    assert "each as described; 2 of 2 logs whole" in said and "next  hjcamp report theirs" in said
    assert content(Path("theirs")) == content(run) and not Path("theirs/report.html").exists()
    assert cli.run(["log", "verify", "theirs"]) == cli.run(["log", "verify", "mine"])
    # nothing is overwritten, on either side
    assert cli.run(["open", "mine.zip", "--into", "theirs"]) == 2 and cli.run(["share", "mine"]) == 2
    assert sorted(path.name for path in Path().iterdir()) == ["mine", "mine.zip", "theirs"]


def test_the_archive_is_described_as_an_ro_crate(run: Path) -> None:
    assert cli.run(["share", "mine", "--output", "a.zip"]) == 0
    with zipfile.ZipFile("a.zip") as archive:
        crate = json.loads(archive.read(CRATE))
        names = set(archive.namelist())
    found = {one["@id"]: one for one in crate["@graph"]}
    assert found[CRATE]["conformsTo"]["@id"] == "https://w3id.org/ro/crate/1.1" and found[CRATE]["about"]["@id"] == "./"
    root = found["./"]
    assert root["@type"] == "Dataset" and {"name", "description", "datePublished", "license"} <= set(root)
    assert (
        {one["@id"] for one in root["hasPart"]}
        == names - {CRATE}
        == {key for key, one in found.items() if one["@type"] == "File"}
    )


def changed(change: Callable[[dict[str, tuple[zipfile.ZipInfo, bytes]]], object]) -> None:
    """Write evil.zip: mine.zip with its entries changed."""
    with zipfile.ZipFile("mine.zip") as archive:
        entries = {info.filename: (zipfile.ZipInfo(info.filename), archive.read(info)) for info in archive.infolist()}
    change(entries)
    with zipfile.ZipFile("evil.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        for info, data in entries.values():
            archive.writestr(info, data, zipfile.ZIP_DEFLATED)


def add(name: str, data: bytes = b"1", mode: int = 0) -> Callable[[dict], object]:
    """Return a change that adds a file, described as all others are."""

    def change(entries: dict[str, tuple[zipfile.ZipInfo, bytes]]) -> None:
        import hashlib

        info = zipfile.ZipInfo("x")
        info.filename = name
        info.external_attr = mode << 16
        entries[f"{name} more"] = info, data
        head, crate = entries[CRATE][0], json.loads(entries[CRATE][1])
        digest = hashlib.sha256(data).hexdigest()
        crate["@graph"].append({"@id": name, "@type": "File", "contentSize": str(len(data)), "sha256": digest})
        entries[CRATE] = head, json.dumps(crate).encode()

    return change


def crate_of(text: bytes) -> Callable[[dict], object]:
    return lambda entries: entries.update({CRATE: (entries[CRATE][0], text)})


EVIL: dict[str, tuple[Callable[[dict], object], str]] = {
    "up": (add("../outside.json"), "leads elsewhere"),
    "up in the middle": (add("logs/../../outside.json"), "leads elsewhere"),
    "from the root": (add("/tmp/outside.json"), "leads elsewhere"),
    "a drive": (add("C:/outside.json"), "leads elsewhere"),
    "a backslash": (add("..\\outside.json"), "leads elsewhere"),
    "a hidden file": (add(".bashrc.json"), "is hidden"),
    "a hidden folder": (add(".git/config.txt"), "is hidden"),
    "a link": (add("logs/link.json", b"/etc/passwd", stat.S_IFLNK | 0o777), "a link or a device"),
    "a device": (add("logs/device.json", b"", stat.S_IFCHR | 0o666), "a link or a device"),
    "a program": (add("plants/axis.py", b"print(1)"), "no data of a run"),
    "a page": (add("report.html", PAGE.encode()), "no data of a run"),
    "a picture that can hold a program": (add("a.svg", b"<svg/>"), "no data of a run"),
    "a file twice": (add("PLAN.json"), "twice"),
    "a star": (add("a*.json"), "none on every computer"),
    "a bomb": (add("logs/big.csv", b"0" * (64 * 2**20)), "that is no run"),
    "another file than described": (lambda e: e.update({"plan.json": (e["plan.json"][0], e["plan.json"][1] + b" ")}), "not the file"),
    "a file that is missing": (lambda e: e.pop("manifest.json"), "is missing"),
    "a file that nobody describes": (lambda e: e.update({"a.json": (zipfile.ZipInfo("a.json"), b"1")}), "not described"),
    "no description": (lambda e: e.pop(CRATE), "hjcamp share RUN makes one"),
    "a description that is none": (crate_of(b"[]"), "cannot be read"),
    "a deep description": (crate_of(b"[" * 200_000), "cannot be read"),
    "a size that is no number": (crate_of(b'{"@graph": [{"@type": "File", "@id": "a", "contentSize": "x"}]}'), "cannot be read"),
}  # fmt: skip


@pytest.mark.parametrize("case", EVIL)
def test_what_is_not_sound_is_refused_in_one_sentence_and_nothing_is_written(
    run: Path, case: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.run(["share", "mine"]) == 0
    change, said = EVIL[case]
    changed(change)
    before = sorted(str(path) for path in Path().rglob("*"))
    assert cli.run(["open", "evil.zip", "--into", "new/theirs"]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1
    assert [path for path in sorted(str(path) for path in Path().rglob("*")) if path not in (*before, "new")] == []


@pytest.mark.parametrize("size", [0, 10, 400, -1])
def test_a_damaged_archive_is_refused(run: Path, size: int, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["share", "mine"]) == 0
    whole = Path("mine.zip").read_bytes()
    Path("cut.zip").write_bytes(whole[:size] if size >= 0 else whole[:200] + b"\0" * 200 + whole[400:])
    assert cli.run(["open", "cut.zip"]) == 2
    error = capsys.readouterr().err
    assert error.startswith("hjcamp: cut.zip: ") and error.count("\n") == 1 and not Path("cut").exists()


def test_what_is_no_run_or_at_work_or_holds_links_is_not_shared(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("empty").mkdir()
    assert cli.run(["share", "empty"]) == 2 and "plan.json is missing" in capsys.readouterr().err
    with run_lock(run):
        assert cli.run(["share", "mine"]) == 2 and "is at work" in capsys.readouterr().err
    os.symlink("/etc/passwd", run / "tables/more.csv")
    assert cli.run(["share", "mine"]) == 2 and "is a link" in capsys.readouterr().err
    assert not list(Path().glob("*.zip*"))
