"""Hide effects in rigs of the truth plant, diagnose them, and write how often the diagnosis is right.

    python -m benchmarks.hidden_effects [--size small|fresh|full] [--effort quick|standard] [--workers N | --cluster ADDRESS]
                                        [--shift N] [--page FILE]

The truth plant (tests/truth) shares no code with the model. Finished cases are kept in a ledger, one line each, which is
committed: the same command goes on from it as long as the code it runs is the same, and --score writes the page from it alone.
Cases are run in random order, so that a part of the plan is a fair sample. The page of a part goes beside the ledger.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import random
import signal
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

from benchmarks import ROOT
from benchmarks.hidden_effects.cases import SIZES, HiddenCase, plan
from benchmarks.hidden_effects.ledger import Ledger, code_version
from benchmarks.hidden_effects.one_case import alone, run_case
from benchmarks.hidden_effects.page import page
from benchmarks.on_cluster import there
from hjcamp.errors import HjcampError
from hjcamp.storage import write_whole

LEDGER = ROOT / "benchmarks" / "results" / "hidden_effects.jsonl"
EFFORTS = ("quick", "standard", "thorough")
STOPPED = 130
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the cases that are not finished, then write the page; return the exit code."""
    given = parsed(arguments)
    cases = plan(given.size, given.nulls, given.shift)
    ledger = Ledger(given.ledger)
    done = ledger.finished(given.tag, given.effort)
    left = [] if given.score else [case for case in shuffled(cases) if case.name not in done]
    whole = not left or run_all(left, given, ledger)
    lines = ledger.lines(given.tag)
    if not lines:
        print(f"no finished case of {given.tag} in {ledger.path}", file=sys.stderr)
        return 1 if whole else STOPPED
    command = f"python -m benchmarks.hidden_effects --size {given.size} --effort {given.effort} --workers {given.workers}"
    command += "" if given.nulls is None else f" --nulls {given.nulls}"
    command += f" --shift {given.shift}" if given.shift else ""
    text = page(lines, cases, given.effort, given.tag, command, len(os.sched_getaffinity(0)))
    complete = {case.name for case in cases} <= set(ledger.finished(given.tag, given.effort))
    # a committed page is never replaced by one of half the cases
    target = given.page if given.page is not None and (complete or given.score) else given.ledger.with_suffix(".md")
    write_whole(target, text)
    print(f"page    {target}")
    return 0 if whole else STOPPED


def parsed(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Return the options."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--size", choices=SIZES, default="full")
    parser.add_argument("--effort", choices=EFFORTS, default="standard")
    parser.add_argument("--workers", type=int, default=1, help="processes, each with one thread")
    parser.add_argument("--cluster", metavar="ADDRESS", help="a dask scheduler whose workers see this folder, or local")
    parser.add_argument("--nulls", type=int, help="rigs with nothing hidden; by default as the size says")
    parser.add_argument("--shift", type=int, default=0, metavar="N", help="added to every seed: the plan on other rigs")
    parser.add_argument("--ledger", type=Path, default=LEDGER, metavar="FILE", help="one JSON line for each finished case")
    parser.add_argument("--tag", default=code_version(), help="version of the code; the last commit that changed it by default")
    parser.add_argument("--page", type=Path, metavar="FILE", help="where the page goes once every case is finished")
    parser.add_argument("--score", action="store_true", help="run nothing, write the page of what is finished")
    given = parser.parse_args(arguments)
    if given.workers < 1:
        parser.error(f"--workers {given.workers}: give a whole number, 1 or more")
    if given.nulls is not None and given.nulls < 0:
        parser.error(f"--nulls {given.nulls}: give a whole number, 0 or more")
    if given.shift < 0:
        parser.error(f"--shift {given.shift}: give a whole number, 0 or more")
    return given


def shuffled(cases: Sequence[HiddenCase]) -> list[HiddenCase]:
    """Return the cases in an order that chance has made, always the same one for a plan."""
    return random.Random(len(cases)).sample(cases, len(cases))


def run_all(left: Sequence[HiddenCase], given: argparse.Namespace, ledger: Ledger) -> bool:
    """Run the cases and keep their results; False where they were interrupted."""
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns = (TextColumn("{task.description:<44}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    # a mean over many cases: they take from ten seconds to a minute each
    with Progress(*columns, TimeRemainingColumn(), TextColumn("left"), speed_estimate_period=3600) as progress:
        task = progress.add_task("first cases, kernels compile", total=len(left))
        try:
            for line in results(left, given, ledger.visibilities()):
                ledger.add(line)
                said = line.get("failure") or line["answer"]["verdict"]
                progress.update(task, advance=1, description=f"{line['name']}: {said}"[:44])
                if not progress.console.is_terminal:
                    progress.console.print(f"{line['name']}: {said}", markup=False, highlight=False)
        except KeyboardInterrupt:
            progress.console.print("stopped; the same command goes on from here")
            return False
        except HjcampError as error:
            progress.console.print(f"{error}; the same command goes on from here", markup=False)
            return False
        except BrokenProcessPool:
            progress.console.print("a worker was killed (memory?); the same command goes on from here")
            return False
    return True


def results(left: Sequence[HiddenCase], given: argparse.Namespace, seen: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield the results as they come, from a cluster where one is named, else from processes of their own."""
    calls = [(case, given.effort, given.tag, seen.get(case.name)) for case in left]
    if given.cluster:
        yield from there("benchmarks.hidden_effects.one_case", "run_case", calls, given.cluster)
        return
    # a worker is one process with one thread; it reads these before it loads any numerical library
    os.environ.update(dict.fromkeys(THREADS, "1"))
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(given.workers, mp_context=context, initializer=alone)
    waiting: set[Future[dict[str, Any]]] = set()
    # no more than can run at once, so that an interruption waits for nothing
    following = iter(calls)
    try:
        while True:
            for call in following:
                waiting.add(pool.submit(run_case, *call))
                if len(waiting) >= given.workers:
                    break
            if not waiting:
                return
            finished, waiting = wait(waiting, return_when=FIRST_COMPLETED)
            for future in finished:
                yield future.result()
    finally:
        stop(pool)


def stop(pool: ProcessPoolExecutor) -> None:
    """End the workers at once: what they have not finished is run again another time."""
    workers = list((getattr(pool, "_processes", None) or {}).values())
    pool.shutdown(wait=False, cancel_futures=True)
    for worker in workers:
        if worker.pid is not None and worker.is_alive():
            os.kill(worker.pid, signal.SIGTERM)


if __name__ == "__main__":
    sys.exit(main())
