"""Disturbs every long command: kill -9 at random moments, Ctrl-C twice, little memory, few files, a full disk.

    python tests/cli/disturbed_commands.py 10 [--only WORD] [--seed 1]

so many times each command in each way. What must never happen: an internal error, a traceback, a log that was changed,
a file under its final name that is not whole, a part of a file left by a call that was not killed, no end after Ctrl-C.
"""

from __future__ import annotations

import argparse
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
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from hjcamp.errors import UsageError
from hjcamp.records.read import read_log
from hjcamp.yaml_file import read_yaml

BAD_CALLS = Path(__file__).with_name("bad_calls.py")
COMMANDS = {
    "run": "run campaign=controllers conditions=[ramp_pos__pid] repetitions=3 workers=1 run_dir=new",
    "resume": "resume run", "report": "report run", "compare": "compare run",
    "diagnose": "diagnose run --effort quick --only leakage",
    "add": "add leakage run --as with_leakage", "next": "next run --effort quick --tests 1 --as then",
    "import": "import table.csv --map map.yaml",
    "export": "log export run --as csv", "verify": "log verify run", "paper": "paper run --as text --formats svg",
    "effects": "effects test my_spring", "calibrate": "calibrate run --as mine", "tune": "tune controller=pid --as mine",
}  # fmt: skip
LONGEST_S, OUT_S = 20.0, 60.0
MEMORY_MB = (150, 300, 600, 1200, 2500)
FILES = (12, 16, 20, 30, 40)  # with fewer the interpreter itself does not begin
DISK_BYTES = (0, 100, 4_000, 50_000, 300_000)


def limited(kind: int, value: int) -> Callable[[], None]:
    """Return what a process does before the call: it takes a limit of the system, where a full disk is one of no signal."""

    def before() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(kind, (value, value))

    return before


def started(words: str, folder: Path, before: Callable[[], None] | None = None) -> subprocess.Popen[str]:
    """Begin a call in a folder, in a group of its own."""
    command = [sys.executable, "-m", "hjcamp", *words.split()]
    return subprocess.Popen(
        command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
        start_new_session=True, preexec_fn=before,
    )  # fmt: skip


def logs_of(folder: Path) -> dict[str, str]:
    """Return the hash of each log that was there before."""
    return {str(path): hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted((folder / "run").rglob("*.mcap"))}


def not_whole(folder: Path) -> list[str]:
    """Return the files under a final name that cannot be read."""
    found = []
    for path in folder.rglob("*"):
        try:
            if path.is_symlink() or not path.is_file() or "tour" in path.parts:
                continue
            if path.suffix == ".mcap":
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


def disturb(way: str, words: str, folder: Path, chance: random.Random) -> tuple[int | None, str]:
    """Make one call and disturb it; return its code (None: it did not end) and what it said."""
    before = None
    if way == "memory":
        before = limited(resource.RLIMIT_AS, chance.choice(MEMORY_MB) * 2**20)
    elif way == "files":
        before = limited(resource.RLIMIT_NOFILE, chance.choice(FILES))
    elif way == "disk":
        before = limited(resource.RLIMIT_FSIZE, chance.choice(DISK_BYTES))
    process = started(words, folder, before)
    if way in ("kill", "interrupt"):
        try:
            said, _ = process.communicate(timeout=chance.uniform(0.05, LONGEST_S))
            return process.returncode, said
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL if way == "kill" else signal.SIGINT)
            if way == "interrupt":
                time.sleep(chance.uniform(0.0, 0.5))
                if process.poll() is None:
                    os.killpg(process.pid, signal.SIGINT)
    try:
        said, _ = process.communicate(timeout=OUT_S if way in ("kill", "interrupt") else 10 * OUT_S)
        return process.returncode, said
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        return None, process.communicate()[0]


def faults(way: str, code: int | None, said: str, folder: Path, logs: dict[str, str]) -> list[str]:
    """Return what must not have happened."""
    found = not_whole(folder)
    if code is None:
        found.append("did not end")
    elif code not in (0, 1, 2, 3, 130) and not (way == "kill" and code == -signal.SIGKILL):
        found.append(f"exit code {code}")
    if "internal error" in said or "Traceback (most" in said:
        found.append("internal error")
    if any(logs_of(folder).get(name) != digest for name, digest in logs.items()):
        found.append("a log was lost or changed")
    if way != "kill":
        found += [f"left {path.name}" for path in folder.rglob("*.part") if ".mcap" not in path.name]
    return found


def main() -> int:
    """Disturb, print each fault and what was counted; 1 where there is a fault."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("times", type=int, nargs="?", default=4)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="only commands and ways that hold this word")
    given = parser.parse_args()
    chance = random.Random(given.seed)
    codes: Counter[str] = Counter()
    bad = 0
    with tempfile.TemporaryDirectory(prefix="disturbed_") as name:
        original = Path(name) / "original"
        original.mkdir()
        subprocess.run([sys.executable, str(BAD_CALLS), "--prepare", str(original)], check=True, stdout=subprocess.DEVNULL)
        (original / "loop").unlink()
        for command, words in COMMANDS.items():
            for way in ("kill", "interrupt", "memory", "files", "disk"):
                for number in range(given.times if given.only in f"{command} {way}" else 0):
                    folder = Path(name) / f"{command}_{way}_{number}"
                    shutil.copytree(original, folder)
                    logs = logs_of(folder)
                    code, said = disturb(way, words, folder, chance)
                    codes[f"{way} {code}"] += 1
                    found = faults(way, code, said, folder, logs)
                    if found:
                        bad += 1
                        print(f"FAULT {command}, {way}: {'; '.join(found)}: {' '.join(said.split())[-300:]}", flush=True)
                    shutil.rmtree(folder)
    print(
        f"{sum(codes.values())} disturbed calls: {', '.join(f'{count} {key}' for key, count in sorted(codes.items()))}; {bad} faults"
    )
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
