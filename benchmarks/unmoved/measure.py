"""Diagnose one set of logs with the code on the path, and print what came out: `python measure.py FOLDER OPTIONS`.

The output is one JSON object: the answer without times and versions, a digest of every simulated reading and of every
residual array in the order in which they were computed, how many there were, and the numbers of the page.
"""

from __future__ import annotations

import contextlib
import hashlib
import html
import importlib
import json
import os
import pkgutil
import re
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

# Classes are found by their name, so that a file may move; a renamed class or method is added here.
WATCHED = {"Simulator": ("follow", "run_to_ends"), "Windows": ("features", "along", "move_starts"), "Features": ("of",)}
TIMES = ("seconds", "version", "git", "made_from", "provenance")


class Digest:
    """A running digest of arrays, and their number."""

    def __init__(self) -> None:
        self.hash, self.count = hashlib.sha256(), 0

    def add(self, value: Any) -> None:
        """Add every array of a value: an array itself, or the members of a tuple or a dataclass."""
        if isinstance(value, np.ndarray):
            self.hash.update(np.ascontiguousarray(value).tobytes())
        elif isinstance(value, (int, float)):
            self.hash.update(repr(value).encode())
        elif isinstance(value, tuple):
            for one in value:
                self.add(one)
        elif hasattr(value, "__dataclass_fields__"):
            for name in value.__dataclass_fields__:
                self.add(getattr(value, name))


def classes(names: set[str]) -> Iterator[type]:
    """Yield the classes of the package that have one of these names."""
    package = importlib.import_module("hjcamp")
    for found in pkgutil.walk_packages(package.__path__, "hjcamp."):
        if ".rig" in found.name or "backends" in found.name or found.name.endswith("__main__"):
            continue
        with contextlib.suppress(ImportError), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            module = importlib.import_module(found.name)
            for value in vars(module).values():
                if isinstance(value, type) and value.__name__ in names and value.__module__ == found.name:
                    yield value


def watch() -> dict[str, Digest]:
    """Let every watched method add what it returns to a digest, and return these by `Class.method`."""
    found: dict[str, Digest] = {}
    for kind in classes(set(WATCHED)):
        for name in WATCHED[kind.__name__]:
            method = getattr(kind, name, None)
            if method is not None:
                digest = found.setdefault(f"{kind.__name__}.{name}", Digest())
                setattr(kind, name, watched(method, digest))
    return found


def watched(method: Callable[..., Any], digest: Digest) -> Callable[..., Any]:
    """Return a method that adds what it returns to a digest."""

    def call(*arguments: Any, **named: Any) -> Any:
        value = method(*arguments, **named)
        digest.count += 1
        digest.add(value)
        return value

    return call


def numbers_of(page: Path) -> str:
    """Return a digest of all numbers of a page, in their order; those of its scripts and footer are left out."""
    if not page.exists():
        return ""
    text = re.sub(r"<(script|style|footer)\b.*?</\1>", " ", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    text = re.sub(r"commit [0-9a-f]{40}", "", text)  # of the code that made it
    shown = html.unescape(re.sub(r"<[^>]*>", " ", text))
    return hashlib.sha256(" ".join(re.findall(r"-?\d+(?:\.\d+)?(?:e-?\d+)?", shown)).encode()).hexdigest()


def main() -> int:
    """Diagnose `logs` of the folder given, and write `measured.json` there."""
    from hjcamp.cli import run

    os.chdir(sys.argv[1])
    seen = watch()
    began = time.perf_counter()
    with Path("said.txt").open("w", encoding="utf-8") as said, contextlib.redirect_stdout(said):
        code = run(["diagnose", "logs", "--json", "answer.json", "--workers", "1", "--seed", "1", *sys.argv[2:]])
    answer = json.loads(Path("answer.json").read_text(encoding="utf-8")) if code == 0 else {"code": code}
    content = {
        "answer": {name: value for name, value in answer.items() if name not in TIMES},
        "arrays": {name: {"count": one.count, "sha256": one.hash.hexdigest()} for name, one in sorted(seen.items())},
        "page": numbers_of(Path("diagnose/index.html")),
        "seconds": round(time.perf_counter() - began, 1),
    }
    Path("measured.json").write_text(json.dumps(content, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
