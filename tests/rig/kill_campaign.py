"""Kills campaigns with kill -9 at random moments, goes on, and compares: python tests/rig/kill_campaign.py [kills]

After each kill every file under a final name must be whole, and what was finished must still be there, byte for byte.
When a campaign is complete its tables must be those of a run that nobody disturbed. Half of the kills hit the
simulator, half the virtual rig. Processes are forked from one that has everything loaded, so that the kills fall on
the work and not on imports.
"""

from __future__ import annotations

import hashlib
import os
import random
import signal
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from hjcamp import cli
from hjcamp.records.read import read_log

LINES = ("campaign=controllers", "conditions=ramp_pos*", "repetitions=3", "workers=1")
BACKENDS = ("simulation", "nidaqmx")
LONGEST_S = 3.0


def start(arguments: Sequence[str]) -> int:
    """Fork a process that makes one call of the command line; return its number."""
    child = os.fork()
    if child == 0:
        os.setsid()
        quiet = os.open("child.txt", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(quiet, 1)
        os.dup2(quiet, 2)
        os._exit(cli.run(list(arguments)))
    return child


def finish(child: int) -> int:
    """Wait for a process and return its exit code."""
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def whole(folder: Path) -> dict[str, str]:
    """Return the hash of each log under a final name; raises where one is not whole."""
    hashes = {}
    for path in sorted(folder.rglob("*.mcap")):
        read_log(path)
        hashes[path.relative_to(folder).as_posix()] = hashlib.sha256(path.read_bytes()).hexdigest()
    return hashes


def tables(folder: Path) -> dict[str, bytes]:
    """Return the tables of a run."""
    return {path.name: path.read_bytes() for path in sorted((folder / "tables").glob("*.csv"))}


def kill_backend(backend: str, kills: int, chance: random.Random) -> dict[str, int]:
    """Spend ``kills`` kills on campaigns of one backend; return what was counted."""
    lines = [*LINES, f"backend={backend}"]
    assert cli.run(["run", *lines, f"run_dir=undisturbed_{backend}"]) == 0
    undisturbed = Path(f"undisturbed_{backend}")
    expected, logs = tables(undisturbed), whole(undisturbed / "logs")
    counted = {"kills": 0, "campaigns": 0, "while_at_work": 0, "halves": 0}
    while counted["kills"] < kills:
        folder = Path(f"{backend}_{counted['campaigns']}")
        kept: dict[str, str] = {}
        code = -1
        while code != 0:
            go_on = (folder / "plan.json").exists() and chance.random() < 0.5
            child = start(["resume", str(folder)] if go_on else ["run", *lines, f"run_dir={folder}"])
            if counted["kills"] < kills:
                time.sleep(chance.uniform(0.0, LONGEST_S))
                counted["kills"] += 1
                os.kill(child, signal.SIGKILL)
            code = finish(child)
            counted["while_at_work"] += code == -signal.SIGKILL
            assert code in (0, -signal.SIGKILL), Path("child.txt").read_text()
            now = whole(folder / "logs") if folder.exists() else {}
            counted["halves"] += len(list(folder.rglob("*.mcap*.part")))
            for name, digest in kept.items():
                assert now.get(name) == digest, f"{folder / name} was lost or changed"
            kept = now
        assert kept == logs, f"{folder}: other logs than in the undisturbed run"
        assert tables(folder) == expected, f"{folder}: other tables than in the undisturbed run"
        counted["campaigns"] += 1
    return counted


def main(kills: int = 200, seed: int = 1) -> int:
    """Kill, and print what was counted."""
    chance = random.Random(seed)
    before = os.getcwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            for backend in BACKENDS:
                print(f"{backend}: {kill_backend(backend, kills // len(BACKENDS), chance)}, nothing lost", flush=True)
        finally:
            os.chdir(before)
    return 0


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 200))
