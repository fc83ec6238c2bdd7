"""A few kill -9 at random moments of campaigns on the simulator and on virtual rigs; many: kill_campaign.py."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).with_name("kill_campaign.py")


@pytest.mark.study
@pytest.mark.skipif(sys.platform == "win32", reason="fork and kill -9")
def test_kills(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(SCRIPT.parents[2]))
    monkeypatch.delenv("HJCAMP_CONF", raising=False)
    done = subprocess.run([sys.executable, str(SCRIPT), "6"], cwd=tmp_path, capture_output=True, text=True, timeout=900)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("nothing lost") == 3
