"""The serial protocol: messages, what a line that is none does, and every fault over a pseudo-terminal against the committed table."""

from __future__ import annotations

import stat
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lab_of_rigs import Made
from serial_faults import CASES, TEST, WHEN, Case, make_row

from hjcamp import backends
from hjcamp.backends.rig.any_plant.backend import run_on
from hjcamp.backends.virtual_rig.clients import served
from hjcamp.backends.virtual_rig.device import VirtualDevice
from hjcamp.backends.virtual_rig.hidden import hidden_config, hidden_words
from hjcamp.backends.virtual_rig.server import Served, ticket
from hjcamp.configuration.composer import Composer, free
from hjcamp.errors import HjcampError, UsageError
from hjcamp.rigs.line import open_line
from hjcamp.rigs.protocol import BadLine, check_sum, message, numbers, parts_of

TABLE = Path(__file__).parents[2] / "docs" / "rig_faults.md"
ROWS = [(case, list(WHEN)[place % len(WHEN)]) for place, case in enumerate(CASES)]
WORDS = st.text(st.characters(min_codepoint=33, max_codepoint=126, exclude_characters="*"), min_size=1, max_size=20)


@given(WORDS, st.lists(st.floats(allow_nan=False)))
def test_a_message_comes_back_to_the_last_bit(word: str, values: list[float]) -> None:
    found = parts_of(message(word, *values))
    assert found[0] == word and numbers(found[1:]) == values


@given(WORDS, st.lists(st.floats(allow_nan=False), max_size=4), st.data())
def test_a_line_with_one_wrong_byte_is_no_message(word: str, values: list[float], data: st.DataObject) -> None:
    line = message(word, *values)[:-1]
    place = data.draw(st.integers(0, len(line) - 1))
    other = data.draw(st.integers(33, 126).filter(lambda byte: byte != line[place]))
    changed = line[:place] + bytes([other]) + line[place + 1 :]
    try:
        told = parts_of(changed)
    except BadLine:
        return
    # only the case of a hexadecimal digit of the check sum may differ
    assert told == parts_of(line) and changed.upper() == line.upper()


def test_the_check_sum_is_that_of_nmea() -> None:
    assert check_sum(b"GPGLL,4916.45,N,12311.12,W,225444,A,") == 0x1D
    assert message("R") == b"R*52\n"


@pytest.mark.skipif(sys.platform == "win32", reason="no pseudo-terminals")
@pytest.mark.parametrize(("case", "when"), ROWS, ids=[f"{case.kind or case.signal}-{when}" for case, when in ROWS])
def test_row(made: Made, lab: Path, case: Case, when: str) -> None:
    config = Composer().compose([free(line) for line in TEST]).config
    row = make_row(case, when, config, lab)
    assert row.line() in TABLE.read_text(encoding="utf-8").splitlines(), row
    assert case.says in row.message and row.code == (-9 if "KILL" in case.name else 3)


def test_the_table_is_whole() -> None:
    text = TABLE.read_text(encoding="utf-8")
    assert not [(case.name, when) for case in CASES for when in WHEN if f"| {case.name} | {when} | safe within" not in text]


def socket_of(config: Any, **options: Any) -> Served:
    return Served(VirtualDevice(config, token="secret", **options))


def test_a_served_rig_in_lockstep_is_the_plant(made: Made) -> None:
    config = made()
    line = socket_of(config)
    try:
        with ticket(line) as path:
            assert stat.S_IMODE(path.stat().st_mode) == 0o600 or sys.platform == "win32"
            found, notes = run_on(served(config), config, 4)
        assert not path.exists()
    finally:
        line.close()
    there, _ = backends.run_test(made(), 4)
    # the noise is another draw, 2 um of a motion of 5 mm
    assert abs(found["position_m"] - there["position_m"]).max() < 3e-5 and notes["late_samples"] == "0"


def test_who_does_not_know_the_token_or_comes_second_is_refused(made: Made) -> None:
    line = socket_of(made())
    try:
        first, second = open_line(line.port, 0, 2.0), None
        for sent, said in (
            (message("R"), "greet the device first"),
            (message("H", "1", "guess", "1"), "wrong token"),
            (message("W", 1.0), "greet the device first"),
            (message("H", "1", "secret"), "expected H 1 TOKEN SEED"),
            (b"nonsense\n", "no message"),
        ):
            first.write(sent)
            assert said in " ".join(parts_of(first.read_line(time.monotonic() + 5.0)))
        second = open_line(line.port, 0, 2.0)
        assert "another client is at work" in " ".join(parts_of(second.read_line(time.monotonic() + 5.0)))
        first.close()
        second.close()
    finally:
        line.close()


def test_no_rig_is_served(made: Made) -> None:
    with pytest.raises(HjcampError, match=r"no virtual rig of plant axis1 is served .* hjcamp rig serve plant=axis1"):
        served(made())


def test_what_is_hidden_is_drawn_from_the_seed_or_said(made: Made) -> None:
    config = made()
    one, hidden = hidden_config(config, ["spring.stiffness=140", "stribeck_excess"], 3)
    again = hidden_config(config, ["spring.stiffness=140", "stribeck_excess"], 3)[1]
    other = hidden_config(config, ["spring.stiffness=140", "stribeck_excess"], 4)[1]
    assert hidden == again and hidden["spring"] == other["spring"] == {"stiffness": 140.0}
    assert hidden["stribeck_excess"] != other["stribeck_excess"] and one["effects"].keys() == hidden.keys()
    assert not (config.get("effects") or {})
    from hjcamp.known_plants import find_plant

    assert next(iter(hidden_words(find_plant("axis1"), hidden))).startswith("spring: stiffness 140 N/m")
    for text, said in {
        "sprin": "did you mean 'spring'",
        "spring=1": "spring has stiffness, rest_position; say which",
        "spring.stiffness=x": "'x' is no number",
        "spring.stif=1": "did you mean 'stiffness'",
        "spring.stiffness": "give it as spring.stiffness=VALUE",
        "spring.stiffness=nan": "a finite number|a number from",
    }.items():
        with pytest.raises(UsageError, match=said):
            hidden_config(config, [text], 1)
