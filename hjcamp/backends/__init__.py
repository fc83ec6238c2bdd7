"""Backends: what turns a resolved configuration and a seed into the columns of one test log."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import unknown

BACKENDS = ("simulation",)


def run_test(config: Mapping[str, Any], seed: int) -> tuple[dict[str, NDArray[np.float64]], dict[str, str]]:
    """Run one test on the configured backend; return the columns of its log and further metadata."""
    name = config["backend"]["name"]
    if name not in BACKENDS:
        raise unknown("backend", name, BACKENDS)
    backend = importlib.import_module(f"hjcamp.backends.{name}")
    columns, notes = backend.run_test(config, seed)
    return columns, notes
