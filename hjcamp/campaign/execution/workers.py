"""Run jobs one after the other or on worker processes, with the same results."""

from __future__ import annotations

import multiprocessing
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from hjcamp.campaign.execution.one_test import Job, execute, execute_in_worker, ignore_interrupts
from hjcamp.campaign.execution.outcome import Outcome
from hjcamp.children import safe_children
from hjcamp.errors import HjcampError

PARALLEL_BACKENDS = ("simulation", "replay")
STARTUP_S = 2.5  # measured: what it takes to start two workers and import the simulation there
# Workers whose runner was killed end by themselves after this many seconds without work.
LOKY: dict[str, Any] = {"backend": "loky", "initializer": ignore_interrupts, "idle_worker_timeout": 30}
TRIAL_TESTS = 3  # the first test may compile; judge by the following ones


def available_workers(asked: int | None, backend: str) -> tuple[int, bool]:
    """Return the number of processes at most, and whether that many were asked for.

    A rig is driven by one process, and a process that is itself a worker (of a sweep) starts no others.
    """
    from joblib import cpu_count

    if backend not in PARALLEL_BACKENDS or is_worker():
        return 1, True
    return (cpu_count(), False) if asked is None else (asked, True)


def is_worker() -> bool:
    """Return whether this process was started by joblib or multiprocessing."""
    process = multiprocessing.current_process()
    return multiprocessing.parent_process() is not None or process.name.startswith("Loky") or process.daemon


def outcomes(jobs: Sequence[Job], workers: int, fixed: bool, stop: Callable[[], bool]) -> Iterator[Outcome]:
    """Yield the outcome of each job as it ends; no new one starts once ``stop()`` is true.

    Unless the number of workers is ``fixed``, the first tests run here, and workers start only where they pay off.
    """
    position = 0
    if workers > 1 and not fixed:
        spent = []
        while position < len(jobs) and not stop():
            start = time.perf_counter()
            yield execute(jobs[position])
            spent.append(time.perf_counter() - start)
            position += 1
            if position >= TRIAL_TESTS and min(spent) * (len(jobs) - position) * (1 - 1 / workers) > STARTUP_S:
                break
    if workers == 1 or position == len(jobs):
        for job in jobs[position:]:
            if stop():
                return
            yield execute(job)
        return
    yield from _on_workers(jobs[position:], min(workers, max(1, len(jobs) - position)), stop)


def _on_workers(jobs: Sequence[Job], workers: int, stop: Callable[[], bool]) -> Iterator[Outcome]:
    from joblib import Parallel, delayed, parallel_config
    from joblib.externals.loky.process_executor import TerminatedWorkerError

    def waiting() -> Iterator[object]:
        for job in jobs:
            if stop():
                return
            yield delayed(execute_in_worker)(job)

    try:
        with warnings.catch_warnings(), safe_children(), parallel_config(**LOKY):
            warnings.simplefilter("ignore")
            yield from Parallel(n_jobs=workers, return_as="generator_unordered", batch_size=1)(waiting())
    except TerminatedWorkerError as error:
        if not stop():
            raise HjcampError("a worker process was killed (out of memory?); try workers=1") from error
