"""Finished fits, kept as they come: a search that was stopped goes on where it was."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from threading import Lock
from typing import Any

from hjcamp.json_text import read_json
from hjcamp.storage import write_whole


class Ledger:
    """Results by name in one JSON file, written whole after each; those of another ``question`` do not count."""

    def __init__(self, path: Path | None, question: str) -> None:
        self.path, self.question = path, question
        self._lock = Lock()
        self.found: dict[str, Any] = {}
        if path is not None and path.exists():
            try:
                kept = read_json(path)
                self.found = dict(kept["found"]) if kept["question"] == question else {}
            except (OSError, ValueError, KeyError, TypeError):
                self.found = {}  # damaged: computed anew

    def keep(self, name: str, compute: Callable[[], Any]) -> Any:
        """Return what is known under ``name``, else compute and keep it."""
        with self._lock:
            if name in self.found:
                return self.found[name]
        result = compute()
        with self._lock:
            self.found[name] = result
            if self.path is not None:
                write_whole(self.path, json.dumps({"question": self.question, "found": self.found}, indent=1))
        return result
