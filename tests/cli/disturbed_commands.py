"""Disturbs every long command: kill -9 at random moments, Ctrl-C twice, little memory, few files, a full disk.

    python tests/cli/disturbed_commands.py 2 [--kills 200] [--only WORD] [--seed 1]

so many times each command in each way, and so many kills of all commands together. Each command is made once undisturbed:
it must succeed, and its length is where kills and Ctrl-C fall. What must never happen: an internal error, a traceback, a
log that was changed, a file under its final name that is not whole, a part of a file left by a call that was not killed,
no end after Ctrl-C, processes that outlive the one that was killed, and the same call that no longer works afterwards.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from hjcamp.errors import UsageError
from hjcamp.records.read import read_log
from hjcamp.yaml_file import read_yaml

BAD_CALLS = Path(__file__).with_name("bad_calls.py")
SPINDLE = Path(__file__).parents[2] / "hjcamp" / "plants" / "pump_joint" / "tour" / "spindle"
ROWS = 601  # of a recording of the spindle; short, so that a diagnosis takes seconds
COMMANDS = {
    "run": "run campaign=controllers conditions=[ramp_pos__pid] repetitions=3 workers=1 run_dir=new",
    "resume": "resume run", "report": "report run", "compare": "compare run",
    "diagnose": "diagnose run --effort quick --only leakage",
    "add": "add leakage run --as with_leakage", "next": "next run --effort quick --tests 1 --as then",
    "export": "log export run --as csv --into tables", "verify": "log verify run",
    "paper": "paper run --as text --formats svg",
    "effects": "effects test my_spring", "tune": "tune controller=pid --as mine",
    "spindle import": "import measured/train_1.csv measured/train_2.csv --map spindle.yaml --into more",
    "spindle compare": "compare spin", "spindle diagnose": "diagnose spin --effort quick --only quadratic_drag",
    "spindle add": "add quadratic_drag spin --as with_drag", "spindle next": "next spin --effort quick --tests 1 --as then",
    "spindle calibrate": "calibrate spin --as own",
}  # fmt: skip
WAYS = ("kill", "interrupt", "memory", "files", "disk")
OUT_S, WANTED_S, ORPHANS_S, LIMIT_S = 60.0, 5.0, 15.0, 600.0
MEMORY_MB = (150, 300, 600, 1200, 2500)
FILES = (12, 16, 20, 30, 40)  # with fewer the interpreter itself does not begin
DISK_BYTES = (0, 100, 4_000, 50_000, 300_000)


@dataclass
class Count:
    """What was counted: calls by way and code, calls that were under way when disturbed, seconds out after Ctrl-C."""

    codes: Counter[str] = field(default_factory=Counter)
    hit: Counter[str] = field(default_factory=Counter)
    again: int = 0
    out_s: list[float] = field(default_factory=list)
    faults: int = 0

    def __str__(self) -> str:
        slow = sum(seconds > WANTED_S for seconds in self.out_s)
        return "\n".join(
            (
                f"{sum(self.codes.values())} disturbed calls: {', '.join(f'{n} {key}' for key, n in sorted(self.codes.items()))}",
                f"at work when hit: {', '.join(f'{n} {key}' for key, n in sorted(self.hit.items()))}; called again: {self.again}",
                f"out after the second Ctrl-C: longest {max(self.out_s, default=0.0):.1f} s, "
                f"{slow} of {len(self.out_s)} over {WANTED_S:g} s",
                f"{self.faults} faults",
            )
        )


def prepared(folder: Path) -> None:
    """Make the folder that calls get copies of: a run of the joint, and a spindle with two recordings and their logs."""
    subprocess.run([sys.executable, str(BAD_CALLS), "--prepare", str(folder)], check=True, stdout=subprocess.DEVNULL)
    (folder / "loop").unlink()
    shutil.copy(SPINDLE / "plant.txt", folder / "plants" / "spindle.py")
    shutil.copy(SPINDLE / "map.yaml", folder / "spindle.yaml")
    (folder / "measured").mkdir()
    for name in ("train_1.csv", "train_2.csv"):
        rows = (SPINDLE / name).read_text().splitlines(keepends=True)
        (folder / "measured" / name).write_text("".join(rows[:ROWS]))
    words = "import measured/train_1.csv measured/train_2.csv --map spindle.yaml --into spin"
    subprocess.run([sys.executable, "-m", "hjcamp", *words.split()], cwd=folder, check=True, stdout=subprocess.DEVNULL)


def limited(kind: int, value: int) -> Callable[[], None]:
    """Return what a process does before the call: it takes a limit of the system, where a full disk is one of no signal."""

    def before() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(kind, (value, value))

    return before


class Call(subprocess.Popen[bytes]):
    """A call in a folder, in a group of its own; a thread keeps what it says, which no limit of the call cuts off."""

    def __init__(self, words: str, folder: Path, before: Callable[[], None] | None = None) -> None:
        super().__init__(
            [sys.executable, "-m", "hjcamp", *words.split()], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, start_new_session=True, preexec_fn=before,
        )  # fmt: skip
        self._lines: list[bytes] = []
        self._keeper = threading.Thread(target=lambda: self._lines.extend(self.stdout or ()), daemon=True)
        self._keeper.start()

    def ended(self, limit_s: float) -> int | None:
        """Wait for the call; its code, or None where it had to be ended."""
        try:
            return self.wait(limit_s)
        except subprocess.TimeoutExpired:
            os.killpg(self.pid, signal.SIGKILL)
            self.wait()
            return None

    def said(self) -> str:
        """Return what the call has said; processes that outlive it may hold its output open."""
        self._keeper.join(WANTED_S)
        return b"".join(self._lines).decode(errors="replace")


def members(group: int) -> list[int]:
    """Return the processes of a group that are alive."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            state, _, of = (entry / "stat").read_text().rpartition(")")[2].split()[:3]
        except (OSError, ValueError):
            continue
        if int(of) == group and state != "Z":
            found.append(int(entry.name))
    return found


