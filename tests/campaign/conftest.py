"""A backend that takes no time."""

from __future__ import annotations

import numpy as np
import pytest

import hjcamp.backends


def quick_test(config: dict, seed: int) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """Return a log that depends on configuration and seed, and on nothing else."""
    noise = np.random.default_rng(seed).normal(0.0, 0.1, 300)
    time = np.arange(300) * 1e-3
    gain = float(config["controller"].get("positive", {}).get("kp", 1.0))
    columns = {"time_s": time, "phase": np.full(300, 3.0), "reference_deg": 100 * time, "arm_deg": 100 * time + noise}
    columns |= {"pressure1_mpa": np.full(300, 0.26), "pressure2_mpa": np.full(300, 0.26), "pump_deg": gain * time}
    return columns, {}


@pytest.fixture
def quick_backend(monkeypatch: pytest.MonkeyPatch) -> None:
    """Put the quick backend in the place of ours."""
    monkeypatch.setattr(hjcamp.backends, "run_test", quick_test, raising=False)
