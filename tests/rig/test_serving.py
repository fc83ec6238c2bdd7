"""Serving a virtual rig: addresses, ports, and what is said about them."""

from __future__ import annotations

import socket
import subprocess
from pathlib import Path

import pytest
from processes import CALL, program, served_rig, wait_until

from hjcamp import cli
from hjcamp.backends.virtual_rig.server import check_free, client_address
from hjcamp.errors import HjcampError


def test_a_port_in_use_is_one_message(tmp_path: Path) -> None:
    with served_rig(tmp_path) as (_, port):
        again = subprocess.run(
            [*CALL, "rig", "serve", "--address", f"localhost:{port}"],
            cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False,
        )  # fmt: skip
    assert again.returncode == 1
    lines = again.stderr.splitlines()
    assert len(lines) == 1, lines
    assert (
        f"another `hjcamp rig serve`, uses the port; end it, or take another one: --address localhost:{port + 1}"
        in lines[0]
    )


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
        (["--address", "*:31763", "--anybody"], "HOST:PORT"),
    ],
)
def test_refused(arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["rig", "serve", *arguments]) == 2
    assert words in capsys.readouterr().err
