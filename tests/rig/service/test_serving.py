"""Serving a virtual rig: addresses, ports, and what is said about them."""

from __future__ import annotations

import re
import socket
import subprocess
from pathlib import Path
from typing import Any

import pytest
from processes import CALL, connection, program, served_rig, wait_until

from hjcamp import cli
from hjcamp.errors import HjcampError
from hjcamp.plants.pump_joint.rig import connection as rig_connection
from hjcamp.plants.pump_joint.rig.tasks import RigTasks
from hjcamp.plants.pump_joint.rig.wiring import read_wiring
from hjcamp.plants.pump_joint.virtual_rig.server import check_free, client_address


def test_a_port_in_use_is_one_message(tmp_path: Path) -> None:
    with served_rig(tmp_path) as (_, port):
        again = subprocess.run(
            [*CALL, "rig", "serve", "--address", f"localhost:{port}"],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
    assert again.returncode == 1
    lines = again.stderr.splitlines()
    assert len(lines) == 1, lines
    assert f"another `hjcamp rig serve`, uses the port; end it, or take another one: --address localhost:{port + 1}" in lines[0]


@pytest.mark.parametrize(
    ("address", "words"),
    [("192.0.2.7:31763", "serve on localhost"), ("no.such.host.invalid:31763", "serve on localhost:31763")],
)
def test_an_address_that_is_not_ours(address: str, words: str) -> None:
    with pytest.raises(HjcampError, match=words):
        check_free(address)


def test_everybody_is_warned_about_each_time(tmp_path: Path) -> None:
    arguments = ["rig", "serve", "--address", "0.0.0.0:0", "--anybody"]
    said = tmp_path / "out.txt"
    for _ in range(2):
        with program(arguments, tmp_path) as process:
            wait_until(lambda: "use it with" in said.read_text(), process)
        warning, advice = (tmp_path / "err.txt").read_text(), said.read_text()
        assert "WARNING: listening on 0.0.0.0:" in warning and "without a password" in warning
        assert "0.0.0.0" not in advice
        assert f"'{socket.gethostname()}:" in advice


def test_the_address_for_clients() -> None:
    assert client_address("localhost:0", 5) == "localhost:5"
    assert client_address("[::]:0", 5) == f"{socket.gethostname()}:5"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--rate", "0.1"], "only with --real-time"),
        (["--real-time", "--rate", "0"], "from 0.01 to 1"),
        (["--real-time", "--rate", "-1"], "from 0.01 to 1"),
        (["--real-time", "--rate", "nan"], "from 0.01 to 1"),
        (["--address", "*:31763", "--anybody"], "HOST:PORT"),
    ],
)
def test_refused(arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["rig", "serve", *arguments]) == 2
    assert words in capsys.readouterr().err


def test_the_server_says_when_its_watchdog_trips(tmp_path: Path, compose: Any) -> None:
    with served_rig(tmp_path, "--real-time", "--rate", "0.1") as (process, port):
        config, said = compose(connection(port)), tmp_path / "out.txt"
        way = rig_connection.connect(config, 1)
        tasks = RigTasks(read_wiring(config), way, 0.1)
        tasks.read()
        tasks.write(0.0, 0.0, 0.0, 1e-3)
        wait_until(lambda: "the watchdog has tripped" in said.read_text(), process)
        line = next(line for line in said.read_text().splitlines() if "tripped" in line)
        assert re.search(r"tripped, [1-5] samples after its last reset; .*Dev1/ao1 0 V", line), line
        assert "in real time at 0.1 of the clock" in said.read_text()
        tasks.close()
        way.close()
