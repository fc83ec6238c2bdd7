"""A device server that stops answering in the middle of a test: the client ends, in time, and says what it left."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import pytest
from processes import Cable, connection, program, served_rig, wait_until

from hjcamp.backends.rig.deadline import ANSWER_S, GRACE_S
from hjcamp.plants.pump_joint.virtual_rig.device import IDLE_S
from hjcamp.records.recover import recover_log

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="SIGSTOP")
READ_TIMEOUT_S = 0.1
LOADED_S = 6.0  # for what a loaded computer does besides: it is far less than a call that never ends
# The command phase is soon reached.
SOON = ("procedure.adjustment.enabled=false", "procedure.rest_ms=20")
LINES = ("backend=nidaqmx", "rig=virtual", "trajectory=ramp_pos", *SOON, "repetitions=2", "run_dir=run")
OUTPUTS = r"pump Dev1/ao0 \S+ V, preload Dev1/ao1 \S+ V, dither Dev1/ao2 \S+ V"


@dataclass
class Test:
    """A run in the middle of its first test."""

    server: subprocess.Popen[str]
    client: subprocess.Popen[str]
    cable: Cable
    folder: Path

    __test__ = False

    def end(self, within: float) -> str:
        """Wait for the client, which must have made the outputs known and closed its log; return what it said."""
        start = time.monotonic()
        assert self.client.wait(60.0) == 3, self.said()
        assert time.monotonic() - start < within, self.said()
        part = next(self.folder.rglob("*.mcap.part"))
        kept = recover_log(part, self.folder / "recovered.mcap").kept
        assert kept > 100, part
        return self.said()

    def said(self) -> str:
        """Return what the client said on both of its streams, without line ends."""
        return re.sub(r"\s+", " ", "".join((self.folder / name).read_text() for name in ("out.txt", "err.txt")))


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[subprocess.Popen[str], int]]:
    """One server for all tests; each leaves it running."""
    with served_rig(tmp_path_factory.mktemp("server")) as found:
        yield found


@pytest.fixture
def running(tmp_path: Path, server: tuple[subprocess.Popen[str], int]) -> Iterator[Test]:
    with ExitStack() as stack:
        process, port = server
        stack.callback(process.send_signal, signal.SIGCONT)
        time.sleep(IDLE_S)  # the client of the test before counts as there for so long
        cable = Cable(port)
        stack.callback(cable.close)
        folder = tmp_path / "client"
        client = stack.enter_context(program(["run", *LINES, connection(cable.port)], folder))
        # The file under this name begins with the command phase.
        wait_until(lambda: any(".before" not in path.name for path in folder.rglob("*.mcap.part")), client)
        yield Test(process, client, cable, folder)


def test_the_server_is_stopped(running: Test) -> None:
    running.server.send_signal(signal.SIGSTOP)
    said = running.end(within=READ_TIMEOUT_S + ANSWER_S + GRACE_S + LOADED_S)
    assert re.search(r"(reading|writing) failed: the device server did not answer within 2(\.1)? s", said), said
    assert re.search(rf"THE OUTPUTS COULD NOT BE WRITTEN \(.* last written: {OUTPUTS}\)", said), said
    assert "watchdog makes them safe 5 ms after the last write" in said


@pytest.mark.study
def test_the_cable_is_cut(running: Test) -> None:
    running.cable.cut()
    said = running.end(within=READ_TIMEOUT_S + ANSWER_S + GRACE_S + LOADED_S)
    assert re.search(rf"COULD NOT BE WRITTEN \(.* last written: {OUTPUTS}\)", said), said


@pytest.mark.study
@pytest.mark.parametrize(
    "numbers",
    [(signal.SIGTERM,), (signal.SIGINT, signal.SIGINT)],
    ids=["sigterm", "ctrl_c"],
)
def test_a_stop_is_heard_while_the_server_hangs(running: Test, numbers: tuple[int, ...]) -> None:
    running.server.send_signal(signal.SIGSTOP)
    for number in numbers:
        time.sleep(0.1)
        os.kill(running.client.pid, number)
    said = running.end(within=READ_TIMEOUT_S + ANSWER_S + GRACE_S + LOADED_S)
    assert re.search(OUTPUTS, said), said


@pytest.mark.study
def test_a_server_that_goes_on_in_time_obeys(running: Test) -> None:
    # The read is given up after 2.1 s; the outputs are written in the 0.8 s that are left.
    running.server.send_signal(signal.SIGSTOP)
    time.sleep(READ_TIMEOUT_S + ANSWER_S + 0.25 * GRACE_S)
    running.server.send_signal(signal.SIGCONT)
    said = running.end(within=10.0)
    assert "the device server did not answer" in said
    assert "the rig was made safe" in said
    assert "COULD NOT" not in said


@pytest.mark.study
def test_the_server_is_killed(running: Test) -> None:
    # The last test of this file: nobody needs the server after it.
    running.server.kill()
    said = running.end(within=GRACE_S + LOADED_S)
    assert re.search(rf"COULD NOT BE WRITTEN \(.* last written: {OUTPUTS}\)", said), said
