"""Kills campaigns with kill -9 at random moments, goes on, and compares; arguments: kills, then targets.

After each kill every file under a final name must be whole, and what was finished must still be there, byte for byte.
When a campaign is complete its tables must be those of a run that nobody disturbed. Targets: the joint on the simulator
and on its virtual rig, an axis on the serial protocol over a pseudo-terminal. Kills are shared evenly and fall within the
length of an undisturbed call; processes are forked from one that has everything loaded, so that they hit the work and not imports.
"""

from __future__ import annotations

import faulthandler
import hashlib
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from hjcamp import backends, cli
from hjcamp.backends.plant_simulation import prepare
from hjcamp.backends.rig.any_plant.control import PlantControl
from hjcamp.commands.shared.plant_template import TEMPLATE
from hjcamp.configuration.composer import Composer, free
from hjcamp.records.read import read_log

JOINT = ("campaign=controllers", "conditions=ramp_pos__pid", "repetitions=3", "workers=1")
MOTION = (
    "plant=axis1",
    "controller=plain_pid",
    "controller.kp=400",
    "controller.kd=30",
    "trajectory=cycloid",
    "trajectory.amplitude_m=0.005",
)
AXIS = (*MOTION, "trajectory.rise_time=0.8", "trajectory.duration=1", "repetitions=3", "workers=1")
TARGETS = {
    "simulation": (*JOINT, "backend=simulation"),
    "nidaqmx": (*JOINT, "backend=nidaqmx"),
    "serial": (*AXIS, "backend=rig", "rig=virtual"),
}
PATIENCE_S = 600.0


def load(targets: Sequence[str]) -> None:
    """Load what all processes need. Not polars: it starts threads, and those do not live through a fork."""
    composer = Composer()
    for backend in ("simulation", "nidaqmx"):
        for controller in ("pid", "ffwd_pid") if backend in targets else ():
            lines = ["trajectory=ramp_pos", f"controller={controller}", f"backend={backend}"]
            backends.run_test(composer.compose(lines).config, 1)
    if "serial" in targets:
        PlantControl(prepare(composer.compose([free(line) for line in MOTION]).config, 1))
    assert "polars" not in sys.modules


@contextmanager
def served(targets: Sequence[str]) -> Iterator[None]:
    """Serve the axis over a pseudo-terminal, by a process of its own, where it is a target; its address stands in this folder."""
    if "serial" not in targets:
        yield
        return
    os.environ["XDG_STATE_HOME"] = os.getcwd()
    Path("plants").mkdir()
    noisy = 'Measured("encoder", of="position", noise=2e-6)'
    Path("plants/axis1.py").write_text(TEMPLATE.format(title="Axis1").replace('Measured("encoder", of="position")', noisy))
    words = [sys.executable, "-m", "hjcamp", "rig", "serve", "plant=axis1", "--pty"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as server:
        try:
            assert server.stdout is not None and "is served at" in server.stdout.readline()
            yield
        finally:
            server.terminate()


def start(arguments: Sequence[str]) -> int:
    """Fork a process that makes one call of the command line; return its number."""
    child = os.fork()
    if child == 0:
        os.setsid()
        quiet = os.open("child.txt", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(quiet, 1)
        os.dup2(quiet, 2)
        faulthandler.register(signal.SIGUSR1, file=2)
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
    os.kill(child, signal.SIGUSR1)  # it says where each of its threads is
    time.sleep(1.0)
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


def kill_target(backend: str, kills: int, chance: random.Random) -> dict[str, int]:
    """Spend ``kills`` kills on campaigns of one target; return what was counted."""
    lines = TARGETS[backend]
    longest = 0.0
    for again in ("_first", ""):  # what the first call loads is no part of the length
        begun = time.monotonic()
        assert finish(start(["run", *lines, f"run_dir=undisturbed_{backend}{again}"])) == 0, Path("child.txt").read_text()
        longest = time.monotonic() - begun
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
                time.sleep(chance.uniform(0.0, longest))
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


def main(kills: int = 300, chosen: Sequence[str] = tuple(TARGETS), seed: int = 1) -> int:
    """Kill, and print what was counted."""
    chance = random.Random(seed)
    before = os.getcwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            with served(chosen):
                load(chosen)
                for target in chosen:
                    print(f"{target}: {kill_target(target, kills // len(chosen), chance)}, nothing lost", flush=True)
        finally:
            os.chdir(before)
    return 0


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 300, sys.argv[2:] or tuple(TARGETS)))
