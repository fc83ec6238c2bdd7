"""Kills campaigns with kill -9 at random moments, goes on, and compares; arguments: kills, then backends.

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

from hjcamp import backends, cli
from hjcamp.configuration.composer import Composer
from hjcamp.records.read import read_log

LINES = ("campaign=controllers", "conditions=ramp_pos__pid", "repetitions=3", "workers=1")
BACKENDS = ("simulation", "nidaqmx")
LONGEST_S = 3.0
PATIENCE_S = 60.0


def load() -> None:
    """Load what all processes need. Not polars: it starts threads, and those do not live through a fork."""
    composer = Composer()
    for backend in BACKENDS:
        for controller in ("pid", "ffwd_pid"):
            lines = ["trajectory=ramp_pos", f"controller={controller}", f"backend={backend}"]
            backends.run_test(composer.compose(lines).config, 1)
    assert "polars" not in sys.modules


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
    """Wait for a process and return its exit code; raises where it does not end."""
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.01)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    raise TimeoutError(f"a call did not end within {PATIENCE_S:g} s: {Path('child.txt').read_text()}")


def whole(folder: Path) -> dict[str, str]:
    """Return the hash of each log under a final name; raises where one is not whole."""
    hashes = {}
    for path in sorted(folder.rglob("*.mcap")):
        read_log(path)
        hashes[path.relative_to(folder).as_posix()] = hashlib.sha256(path.read_bytes()).hexdigest()
    return hashes


def contents(folder: Path) -> dict[str, str]:
    """Return the hash of the samples of each log; their metadata name the commit, which may change meanwhile."""
    hashes = {}
    for path in sorted(folder.rglob("*.mcap")):
        digest = hashlib.sha256()
        for name, values in sorted(read_log(path).columns.items()):
            digest.update(name.encode() + values.tobytes())
        hashes[path.relative_to(folder).as_posix()] = digest.hexdigest()
    return hashes


def tables(folder: Path) -> dict[str, bytes]:
    """Return the tables of a run."""
    return {path.name: path.read_bytes() for path in sorted((folder / "tables").glob("*.csv"))}


def kill_backend(backend: str, kills: int, chance: random.Random) -> dict[str, int]:
    """Spend ``kills`` kills on campaigns of one backend; return what was counted."""
    lines = [*LINES, f"backend={backend}"]
    assert finish(start(["run", *lines, f"run_dir=undisturbed_{backend}"])) == 0, Path("child.txt").read_text()
    undisturbed = Path(f"undisturbed_{backend}")
    expected, logs = tables(undisturbed), contents(undisturbed / "logs")
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
        assert contents(folder / "logs") == logs, f"{folder}: other logs than in the undisturbed run"
        assert tables(folder) == expected, f"{folder}: other tables than in the undisturbed run"
        counted["campaigns"] += 1
    return counted


def main(kills: int = 200, chosen: Sequence[str] = BACKENDS, seed: int = 1) -> int:
    """Kill, and print what was counted."""
    chance = random.Random(seed)
    before = os.getcwd()
    load()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            for backend in chosen:
                print(f"{backend}: {kill_backend(backend, kills // len(chosen), chance)}, nothing lost", flush=True)
        finally:
            os.chdir(before)
    return 0


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 200, sys.argv[2:] or BACKENDS))
