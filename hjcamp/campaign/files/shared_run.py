"""A run as one zip archive for another computer: data alone, each file with its digest, described as an RO-Crate.

What was received is data: nothing in an archive is a program or a page, none of it is written outside its new folder, and every file is
what its description says, or nothing is written at all.
"""

from __future__ import annotations

import hashlib
import json
import shutil
import stat
import tempfile
import zipfile
import zlib
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path, PurePosixPath
from typing import Any

from hjcamp import __version__
from hjcamp.campaign.files.lock import is_locked
from hjcamp.campaign.files.run_folder import open_folder
from hjcamp.errors import UsageError
from hjcamp.records.elsewhere.reader import first_line
from hjcamp.storage import disk_errors, own_folder, shown_path, whole_file

CRATE = "ro-crate-metadata.json"
#: What a run's data ends in; pages and vector pictures can hold programs, and are made again from these.
KINDS = {
    ".json": "application/json", ".yaml": "application/yaml", ".mcap": "application/octet-stream", ".csv": "text/csv",
    ".parquet": "application/vnd.apache.parquet", ".md": "text/markdown", ".tex": "application/x-tex", ".png": "image/png",
    ".txt": "text/plain",
}  # fmt: skip
MOST_FILES, MOST_BYTES, MOST_RATIO = 100_000, 16 * 2**30, 200
MOST_DESCRIPTION = 64 * 2**20
PIECE = 2**20
#: What damaged bytes make the libraries raise.
NOT_SOUND = (
    zipfile.BadZipFile, zipfile.LargeZipFile, zlib.error, NotImplementedError, RuntimeError, EOFError, ValueError, OSError,
)  # fmt: skip


def share_run(run: Path, target: Path) -> tuple[int, list[Path]]:
    """Write a run as ``target``; return the number of its files, and those that are left out: pages and what else is no data.

    Raises UsageError for a folder that is no run, one in which a process is at work, and links.
    """
    folder = open_folder(run)
    if is_locked(run):
        raise UsageError(f"{shown_path(run)}: a process is at work in this run; share it when that has ended")
    own_folder(run)
    inside = sorted(path for path in run.rglob("*") if path.is_file() and not path.name.startswith("."))
    files = [path for path in inside if path.suffix.lower() in KINDS]
    rows = []
    with disk_errors(target), whole_file(target) as stream, zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in files:
            name = path.relative_to(run).as_posix()
            archive.write(path, name)
            with path.open("rb") as content:
                digest = hashlib.file_digest(content, "sha256").hexdigest()
            rows.append({"name": name, "size": path.stat().st_size, "sha256": digest})
        archive.writestr(CRATE, json.dumps(_described(folder.plan.campaign or run.name, rows), indent=1))
    return len(files), [path for path in inside if path not in files]


