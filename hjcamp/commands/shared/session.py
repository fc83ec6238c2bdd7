"""What compare, diagnose and add share: reading the tests, the answer file, the progress line."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING, Annotated, Any

import typer

from hjcamp.errors import UsageError, counted
from hjcamp.storage import check_place, own_folder, shown_path, whole_file

if TYPE_CHECKING:
    from rich.console import Console

ALMOST = 0.999
PICTURES = (".pdf", ".png", ".svg")
#: ``--json`` of every command that answers.
AnswerFile = Annotated[
    Path | None,
    typer.Option(
        "--json",
        metavar="FILE|-",
        help="Write the answer for programs to this file; - is standard output.",
        show_default=False,
    ),
]
# Standard output, while it is kept for the answer alone.
_kept: list[IO[str]] = []


def check_answer_file(path: Path | None) -> None:
    """Refuse a place for the answer that cannot take it, before any work is done.

    Where the answer goes to standard output (``-``), what is meant for people goes to standard error from now on.
    """
    if path is None:
        return
    if not _is_standard_output(path):
        _refuse_no_file(path)
        check_place(path, "--json")
    elif sys.stdout is not sys.stderr:
        _kept.append(sys.stdout)
        sys.stdout = sys.stderr


def _refuse_no_file(path: Path) -> None:
    """Refuse a device, a link, a folder and an option in the place of the file; a pipe takes the answer as a file does."""
    said = f"--json {shown_path(path)}"
    if str(path).startswith("-"):
        raise UsageError(f"{said}: this is an option; give a file, or - for standard output")
    try:
        is_pipe, is_link, is_other = path.is_fifo(), path.is_symlink(), path.exists() and not path.is_file()
    except OSError:
        return  # check_place says what is wrong with the name
    if not is_pipe and (is_link or is_other):
        kind = "a link" if is_link else "a folder" if path.is_dir() else "a device"
        raise UsageError(f"{said}: this is {kind}; give a file, or - for standard output")


def check_picture(path: Path) -> None:
    """Refuse a picture format that is not drawn and a place that takes none, before anything is computed."""
    if path.suffix.lower() not in PICTURES:
        raise UsageError(f"figure {shown_path(path)}: the suffix must be one of {', '.join(PICTURES)}")
    check_place(path, "--figure")


def write_answer(path: Path | None, answer: dict[str, Any]) -> None:
    """Write the answer as JSON, to a file whole or not at all."""
    if path is None:
        return
    text = json.dumps(answer, indent=2, allow_nan=False) + "\n"
    if _kept:
        _kept[-1].write(text)
        _kept[-1].flush()
        return
    with whole_file(path) as stream:
        stream.write(text.encode())


def keep_answer(folder: Path, answer: dict[str, Any], name: str = "answer.json") -> None:
    """Write the answer next to its page, where `hjcamp effects new NAME --from` finds it, whole or not at all."""
    with whole_file(folder / name) as stream:
        stream.write((json.dumps(answer, indent=2, allow_nan=False) + "\n").encode())


def free_standard_output() -> None:
    """Give standard output back to what is meant for people, at the end of a call."""
    while _kept:
        sys.stdout = _kept.pop()


def no_logs() -> UsageError:
    """Return the refusal of a call that names neither logs nor tables."""
    return UsageError("name run folders, folders of logs or log files; or --tables with a published table or a CSV file")


def tell_of_views(console: Console, files: list[Path]) -> None:
    """Say where tests with models as topics were written, and what opens them."""
    if files:
        console.print(f"mcap     {counted(len(files) - 2, 'test')} in {files[0].parent}", markup=False)
        console.print(f"         layouts {files[-2]} (Foxglove), {files[-1]} (PlotJuggler)", markup=False)


def folder_for(name: str, paths: Sequence[Path], answer: Path | None) -> Path:
    """Return where pictures go: a folder ``name`` in the run folder, else next to the answer, else here; no link is one."""
    if len(paths) == 1 and (paths[0] / "logs").is_dir():
        return own_folder(paths[0] / name)
    has_folder = answer is not None and not _kept and (answer.is_file() or not answer.exists())
    return own_folder(answer.parent / name if answer is not None and has_folder else Path(name))


def _is_standard_output(path: Path) -> bool:
    """Return whether ``path`` is ``-`` or another name of standard output, such as /dev/stdout."""
    if str(path) == "-":
        return True
    try:
        return os.path.samestat(path.stat(), os.fstat(sys.stdout.fileno()))
    except (OSError, ValueError):
        return False


@contextmanager
def progress_of(console: Console) -> Iterator[Callable[[str, float], None]]:
    """Show what is being done and the time left on a terminal, a line now and then elsewhere; yields report(text, share)."""
    from hjcamp.campaign.execution.console import can_move
    from hjcamp.campaign.execution.progress import Lines, TimeLeft

    if not can_move(console):
        lines = Lines()
        yield lambda text, share: lines(f"{text} ({share:.0%})")
        return
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("{task.description:<44}", markup=False),
        BarColumn(),
        TimeElapsedColumn(),
        TimeLeft(),
    )
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("reading", total=1.0)
        # what has once been whole keeps its clock for ever, though the next step begins anew
        yield lambda text, share: progress.update(task, completed=min(share, ALMOST), description=text)
