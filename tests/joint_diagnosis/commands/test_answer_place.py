"""Where the answer for programs goes: a file, or standard output with nothing beside it."""

from __future__ import annotations

import json
import os
import stat
import sys
from pathlib import Path

import pytest
from discrepancy_answers import Call


@pytest.mark.parametrize("name", ["-", "/dev/stdout"])
def test_standard_output_holds_the_answer_alone(call: Call, leak: Path, tmp_path: Path, name: str) -> None:
    if name != "-" and not Path(name).exists():
        pytest.skip(f"no {name} here")
    before = sys.stdout
    answer = call("compare", *sorted(leak.glob("ramp_hold_r*.mcap")), "--json", name)
    assert answer.code == 0, answer.err
    assert json.loads(answer.out)["models"][0]["error"]["arm_deg"]
    assert "replay driven by the measured pump" in answer.err
    assert sys.stdout is before
    assert not Path("-").exists() and Path("compare").is_dir()
    answer = call("compare", *sorted(leak.glob("ramp_hold_r*.mcap")), "--json", os.devnull)
    assert answer.code == 2 and "this is a device; give a file, or - for standard output" in answer.err
    assert stat.S_ISCHR(os.stat(os.devnull).st_mode)
