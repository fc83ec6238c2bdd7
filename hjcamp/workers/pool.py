"""Who does the work of a diagnosis: threads, processes, or a dask cluster; the answer is the same with any of them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from functools import partial
from typing import Any, TypeVar

from hjcamp.algebra import take_one_thread
from hjcamp.cluster import cluster_errors, connected
from hjcamp.workers.processes import Helpers

Item = TypeVar("Item")
Result = TypeVar("Result")


class Crew:
    """``workers`` threads (the kernels run without the interpreter's lock), and a dask cluster where one is named.

    With ``ready`` they are processes, this one among them: the others begin with it, and share the tasks of `each`.
    Linear algebra takes one thread in each: sums in another order round otherwise, and slips turn that into other answers.
    """

    def __init__(self, workers: int = 1, cluster: str | None = None, ready: Callable[[], None] | None = None) -> None:
        helped = ready if cluster is None and workers > 1 else None
        self._helpers = Helpers(workers - 1, helped) if helped else None
        self.workers = 1 if self._helpers else workers
        take_one_thread()
        self._pool: ThreadPoolExecutor | None = None
        self._client = connected(cluster) if cluster is not None else None

    def __reduce__(self) -> tuple[Any, ...]:
        return Crew, (1,)

    def together(self, function: Callable[[Item], Result], items: Iterable[Item]) -> Iterator[Result]:
        """Yield ``function(item)`` in the order of the items; inside such a call, too.

        Who asks does what no thread has begun, so that nobody waits for a thread that waits itself.
        """
        items = list(items)
        if self.workers < 2 or len(items) < 2:
            return map(function, items)
        if self._pool is None:
            self._pool = ThreadPoolExecutor(self.workers)
        return _in_order(function, items, [self._pool.submit(function, item) for item in items])

    def each(self, task: Callable[[Any, Item], Result], context: Any, items: Iterable[Item]) -> Iterator[Result]:
        """Yield ``task(context, item)`` in the order of the items, on the cluster or by the processes where there are any."""
        if self._helpers is not None:
            yield from self._helpers.each(task, context, items)
            return
        if self._client is None:
            yield from self.together(partial(task, context), items)
            return
        futures: list[Any] = []
        try:
            with cluster_errors():
                shared = self._client.scatter(context, broadcast=True, hash=False)
                futures += [self._client.submit(task, shared, item, pure=False) for item in items]
            for future in futures:
                with cluster_errors():
                    result = future.result()
                yield result
        finally:
            with suppress(Exception):  # nobody is left to hear it where the cluster is gone
                self._client.cancel(futures)

    def close(self) -> None:
        """Let the threads, the processes and the cluster go."""
        if self._helpers is not None:
            self._helpers.close()
            self._helpers = None
        if self._pool is not None:
            self._pool.shutdown()
            self._pool = None
        if self._client is not None:
            self._client.close()
            self._client = None


def _in_order(function: Callable[[Item], Result], items: Sequence[Item], futures: Sequence[Future[Result]]) -> Iterator[Result]:
    try:
        for item, future in zip(items, futures, strict=True):
            yield function(item) if future.cancel() else future.result()
    finally:
        for future in futures:
            future.cancel()


def available() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
