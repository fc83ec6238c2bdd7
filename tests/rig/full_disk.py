"""One run on the virtual rig whose disk becomes full in the middle of its first test; argument: limit or disk.

``limit``: the system allows no larger file (RLIMIT_FSIZE). ``disk``: the file system that the working directory is in
is filled to its last byte. Prints what a user and the rig saw, as JSON.
"""

from __future__ import annotations

import contextlib
import io
import json
import resource
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from hjcamp import cli
from hjcamp.plants.pump_joint.rig import connection as rig_connection
from hjcamp.plants.pump_joint.rig.control import RigControl
from hjcamp.plants.pump_joint.rig.journal import Journal
from hjcamp.records.recover import recover_log

FULL_AT = 1500
RUN = Path("run")
CALL = ("run", "backend=nidaqmx", "trajectory=cycloid_pos", "repetitions=2", f"run_dir={RUN}")


def fill() -> None:
    """Write until nothing more fits."""
    with open("filler", "wb", buffering=0) as stream, contextlib.suppress(OSError):
        while True:
            stream.write(b"0" * 512)


def main(kind: str) -> None:
    """Run, fill, look."""
    device = rig_connection.in_process_channel().device
    step = RigControl.step

    def disturbed(self: RigControl, *arguments: float) -> Any:
        if device.tests == 1 and device.samples == FULL_AT:
            if kind == "disk":
                fill()
            else:
                size = next(RUN.rglob("*.mcap.part")).stat().st_size
                resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))
        return step(self, *arguments)

    add = Journal.add

    def add_and_wait(self: Journal, held: int) -> None:
        # Virtual time can outrun the writing thread: it writes what there is before the disk is full, and meets that.
        add(self, held)
        if device.tests == 1 and device.samples in (FULL_AT - 1, FULL_AT, FULL_AT + 1):
            self._wake.set()
            until = time.monotonic() + (0.5 if device.samples < FULL_AT else 3.0)
            while self.problem is None and time.monotonic() < until:
                time.sleep(0.001)

    RigControl.step = disturbed  # type: ignore[method-assign]
    Journal.add = add_and_wait  # type: ignore[method-assign]
    said = io.StringIO()
    with contextlib.redirect_stderr(said):
        code = cli.run([*CALL, "--keep-going"])
    answer = {"code": code, "said": said.getvalue(), "samples": device.samples, "tests": device.tests}
    answer["volts"] = device.volts
    answer["final"] = len(list(RUN.rglob("*.mcap")))
    with tempfile.TemporaryDirectory() as elsewhere:
        if kind == "limit":
            resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
        answer["kept"] = recover_log(next(RUN.rglob("*.mcap.part")), Path(elsewhere) / "recovered.mcap").kept
    if kind == "disk":
        Path("filler").unlink()
    answer["resumed"] = cli.run(["resume", str(RUN)])
    answer["whole"] = len(list(RUN.rglob("*.mcap")))
    print("\n" + json.dumps(answer))


if __name__ == "__main__":
    main(sys.argv[1])
