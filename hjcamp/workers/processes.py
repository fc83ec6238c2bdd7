"""Processes that share the tasks of a diagnosis with the one that asks: the interpreter's lock lets threads gain nothing."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import shutil
import signal
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Future, ProcessPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TypeVar

from hjcamp.children import safe_children
from hjcamp.memory import guard_memory

Item = TypeVar("Item")
Result = TypeVar("Result")
# One at work, two that wait for it.
AHEAD = 3


class Helpers:
    """``count`` processes that begin at once with ``ready()``, while the one that asks reads its logs.

    What the tasks of one call share goes through a file, once to each process, and not with each task.
    """

    def __init__(self, count: int, ready: Callable[[], None]) -> None:
        self._folder = TemporaryDirectory(prefix="hjcamp_diagnose_")
        self._calls, self._count = 0, count
        spawn = multiprocessing.get_context("spawn")
        with _interrupts_held(), safe_children():
            self._pool: ProcessPoolExecutor | None = ProcessPoolExecutor(count, spawn, _begin, (self._folder.name, ready))
            self._pool.submit(os.getpid)

    def each(self, task: Callable[[Any, Item], Result], context: Any, items: Iterable[Item]) -> Iterator[Result]:
        """Yield ``task(context, item)`` in the order of the items.

        Who asks does the last of those that no process has got yet; where a process is killed it does the rest.
        """
        items = list(items)
        path = self._shared(context) if len(items) > 1 else ""
        try:
            yield from self._gathered(task, context, items, path)
        finally:
            if path:
                Path(path).unlink(missing_ok=True)

    def _gathered(
        self, task: Callable[[Any, Item], Result], context: Any, items: Sequence[Item], path: str
    ) -> Iterator[Result]:
        waiting = deque(range(len(items)))
        given: dict[int, Future[Result]] = {}
        done: dict[int, Result] = {}
        for place in range(len(items)):
            while place not in done:
                self._give(task, path, items, waiting, given)
                if place in given and (given[place].done() or not waiting):
                    try:
                        done[place] = given[place].result()
                    except (BrokenExecutor, CancelledError):
                        self.close()
                        done[place] = task(context, items[place])
                else:
                    last = waiting.pop()
                    done[last] = task(context, items[last])
            yield done.pop(place)

    def _shared(self, context: Any) -> str:
        """Write what the tasks of one call share; return where, and an empty text where there are no processes any more."""
        if self._pool is None:
            return ""
        self._calls += 1
        path = Path(self._folder.name) / f"{self._calls}.pickle"
        path.write_bytes(pickle.dumps(context, protocol=pickle.HIGHEST_PROTOCOL))
        return str(path)

    def _give(
        self,
        task: Callable[[Any, Item], Result],
        path: str,
        items: Sequence[Item],
        waiting: deque[int],
        given: dict[int, Future[Result]],
    ) -> None:
        """Give the processes the first of what waits: as much as keeps them busy, and no more than is left for who asks."""
        busy = sum(not future.done() for future in given.values())
        while path and self._pool is not None and busy < self._count * min(AHEAD, len(waiting) - 1):
            place = waiting.popleft()
            try:
                with safe_children():
                    given[place] = self._pool.submit(_call, task, path, items[place])
                busy += 1
            except BrokenExecutor:
                waiting.appendleft(place)
                self.close()

    def close(self) -> None:
        """End the processes, at once where they are still at work."""
        if self._pool is not None:
            processes = list((getattr(self._pool, "_processes", None) or {}).values())
            self._pool.shutdown(wait=False, cancel_futures=True)
            for process in processes:
                process.terminate()
            self._pool = None
            self._folder.cleanup()


_kept: tuple[str, Any] = ("", None)


def _call(task: Callable[[Any, Item], Result], path: str, item: Item) -> Result:
    """Do one task in a process; the context of the call before is let go."""
    global _kept
    if _kept[0] != path:
        _kept = ("", None)
        _kept = (path, pickle.loads(Path(path).read_bytes()))
    return task(_kept[1], item)


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Hold Ctrl-C back while processes are started, which inherit that: it is for who asks."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin(folder: str, ready: Callable[[], None]) -> None:
    """Begin as a helper; whoever has lost who asks tidies up and ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    guard_memory()
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent, folder), daemon=True).start()
    ready()


def _end_with(parent: Any, folder: str) -> None:
    parent.join()
    shutil.rmtree(folder, ignore_errors=True)
    os._exit(1)