def _described(name: str, rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the RO-Crate (version 1.1) of the files."""
    files = [
        {
            "@id": row["name"],
            "@type": "File",
            "contentSize": str(row["size"]),
            "encodingFormat": KINDS[PurePosixPath(row["name"]).suffix.lower()],
            "sha256": row["sha256"],
        }
        for row in rows
    ]
    root = {
        "@id": "./",
        "@type": "Dataset",
        "name": f"Run of {name}",
        "description": f"A run of hjcamp {__version__}: plan, configuration, logs and tables. hjcamp open ZIP checks and unpacks it.",
        "datePublished": datetime.now(UTC).date().isoformat(),
        "license": "not said: ask whoever gave it to you",
        "hasPart": [{"@id": one["@id"]} for one in files],
    }
    about = {
        "@id": CRATE,
        "@type": "CreativeWork",
        "conformsTo": {"@id": "https://w3id.org/ro/crate/1.1"},
        "about": {"@id": "./"},
    }
    terms = ["https://w3id.org/ro/crate/1.1/context", {"sha256": "https://w3id.org/ro/terms/workflow-run#sha256"}]
    return {"@context": terms, "@graph": [about, root, *files]}


def open_shared(source: Path, into: Path) -> list[Path]:
    """Unpack a shared run as the new folder ``into`` and return its files; nothing is written where anything in it is not sound.

    Raises UsageError, one sentence: no archive of a run, a name that leads elsewhere, a link, a program, a file that is missing,
    not described, or another than described, and an archive that would unpack to more than a run is.
    """
    if into.exists():
        raise UsageError(f"{shown_path(into)}: exists already; give another folder: --into DIR")
    try:
        with zipfile.ZipFile(source) as archive:
            wanted = _checked(source, archive)
            with disk_errors(into):
                into.parent.mkdir(parents=True, exist_ok=True)
                part = Path(tempfile.mkdtemp(prefix=f".{into.name}.", dir=into.parent))
            try:
                for info, row in wanted:
                    _unpack(source, archive, info, row, part / "run")
                open_folder(part / "run")
                with disk_errors(into):
                    (part / "run").rename(into)
            finally:
                shutil.rmtree(part, ignore_errors=True)
    except NOT_SOUND as error:
        raise UsageError(f"{shown_path(source)}: is no archive of a run: {first_line(error)}") from error
    return sorted(path for path in into.rglob("*") if path.is_file())


def _checked(source: Path, archive: zipfile.ZipFile) -> list[tuple[zipfile.ZipInfo, dict[str, Any]]]:
    """Return what an archive holds with its description, without having unpacked any of it."""
    where, infos = shown_path(source), [info for info in archive.infolist() if not info.is_dir()]
    if len(infos) > MOST_FILES:
        raise UsageError(f"{where}: has {len(infos)} files; a run has at most {MOST_FILES}")
    total = sum(info.file_size for info in infos)
    packed = source.stat().st_size
    if total > MOST_BYTES or total > MOST_RATIO * max(packed, 1):
        raise UsageError(f"{where}: would unpack to {total / 2**20:.0f} MB from {packed / 2**20:.3g} MB; that is no run")
    names: dict[str, zipfile.ZipInfo] = {}
    for info in infos:
        for fault in _faults(info):
            raise UsageError(f"{where}: holds {fault}; nothing is unpacked")
        if names.setdefault(info.filename.casefold(), info) is not info:
            raise UsageError(f"{where}: holds '{info.filename!r:.80}' twice; nothing is unpacked")
    description = names.pop(CRATE, None)
    if description is None or description.file_size > MOST_DESCRIPTION:
        raise UsageError(f"{where}: is no archive of a run: {CRATE} is missing; hjcamp share RUN makes one")
    rows = {row["@id"]: row for row in _rows(where, archive.read(description))}
    found = {info.filename: info for info in names.values()}
    for name in (*(one for one in rows if one not in found), *(one for one in found if one not in rows)):
        raise UsageError(f"{where}: {name!r:.80} is {'missing' if name in rows else 'not described'}; nothing is unpacked")
    return [(info, rows[name]) for name, info in found.items()]


def _faults(info: zipfile.ZipInfo) -> Iterator[str]:
    """Yield what must not be in an archive that was received."""
    name, shown = info.filename, f"{info.filename!r:.80}"
    path, mode = PurePosixPath(name), info.external_attr >> 16
    parts = name.split("/")
    if path.is_absolute() or "\\" in name or ":" in name or any(part in ("", ".", "..") or part[0] == "." for part in parts):
        yield f"the name {shown}, which leads elsewhere or is hidden"
    elif stat.S_ISLNK(mode) or (mode and not stat.S_ISREG(mode) and stat.S_IFMT(mode)):
        yield f"{shown}, which is no file but a link or a device"
    elif info.flag_bits & 1:
        yield f"{shown}, which is encrypted"
    elif info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        yield f"{shown}, which is packed in a way that no run is"
    elif path.suffix.lower() not in KINDS:
        yield f"{shown}, which is no data of a run ({', '.join(KINDS)})"
    elif (
        any(ord(letter) < 32 or letter in '<>"|?*' for letter in name)
        or len(name) > 400
        or any(len(part) > 200 for part in parts)
    ):
        yield f"the name {shown}, which is none on every computer"


def _rows(where: str, text: bytes) -> list[dict[str, Any]]:
    """Return the files that a description lists."""
    try:
        graph = json.loads(text)["@graph"]
        return [
            {"@id": str(one["@id"]), "size": int(one["contentSize"]), "sha256": str(one["sha256"])}
            for one in graph
            if one.get("@type") == "File"
        ]
    except (KeyError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise UsageError(f"{where}: its {CRATE} cannot be read: {first_line(error)}") from error


def _unpack(source: Path, archive: zipfile.ZipFile, info: zipfile.ZipInfo, row: dict[str, Any], folder: Path) -> None:
    """Write one file, no more of it than is described, and compare its digest."""
    target, digest, left = folder / info.filename, hashlib.sha256(), int(row["size"])
    with disk_errors(target):
        target.parent.mkdir(parents=True, exist_ok=True)
    with archive.open(info) as stream, disk_errors(target), target.open("xb") as written:
        while piece := stream.read(PIECE):
            left -= len(piece)
            if left < 0:
                break
            digest.update(piece)
            written.write(piece)
    if left or digest.hexdigest() != row["sha256"]:
        raise UsageError(
            f"{shown_path(source)}: {info.filename!r:.80} is not the file that its description says; nothing is unpacked"
        )
