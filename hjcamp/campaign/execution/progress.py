"""The progress of a run: what is compiled first, what was just made, how many of how many, the time left."""

from __future__ import annotations

import itertools
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rich.progress import BarColumn, MofNCompleteColumn, Progress, Task, TextColumn, TimeRemainingColumn
from rich.text import Text

from hjcamp.campaign.execution.console import can_move

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

    from hjcamp.campaign.execution.compiling import Kernels

STILL_S, STILL_STEPS = 3.0, 3.0
EVERY_S = 30.0


class Lines:
    """Says every half a minute at most, on a line of standard error, what is being done: where nobody would see a bar move."""

    def __init__(self) -> None:
        self.begun = self.last = time.monotonic()

    def __call__(self, text: str) -> None:
        """Say it, or not yet."""
        now = time.monotonic()
        if now - self.last < EVERY_S:
            return
        self.last = now
        minutes, seconds = divmod(round(now - self.begun), 60)
        print(f"  {minutes}:{seconds:02d}  {text}", file=sys.stderr, flush=True)


class TimeLeft(TimeRemainingColumn):
    """The time left; nothing while nothing advances, because an estimate that stands still is none."""

    max_refresh = 0.5

    def __init__(self) -> None:
        super().__init__()
        self._advanced: dict[int, tuple[float, float, float]] = {}

    def render(self, task: Task) -> Text:
        """Return ``0:01:23 left``, or nothing."""
        now = time.monotonic()
        completed, since, step = self._advanced.get(task.id, (task.completed, now, 0.0))
        if task.completed != completed:
            completed, since, step = task.completed, now, now - since
        self._advanced[task.id] = completed, since, step
        still = now - since > max(STILL_S, STILL_STEPS * step)
        if task.finished or still or task.time_remaining is None:
            return Text("")
        return super().render(task).append(" left")


class _RunProgress(Progress):
    """The bar, and below it what is compiled as long as it lasts."""

    kernels: Kernels | None = None

    def get_renderables(self) -> Iterable[RenderableType]:
        yield self.make_tasks_table(self.tasks)
        if self.kernels is not None and (words := self.kernels.words()):
            yield Text(words, style="dim")


@contextmanager
def progress_bar(console: Console, total: int, done: int, kernels: Kernels | None = None) -> Iterator[Callable[[str], None]]:
    """Show a bar on a terminal, elsewhere what has to be compiled and a line now and then; yields what to call after each test."""
    if not can_move(console):
        if kernels is not None and (words := kernels.words()):
            console.print(f"  {words}", markup=False, soft_wrap=True)
        made, lines = itertools.count(done + 1), Lines()
        yield lambda test: lines(f"{next(made)} of {total} tests")
        return

    columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeLeft())
    with _RunProgress(*columns, console=console, transient=True) as progress:
        progress.kernels = kernels
        task = progress.add_task("", total=total, completed=done)

        def advance(test: str) -> None:
            condition, _, repetition = test.partition("/")
            text = f"{condition.replace('__', ' / ')}  {repetition.replace('_', ' ')}"
            progress.update(task, advance=1, description=text)

        yield advance
