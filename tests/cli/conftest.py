"""Commands called in an empty folder, on a backend that takes no time."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

import hjcamp.backends
from hjcamp import cli


class Answer(NamedTuple):
    """What a call of the command line gave."""

    code: int
    out: str
    err: str


Call = Callable[..., Answer]


def quick_test(config: dict, seed: int) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """Return a log that depends on the seed alone."""
    noise = np.random.default_rng(seed).normal(0.0, 0.1, 1500)
    time = np.arange(1500) * 1e-3
    columns = {"time_s": time, "phase": np.full(1500, 3.0), "reference_deg": 60 * time, "arm_deg": 60 * time + noise}
    pressure = 0.26 + 0.01 * noise
    columns |= {"pressure1_mpa": pressure, "pressure2_mpa": pressure, "pump_deg": 510 * time}
    return columns, {}


@pytest.fixture(scope="session")
def quick() -> Callable[..., tuple[dict[str, np.ndarray], dict[str, str]]]:
    """Return the backend of the tests that `call` makes."""
    return quick_test


@pytest.fixture
def call(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Call:
    """Return the function that calls ``hjcamp ARGUMENTS`` in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("HJCAMP_CONF", raising=False)
    monkeypatch.setenv("HYDRA_FULL_ERROR", "1")
    monkeypatch.setattr(hjcamp.backends, "run_test", quick_test, raising=False)

    def answer(*arguments: str) -> Answer:
        capfd.readouterr()
        code = cli.run(list(arguments))
        out, err = capfd.readouterr()
        return Answer(code, out, err)

    return answer