def outlive(group: int) -> bool:
    """Return whether processes of a group are there for long after their first one was killed; they are ended."""
    end = time.monotonic() + ORPHANS_S
    while members(group):
        if time.monotonic() > end:
            os.killpg(group, signal.SIGKILL)
            return True
        time.sleep(0.05)
    return False


def logs_of(folder: Path) -> dict[str, str]:
    """Return the hash of each log that was there before."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(folder.rglob("*.mcap"))
    }


def not_whole(folder: Path) -> list[str]:
    """Return the files under a final name that cannot be read."""
    found = []
    for path in folder.rglob("*"):
        try:
            if path.is_symlink() or not path.is_file() or "tour" in path.parts:
                continue
            if path.suffix == ".mcap":
                with contextlib.chdir(folder):  # its plant is a file there
                    read_log(path)
            elif path.suffix == ".json":
                json.loads(path.read_text())
            elif path.suffix in (".yaml", ".yml"):
                read_yaml(path)
            elif path.suffix == ".html" and not path.read_text().rstrip().endswith("</html>"):
                found.append(f"{path.name}: cut off")
        except (UsageError, ValueError) as error:
            found.append(f"{path.name}: {error}")
    return found


def interrupted(process: Call, chance: random.Random, count: Count) -> tuple[int | None, list[str]]:
    """Ctrl-C twice, as a terminal sends it: to the whole group."""
    os.killpg(process.pid, signal.SIGINT)
    time.sleep(chance.uniform(0.0, 0.5))
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGINT)
    began = time.monotonic()
    code = process.ended(OUT_S)
    count.out_s.append(time.monotonic() - began)
    return code, ["processes go on"] if outlive(process.pid) else []


def killed(process: Call, chance: random.Random) -> tuple[int | None, list[str]]:
    """Kill the whole group, as a power cut does, or its first process alone, as a system short of memory does."""
    if chance.random() < 0.5:
        os.killpg(process.pid, signal.SIGKILL)
    else:
        process.kill()
    code = process.ended(OUT_S)
    return code, ["processes outlive it"] if outlive(process.pid) else []


def disturb(
    way: str, words: str, folder: Path, chance: random.Random, long_s: float, count: Count
) -> tuple[int | None, list[str]]:
    """Make one call, disturb it; return its code (None: it did not end) and what must not have happened."""
    before = None
    if way == "memory":
        before = limited(resource.RLIMIT_AS, chance.choice(MEMORY_MB) * 2**20)
    elif way == "files":
        before = limited(resource.RLIMIT_NOFILE, chance.choice(FILES))
    elif way == "disk":
        before = limited(resource.RLIMIT_FSIZE, chance.choice(DISK_BYTES))
    logs = logs_of(folder)
    process = Call(words, folder, before)
    found: list[str] = []
    try:
        code: int | None = process.wait(LIMIT_S if before else chance.uniform(0.0, long_s))
    except subprocess.TimeoutExpired:
        count.hit[way] += 1
        if way == "kill":
            code, found = killed(process, chance)
        elif way == "interrupt":
            code, found = interrupted(process, chance, count)
        else:
            code = process.ended(0.0)
    count.codes[f"{way} {code}"] += 1
    said = process.said()
    found += faults(way, code, said, folder, logs)
    return code, [*found, " ".join(said.split())[-300:]] if found else []


def faults(way: str, code: int | None, said: str, folder: Path, logs: dict[str, str]) -> list[str]:
    """Return what must not have happened."""
    found = not_whole(folder)
    if code is None:
        found.append("did not end")
    elif code not in (0, 1, 2, 3, 130) and not (way == "kill" and code == -signal.SIGKILL):
        found.append(f"exit code {code}")
    if "internal error" in said or "Traceback (most" in said:
        found.append("internal error")
    if code in (1, 2) and not said.strip():
        found.append("no message")
    if any(logs_of(folder).get(name) != digest for name, digest in logs.items()):
        found.append("a log was lost or changed")
    if way != "kill":
        found += [f"left {path.name}" for path in folder.rglob("*.part") if ".mcap" not in path.name]
    return found


def again(words: str, folder: Path) -> list[str]:
    """Make the same call undisturbed in the folder that a disturbed one left; return what is wrong with that."""
    call = Call(words, folder)
    code, said = call.ended(LIMIT_S), call.said()
    refused = code == 2 and " exists" in said  # what the first call had finished is not written over
    return [] if code == 0 or refused else [f"the same call gives {code} afterwards: {said[-300:]}"]


def undisturbed(words: str, original: Path) -> float:
    """Return how long a call takes that nothing disturbs; raises where it does not succeed."""
    folder = original.with_name("undisturbed")
    shutil.copytree(original, folder)
    began = time.monotonic()
    call = Call(words, folder)
    code = call.ended(LIMIT_S)
    long_s = time.monotonic() - began
    assert code == 0, f"{words}: {code}: {call.said()}"
    shutil.rmtree(folder)
    return long_s


def disturb_all(given: argparse.Namespace, original: Path, count: Count) -> None:
    """Disturb each command in each way, and print each fault."""
    chance = random.Random(given.seed)
    for place, (command, words) in enumerate(COMMANDS.items()):
        kills = given.times if given.kills is None else len(range(place, given.kills, len(COMMANDS)))
        ways = {way: kills if way == "kill" else given.times for way in WAYS if given.only in f"{command} {way}"}
        if not any(ways.values()):
            continue
        long_s = undisturbed(words, original)
        print(f"{command}: {long_s:.1f} s undisturbed", flush=True)
        for way, times in ways.items():
            for number in range(times):
                folder = original.with_name(f"{command}_{way}_{number}".replace(" ", "_"))
                shutil.copytree(original, folder)
                code, found = disturb(way, words, folder, chance, long_s, count)
                if code != 0 and number % given.again == 0:
                    count.again += 1
                    found += again(words, folder)
                if found:
                    count.faults += 1
                    print(f"FAULT {command}, {way}: {'; '.join(found)}", flush=True)
                shutil.rmtree(folder)


def main() -> int:
    """Disturb, print each fault and what was counted; 1 where there is a fault."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("times", type=int, nargs="?", default=4)
    parser.add_argument("--kills", type=int, help="of all commands together; without it as often as in the other ways")
    parser.add_argument("--again", type=int, default=4, help="the same call once more after every so many disturbed ones")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="only commands and ways that hold this word")
    given = parser.parse_args()
    count = Count()
    with tempfile.TemporaryDirectory(prefix="disturbed_") as name:
        original = Path(name) / "original"
        original.mkdir()
        prepared(original)
        try:
            disturb_all(given, original, count)
        finally:  # what was counted until Ctrl-C, too
            print(count)
    return int(count.faults > 0)


if __name__ == "__main__":
    sys.exit(main())
