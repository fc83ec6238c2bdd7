"""The ledger of a benchmark: one JSON line for each finished case, kept over interruptions and committed."""

from __future__ import annotations

import json
import os
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks import ROOT
from benchmarks.hidden_effects.cases import PLAN

CODE = ("hjcamp", "conf", "tests/truth")


def code_version() -> str:
    """Return the last git commit that changed the code a case runs, with a mark where the code differs from it."""

    def git(*arguments: str) -> str:
        call = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
        return call.stdout.strip() if call.returncode == 0 else ""

    try:
        name = git("log", "-1", "--format=%h", "--", *CODE) or "unknown"
        return name + ("+changes" if git("status", "--porcelain", "--", *CODE) else "")
    except FileNotFoundError:
        return "unknown"


@dataclass(frozen=True)
class Ledger:
    """The finished cases in one file, of any version of the code and any effort."""

    path: Path
    plan: int | str = PLAN

    def all_lines(self) -> list[dict[str, Any]]:
        """Return every whole line of this plan; one that an interruption cut short is left out."""
        if not self.path.exists():
            return []
        found = []
        for text in self.path.read_text(encoding="utf-8").splitlines():
            try:
                line = json.loads(text)
            except json.JSONDecodeError:
                continue
            if isinstance(line, dict) and line.get("plan") == self.plan:
                found.append(line)
        return found

    def lines(self, tag: str) -> list[dict[str, Any]]:
        """Return the results of one version of the code, the last one of each case and effort."""
        last = {(line["name"], line["effort"]): line for line in self.all_lines() if line["tag"] == tag}
        return list(last.values())

    def finished(self, tag: str, effort: str) -> set[str]:
        """Return the names of the cases that this version of the code has finished with an effort."""
        return {line["name"] for line in self.lines(tag) if line["effort"] == effort}

    def visibilities(self) -> dict[str, Any]:
        """Return how visible the effects of finished cases are: the truth plant told it, whatever the code was."""
        return {line["name"]: line["visibility"] for line in self.all_lines()}

    def add(self, line: dict[str, Any]) -> None:
        """Append one result and bring it to the disk, behind a line that was cut short."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        torn = self.path.exists() and self.path.stat().st_size > 0 and self.path.read_bytes()[-1:] != b"\n"
        with self.path.open("a", encoding="utf-8") as stream:
            stream.write(("\n" if torn else "") + json.dumps(line, allow_nan=False) + "\n")
            stream.flush()
            os.fsync(stream.fileno())
