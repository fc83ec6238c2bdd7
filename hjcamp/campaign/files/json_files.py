"""The JSON files of a run folder, and what to say where its disk refuses."""

from __future__ import annotations

import json
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

from hjcamp.storage import disk_errors, write_whole


def write_json(path: Path, content: Any) -> None:
    """Write plain values as JSON, whole or not at all; raises ``OSError``."""
    write_whole(path, json.dumps(content, indent=1, ensure_ascii=False) + "\n")


def run_errors(folder: Path) -> AbstractContextManager[None]:
    """Turn a full or read-only disk into one message that says how the run in ``folder`` goes on."""
    return disk_errors(folder, f"free space, then go on with: hjcamp resume {folder}", "choose another folder with run_dir=DIR")
