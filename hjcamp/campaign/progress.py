"""The progress of a run: what was just made, how many of how many, the time left."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console


@contextmanager
def progress_bar(console: Console, total: int, done: int) -> Iterator[Callable[[str], None]]:
    """Show a bar on a terminal, nothing elsewhere; yields the function to call after each test."""
    if not console.is_terminal:
        yield lambda test: None
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(elapsed_when_finished=False),
        TextColumn("left"),
    )
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("", total=total, completed=done)

        def advance(test: str) -> None:
            condition, _, repetition = test.partition("/")
            text = f"{condition.replace('__', ' / ')}  {repetition.replace('_', ' ')}"
            progress.update(task, advance=1, description=text)

        yield advance
