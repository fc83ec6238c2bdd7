"""What the page's process knows of the run, and what a browser has not seen of it yet."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hjcamp.live.history import History
from hjcamp.live.messages import columns_of


@dataclass
class Seen:
    """What one browser has: versions of the run and of the test, and the number of rows."""

    run: int = -1
    test: int = -1
    rows: int = 0
    limits: int = -1


class State:
    """The run and its test in hand, told by messages and asked by browsers; each method may be called from any thread."""

    def __init__(self) -> None:
        self.changed = threading.Condition()
        self.ended = False
        self.run: dict[str, Any] = {"conditions": {}, "done": 0, "failed": 0, "total": 0}
        self._run_version = 0
        self._test: dict[str, Any] = {}
        self._test_version = 0
        self._history: History | None = None
        self._samples_version = 0

    def take(self, head: dict[str, Any], block: bytes) -> Path | None:
        """Take in one message; returns a log whose samples are wanted, because none came while it was made."""
        with self.changed:
            wanted = getattr(self, f"_on_{head['kind']}")(head, block)
            self.changed.notify_all()
        return wanted if isinstance(wanted, Path) else None

    def show_log(self, head: dict[str, Any], columns: dict[str, Any], first: int, period: float) -> None:
        """Show a finished test from its log."""
        with self.changed:
            self._begin({**head["test"], "period": period})
            assert self._history is not None
            self._history.add(columns, 0, first)
            self._samples_version += 1
            self.changed.notify_all()

    def news(self, seen: Seen) -> list[dict[str, Any]]:
        """Return what a browser has not seen, as plain values, and note in ``seen`` that it has; call it with ``changed``."""
        found: list[dict[str, Any]] = []
        history = self._history
        if seen.run != self._run_version:
            seen.run = self._run_version
            found.append({"kind": "run", "ended": self.ended, **self.run})
        test = self._test_version + (history.serial if history else 0)
        if seen.test != test:
            seen.test, seen.rows, seen.limits = test, 0, -1
            found.append({"kind": "test", **self._test})
        if history is not None and (seen.rows < len(history.rows) or seen.limits != self._samples_version):
            fresh = history.rows[seen.rows :]
            seen.rows, seen.limits = len(history.rows), self._samples_version
            found.append(
                {"kind": "rows", "rows": fresh, "first": history.first, "phase": history.phase,
                 "samples": history.samples, "limits": history.limits_shown()}
            )  # fmt: skip
        return found

    def waits(self, seen: Seen) -> bool:
        """Return whether there is nothing new for a browser; call it with ``changed``."""
        test = self._test_version + (self._history.serial if self._history else 0)
        return (seen.run, seen.test, seen.limits) == (self._run_version, test, self._samples_version)

    def end(self) -> None:
        """Note that nothing more will come: the run ended, or its process is gone."""
        with self.changed:
            self.ended = True
            if self.run.get("state") == "running":
                self.run |= {
                    "state": "stopped",
                    "words": "the process of the run is gone; hjcamp resume goes on with it",
                }
            self._run_version += 1
            self.changed.notify_all()

    def _begin(self, test: dict[str, Any]) -> None:
        self._test = test
        # more than any one test's history was ever joined
        self._test_version += 1000
        names = [one["name"] for one in test["channels"]]
        self._history = History(names, test["period"], test["watches"])

    def _on_run(self, head: dict[str, Any], block: bytes) -> None:
        self.run = {**self.run, **head["run"]}
        self._run_version += 1

    def _on_test(self, head: dict[str, Any], block: bytes) -> None:
        self._begin(head["test"])

    def _on_samples(self, head: dict[str, Any], block: bytes) -> None:
        if self._history is not None and head["test"] == self._test.get("id"):
            self._history.add(columns_of(head["columns"], block), head["start"], head["first"])
            self._samples_version += 1

    def _on_outcome(self, head: dict[str, Any], block: bytes) -> Path | None:
        self.run["conditions"][head["condition"]] = head["counts"]
        self.run |= head["run"]
        self._run_version += 1
        streamed = self._test.get("id") == head["test"]["id"] and self._history is not None and self._history.samples
        return Path(head["log"]) if head["log"] and not streamed else None
