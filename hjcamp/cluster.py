"""Work on a dask cluster: connect to it, hand tasks out, and say in one message that it is gone."""

from __future__ import annotations

import importlib
import logging
import pickle
import queue
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, TypeVar

from hjcamp.children import safe_children
from hjcamp.errors import HjcampError, UsageError

Item = TypeVar("Item")
Result = TypeVar("Result")
LOOK_EVERY_S = 0.5
NO_WORKER_S = 30.0
#: Tasks handed out for each thread of the cluster: one at work, one that waits there.
AHEAD = 2


def connected(address: str, named: str = "--cluster ") -> Any:
    """Return a client of the scheduler at ``address``, or of a cluster of this machine for ``local``.

    ``named`` is what the user wrote before the address. `UsageError` where dask is not installed or nobody answers.
    """
    try:
        from distributed import Client
    except ImportError:
        raise UsageError(f"{named.strip(' =')} needs dask: pip install 'hjcamp[cluster]'") from None
    if not address.strip():
        raise UsageError(f"{named}is empty; give tcp://HOST:PORT or local")
    # What it has to say, about lost connections above all, is said in our words.
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    try:
        if address == "local":
            with safe_children():
                return Client(processes=True, threads_per_worker=1, dashboard_address=None)
        return Client(address, timeout="10s")
    except (OSError, ValueError) as error:
        raise UsageError(f"{named}{address}: no dask scheduler answers ({error}); give tcp://HOST:PORT or local") from None


@contextmanager
def cluster_errors() -> Iterator[None]:
    """Turn what dask raises for a scheduler or workers that are gone into one message; a task's own errors stay."""
    from distributed.client import CancelledError
    from distributed.scheduler import KilledWorker

    try:
        yield
    except (OSError, CancelledError, KilledWorker) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise HjcampError(f"the dask cluster is gone: {reason}; start it again, or leave the cluster out") from error


def threads_of(client: Any) -> int:
    """Return how many tasks the cluster does at once; 0 where it has no worker now."""
    with cluster_errors():
        return sum(client.nthreads().values())


def as_done(
    client: Any, task: Callable[[Item], Result], items: Iterable[Item], stop: Callable[[], bool] = lambda: False
) -> Iterator[tuple[Item, Result]]:
    """Yield each item with ``task(item)`` as it ends; no more than the cluster can do soon are handed out at once.

    A task whose worker dies is done by another one. Once ``stop()`` is true nothing more is handed out or waited for.
    `HjcampError` where the scheduler is gone, no worker is there for 30 s, or the workers cannot run the task.
    """
    done: queue.SimpleQueue[Any] = queue.SimpleQueue()
    following = iter(items)
    waiting: dict[Any, Item] = {}
    threads, looked = threads_of(client), time.monotonic()
    staffed = looked
    try:
        while not stop():
            while len(waiting) < AHEAD * max(1, threads):
                try:
                    item = next(following)
                except StopIteration:
                    break
                with cluster_errors():
                    future = client.submit(task, item, pure=False)
                waiting[future] = item
                future.add_done_callback(done.put)
            if not waiting:
                return
            with suppress(queue.Empty):
                future = done.get(timeout=LOOK_EVERY_S)
                item = waiting.pop(future)
                with cluster_errors(), _fit_workers():
                    result = future.result()
                yield item, result
            if time.monotonic() - looked > LOOK_EVERY_S:
                threads, looked = threads_of(client), time.monotonic()
                staffed = looked if threads else staffed
                if looked - staffed > NO_WORKER_S:
                    raise HjcampError(f"the dask cluster has had no worker for {NO_WORKER_S:.0f} s; start some there")
    finally:
        with suppress(Exception):  # nobody is left to hear it where the cluster is gone
            client.cancel(list(waiting))


def imported(call: tuple[str, str, str, bytes]) -> Any:
    """Return ``function(*arguments)`` of a module in a folder; ``call`` is (folder, module, function, pickled arguments).

    For work that lies next to the package: the workers must see the same folder, which the arguments may need as well.
    """
    folder, module, function, arguments = call
    if folder not in sys.path:
        sys.path.insert(0, folder)
    return getattr(importlib.import_module(module), function)(*pickle.loads(arguments))


@contextmanager
def _fit_workers() -> Iterator[None]:
    """Say what to do where a worker has not the program that it is asked to run."""
    try:
        yield
    except Exception as error:
        if not isinstance(error, ImportError) and "deserializ" not in str(error):
            raise
        reason = str(error.__cause__ or error).splitlines()[0]
        raise HjcampError(f"a worker of the dask cluster cannot run this: {reason}; install hjcamp there") from error
