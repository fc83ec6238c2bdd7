"""Hide effects in rigs of the truth plant, diagnose them, and write how often the diagnosis is right.

    python benchmarks/hidden_effects.py [--size small|fresh|full] [--effort quick|standard] [--workers N] [--shift N] [--page FILE]

The truth plant (tests/truth) shares no code with the model. Finished cases are kept in OUT/results.jsonl, so that the same
command goes on after an interruption; --score only writes the page anew. The page goes to OUT/benchmark.md, or to FILE.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

from hidden_effects_cases import SIZES, HiddenCase, plan
from hidden_effects_ledger import Ledger
from hidden_effects_page import page
from hidden_effects_run import alone, run_case

ROOT = Path(__file__).parents[1]
EFFORTS = ("quick", "standard", "thorough")
CODE = ("hjcamp", "conf", "tests/truth")
STOPPED = 130
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the cases that are not finished, then write the page; return the exit code."""
    given = parsed(arguments)
    cases = plan(given.size, given.nulls, given.shift)
    ledger = Ledger(given.out / "results.jsonl")
    done = ledger.finished(given.tag, given.effort)
    left = [] if given.score else [case for case in cases if case.name not in done]
    whole = not left or run_all(left, given, ledger)
    lines = ledger.lines(given.tag)
    if not lines:
        print(f"no finished case of {given.tag} in {ledger.path}", file=sys.stderr)
        return 1 if whole else STOPPED
    command = (
        f"python benchmarks/hidden_effects.py --size {given.size} --effort {given.effort} --workers {given.workers}"
    )
    command += "" if given.nulls is None else f" --nulls {given.nulls}"
    command += f" --shift {given.shift}" if given.shift else ""
    text = page(lines, cases, given.effort, given.tag, command, len(os.sched_getaffinity(0)))
    complete = {case.name for case in cases} <= set(ledger.finished(given.tag, given.effort))
    # a committed page is never replaced by one of half the cases
    target = given.page if given.page is not None and (complete or given.score) else given.out / "benchmark.md"
    replaced(target, text)
    print(f"page    {target}")
    return 0 if whole else STOPPED


def parsed(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Return the options."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--size", choices=SIZES, default="full")
    parser.add_argument("--effort", choices=EFFORTS, default="standard")
    parser.add_argument("--workers", type=int, default=1, help="processes, each with one thread")
    parser.add_argument("--nulls", type=int, help="rigs with nothing hidden; by default as the size says")
    parser.add_argument("--shift", type=int, default=0, metavar="N", help="added to every seed: the plan on other rigs")
    parser.add_argument("--out", type=Path, default=Path("build/benchmark"), metavar="FOLDER")
    parser.add_argument("--tag", default=commit(), help="version of the code; the git commit by default")
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


def commit() -> str:
    """Return the git commit of the checkout, with a mark where the code differs from it."""

    def git(*arguments: str) -> str:
        call = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
        return call.stdout.strip() if call.returncode == 0 else ""

    try:
        name = git("rev-parse", "--short", "HEAD") or "unknown"
        return name + ("+changes" if git("status", "--porcelain", "--", *CODE) else "")
    except FileNotFoundError:
        return "unknown"


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
        except BrokenProcessPool:
            progress.console.print("a worker was killed (memory?); the same command goes on from here")
            return False
    return True


def results(left: Sequence[HiddenCase], given: argparse.Namespace, seen: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield the results as they come, from processes of their own."""
    # a worker is one process with one thread; it reads these before it loads any numerical library
    os.environ.update(dict.fromkeys(THREADS, "1"))
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(given.workers, mp_context=context, initializer=alone)
    waiting: set[Future[dict[str, Any]]] = set()
    # no more than can run at once, so that an interruption waits for nothing
    following = iter(left)
    try:
        while True:
            for case in following:
                waiting.add(pool.submit(run_case, case, given.effort, given.tag, seen.get(case.name)))
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


def replaced(path: Path, text: str) -> None:
    """Write a file whole, or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(path.name + ".part")
    part.write_text(text, encoding="utf-8")
    os.replace(part, path)


if __name__ == "__main__":
    sys.exit(main())
