"""What compare, diagnose and add share: reading the tests, the answer file, the progress line."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from hjcamp.errors import UsageError, shown
from hjcamp.storage import check_place, shown_path

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.discrepancy.evidence import Evidence


PICTURES = (".pdf", ".png", ".svg")
# Standard output, while it is kept for the answer alone.
_kept: list[IO[str]] = []


def evidence_of(paths: Sequence[Path]) -> Evidence:
    """Return the evidence of the logs at ``paths``; refuse what cannot be, and say on stderr what is doubtful."""
    import sys

    from hjcamp.discrepancy.evidence import prepare
    from hjcamp.records.find import read_logs, refuse_unanalysed
    from hjcamp.records.plausible import refuse_implausible

    logs = read_logs(list(paths))
    refuse_unanalysed(logs, "the diagnosis")
    doubtful: dict[str, list[str]] = {}
    for log in logs:
        for one in refuse_implausible(log, str(log.path)):
            doubtful.setdefault(one.field, []).append(f"{log.path}: {one.line}")
    evidence = prepare(logs)
    for lines in doubtful.values():
        more = f" (and so in {len(lines) - 1} more logs)" if len(lines) > 1 else ""
        print(f"{lines[0]}{more}", file=sys.stderr)
    return evidence


def check_answer_file(path: Path | None) -> None:
    """Refuse a place for the answer that cannot take it, before any work is done.

    Where the answer goes to standard output (``-``), what is meant for people goes to standard error from now on.
    """
    if path is None:
        return
    if not _is_standard_output(path):
        check_place(path, "--json")
    elif sys.stdout is not sys.stderr:
        _kept.append(sys.stdout)
        sys.stdout = sys.stderr


def check_seed(seed: int) -> None:
    """Refuse a seed that ``seed=`` of a run would not take."""
    if not 0 <= seed < 2**63:
        raise UsageError(f"--seed {shown(seed)}: give a whole number, 0 or more and below 2^63")


def check_picture(path: Path) -> None:
    """Refuse a picture format that is not drawn and a place that takes none, before anything is computed."""
    if path.suffix.lower() not in PICTURES:
        raise UsageError(f"figure {shown_path(path)}: the suffix must be one of {', '.join(PICTURES)}")
    check_place(path, "--figure")


def write_answer(path: Path | None, answer: dict[str, Any]) -> None:
    """Write the answer as JSON, to a file whole or not at all."""
    from hjcamp.storage import whole_file

    if path is None:
        return
    text = json.dumps(answer, indent=2, allow_nan=False) + "\n"
    if _kept:
        _kept[-1].write(text)
        _kept[-1].flush()
        return
    with whole_file(path) as stream:
        stream.write(text.encode())


def keep_answer(folder: Path, answer: dict[str, Any]) -> None:
    """Write the answer beside its page, where `hjcamp effects new NAME --from` finds it, whole or not at all."""
    from hjcamp.storage import whole_file

    with whole_file(folder / "answer.json") as stream:
        stream.write((json.dumps(answer, indent=2, allow_nan=False) + "\n").encode())


def free_standard_output() -> None:
    """Give standard output back to what is meant for people, at the end of a call."""
    while _kept:
        sys.stdout = _kept.pop()


def folder_for(name: str, paths: Sequence[Path], answer: Path | None) -> Path:
    """Return where pictures go: a folder ``name`` in the run folder, else beside the answer, else here."""
    if len(paths) == 1 and (paths[0] / "logs").is_dir():
        return paths[0] / name
    has_folder = answer is not None and not _kept and (answer.is_file() or not answer.exists())
    return answer.parent / name if answer is not None and has_folder else Path(name)


def _is_standard_output(path: Path) -> bool:
    """Return whether ``path`` is ``-`` or another name of standard output, such as /dev/stdout."""
    if str(path) == "-":
        return True
    try:
        return os.path.samestat(path.stat(), os.fstat(sys.stdout.fileno()))
    except (OSError, ValueError):
        return False


def calibrated_on(model: str, evidence: Evidence) -> bool:
    """Return whether the base parameters of a saved model were fitted on any of these very logs."""
    from hjcamp.configuration.composer import Composer
    from hjcamp.discrepancy.saved import log_hashes

    origin = Composer().model(model).get("provenance") or {}
    fitted = origin.get("logs_sha256") if isinstance(origin, dict) else None
    return isinstance(fitted, dict) and bool(set(fitted.values()) & set(log_hashes(evidence).values()))


def free_model_name(stem: str) -> str:
    """Return a name that no model has yet: ``stem``, else ``stem_2`` and so on."""
    from hjcamp.configuration.composer import Composer
    from hjcamp.discrepancy.saved import FOLDER

    taken = set(Composer().options("model")) | {path.stem for path in FOLDER.glob("*.yaml")}
    number, name = 1, stem
    while name in taken:
        number += 1
        name = f"{stem}_{number}"
    return name


def joined(paths: Sequence[Path]) -> str:
    """Return the paths as they would be typed."""
    import shlex

    return shlex.join(str(path) for path in paths)


@contextmanager
def progress_of(console: Console) -> Iterator[Callable[[str, float], None]]:
    """Show what is being done and the time left on a terminal, nothing elsewhere; yields report(text, share)."""
    if not console.is_terminal:
        yield lambda text, share: None
        return
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    from hjcamp.campaign.progress import TimeLeft

    columns = (
        TextColumn("{task.description:<44}"),
        BarColumn(),
        TimeElapsedColumn(),
        TimeLeft(),
    )
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("reading", total=1.0)
        yield lambda text, share: progress.update(task, completed=share, description=text)
