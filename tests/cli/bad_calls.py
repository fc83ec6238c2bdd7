"""Makes bad calls over every option and file of the program, and counts what must never happen.

    python tests/cli/bad_calls.py 600 [--page docs/bad_calls.md] [--seed 1] [--limit 20] [--jobs 1] [--only WORD]

Each call runs in a process of its own, in a copy of a folder with a run, logs, effects, plants, controllers,
trajectories, models and configuration. What must never happen: an internal error or traceback, no end within the limit,
a part of a file left, a file written by a call that is refused, a message of many lines, exit code 0 with nothing said.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from bad_cases import Case, all_cases, shown
from bad_files import prepared

LIMIT_S = 20.0
LONGEST_MESSAGE = 12
CODES = (0, 1, 2, 3, 130)
SERVING = "is served at"
# Imported once for all calls. Not polars: it starts threads, and those do not live through a fork.
LOADED = (
    "hydra", "omegaconf", "pydantic", "numpy", "numba", "scipy.linalg", "scipy.optimize", "rich.console", "rich.table",
    "hjcamp.cli", "hjcamp.configuration.check", "hjcamp.campaign.plan.planning", "hjcamp.plants.pump_joint.simulation",
    "hjcamp.records.find", "hjcamp.records.recover",
)  # fmt: skip


@dataclass(frozen=True)
class Outcome:
    """How a call ended: its code (None: it did not), seconds, what it printed, parts of files and new files it left."""

    code: int | None
    seconds: float
    out: str
    err: str
    parts: tuple[str, ...] = ()
    written: tuple[str, ...] = ()

    def faults(self) -> list[str]:
        """Return what must not have happened."""
        found = []
        text = self.out + self.err
        if self.code is None:
            found.append("did not end")
        if "internal error" in text or "Traceback (most recent call last)" in text:
            found.append("internal error")
        if self.code not in (None, *CODES):
            found.append(f"exit code {self.code}")
        if self.parts:
            found.append(f"left {', '.join(self.parts)}")
        if self.code == 2 and self.written:
            found.append(f"refused, and wrote {', '.join(self.written[:3])}")
        if self.code == 2 and len(self.err.strip().splitlines()) > LONGEST_MESSAGE:
            found.append("a message of many lines")
        if self.code in (1, 2) and not self.err.strip():
            found.append("no message")
        if self.code == 0 and not text.strip():
            found.append("code 0 and nothing said")
        return found

    def last_line(self) -> str:
        """Return the last line that was printed."""
        lines = self.err.strip().splitlines() or self.out.strip().splitlines() or [""]
        return lines[-1][:160]


class Call:
    """A call under way: a process in a copy of the folder."""

    def __init__(self, case: Case, original: Path, limit_s: float) -> None:
        self.case, self.limit_s = case, limit_s
        self.place = Path(tempfile.mkdtemp(prefix="bad_call_"))
        self.folder = self.place / "here"
        shutil.copytree(original, self.folder, symlinks=True)
        if case.before is not None:
            case.before(self.folder)
        self.files = self._files()
        self.began = time.monotonic()
        self.code: int | None = None
        self._interrupted = False
        self.child = os.fork()
        if not self.child:
            self._do()

    def ended(self) -> Outcome | None:
        """Return how the call ended, None while it goes on; ends one that takes too long."""
        done, status = os.waitpid(self.child, os.WNOHANG)
        seconds = time.monotonic() - self.began
        if done:
            self.code = os.waitstatus_to_exitcode(status)
        elif seconds > self.limit_s:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self.child, signal.SIGKILL)
            os.waitpid(self.child, 0)
        else:
            if not self._interrupted and SERVING in self._said("out"):
                self._interrupted = True  # a rig is served until Ctrl-C
                os.kill(self.child, signal.SIGINT)
            return None
        new = self._files() - self.files
        parts = tuple(name for name in new if ".part" in name)
        outcome = Outcome(self.code, seconds, self._said("out"), self._said("err"), parts, tuple(sorted(new - {*parts})))
        shutil.rmtree(self.place, ignore_errors=True)
        return outcome

    def _files(self) -> set[str]:
        inside = (path for path in self.folder.rglob("*") if not path.is_dir() and "__pycache__" not in path.parts)
        return {str(path.relative_to(self.folder)) for path in inside}

    def _said(self, name: str) -> str:
        path = self.place / name
        return path.read_text(errors="replace") if path.exists() else ""

    def _do(self) -> None:
        code = 99
        try:
            os.setpgid(0, 0)
            os.chdir(self.folder)
            for name, number in (("out", 1), ("err", 2)):
                os.dup2(os.open(self.place / name, os.O_WRONLY | os.O_CREAT), number)
            os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
            for name, value in {"TMPDIR": str(self.place), **self.case.environment}.items():
                os.environ.pop(name, None)
                if value is not None:
                    os.environ[name] = value
            tempfile.tempdir = None
            from hjcamp import cli

            signal.signal(signal.SIGINT, signal.default_int_handler)
            code = cli.run(list(self.case.words))
            sys.stdout.flush()
            sys.stderr.flush()
        finally:
            os._exit(code)


def called(cases: list[Case], original: Path, limit_s: float, jobs: int = 1) -> Iterator[tuple[Case, Outcome]]:
    """Make the calls, ``jobs`` at a time; yield each with its outcome as it ends."""
    waiting, running = cases[::-1], list[Call]()
    while waiting or running:
        while waiting and len(running) < jobs:
            running.append(Call(waiting.pop(), original, limit_s))
        for call in list(running):
            outcome = call.ended()
            if outcome is not None:
                running.remove(call)
                yield call.case, outcome
        time.sleep(0.01)


def load() -> None:
    """Import what all calls need, in the process from which they are forked."""
    os.environ.pop("HJCAMP_CONF", None)
    for name in LOADED:
        importlib.import_module(name)


def page(command: str, limit_s: float, summary: str, faults: list[str]) -> str:
    """Return docs/bad_calls.md."""
    lines = [
        "# Bad calls",
        "",
        f"Made by `{command}`: every option of every command with values that it cannot have, wrong arguments, addresses"
        " at which no rig is, every value of the configuration, surroundings in which little works (no home folder, no"
        " place to write), and every kind of file that a user writes or gets, damaged in every way.",
        "",
        f"{summary}.",
        "",
        f"A fault is an internal error, no end within {limit_s:g} s, a part of a file left, a file written by a call"
        f" that is refused, a message of more than {LONGEST_MESSAGE} lines, no message, or code 0 with nothing said."
        + ("" if limit_s == LIMIT_S else f" The limit is {LIMIT_S:g} s; here the machine had other work to do."),
        *(["", "| fault |", "|---|", *(f"| {fault.replace('|', '/')} |" for fault in faults)] if faults else []),
        "",
    ]
    return "\n".join(lines)


def main() -> None:
    """Make the calls, print each fault, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("calls", type=int, nargs="?", default=600, help="at least so many")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--limit", type=float, default=LIMIT_S, help="seconds for one call; more on a busy machine")
    parser.add_argument("--jobs", type=int, default=1, help="calls at a time")
    parser.add_argument("--only", default="", help="only calls whose words or kind hold this")
    parser.add_argument("--page", type=Path)
    parser.add_argument("--every", action="store_true", help="print every call with its answer")
    parser.add_argument("--prepare", type=Path, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.prepare:
        prepared(given.prepare.resolve())
        return
    load()
    with tempfile.TemporaryDirectory(prefix="bad_calls_") as name:
        original = Path(name) / "original"
        original.mkdir()
        # In a process of its own, for polars' threads.
        subprocess.run([sys.executable, __file__, "--prepare", str(original)], check=True, stdout=subprocess.DEVNULL)
        cases = [one for one in all_cases(random.Random(given.seed), given.calls) if given.only in f"{one.words} {one.about}"]
        assert "polars" not in sys.modules
        codes: Counter[str] = Counter()
        faults: list[str] = []
        longest = 0.0
        for case, outcome in called(cases, original, given.limit, given.jobs):
            longest = max(longest, outcome.seconds)
            codes["none" if outcome.code is None else str(outcome.code)] += 1
            found = outcome.faults()
            line = f"`{shown(case)}` ({case.about}): {outcome.last_line()}"
            if found:
                faults.append(f"{'; '.join(found)}: {line}")
                print(f"FAULT {faults[-1]}", flush=True)
            elif given.every:
                print(f"{outcome.code} {outcome.seconds:4.1f} s  {line}", flush=True)
    counted = ", ".join(f"{count} with code {code}" for code, count in sorted(codes.items()))
    summary = f"{len(cases)} bad calls: {counted}; longest {longest:.1f} s; {len(faults)} faults"
    print(summary)
    if given.page:
        command = f"python tests/cli/bad_calls.py {given.calls} --seed {given.seed} --limit {given.limit:g} --page {given.page}"
        given.page.write_text(page(command, given.limit, summary, faults))
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
