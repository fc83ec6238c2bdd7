"""Compare what this code answers with what another commit answers: `make unmoved BASE=COMMIT`.

Both versions diagnose the same twelve sets of logs on this machine, in turns on its cores. Nothing may differ: no bit of a
simulated reading or a residual, no count of simulations, no number of an answer or a page. `--write` keeps the present results
in `benchmarks/results/unmoved.json`, and without BASE they are compared with those: other processors round otherwise, so
numbers of the answer are then compared to a relative 1e-6 and digests are not. `--now COMMIT` takes another commit for this
code. What a commit answers is kept in `runs/unmoved`, so that an interrupted comparison continues where it stopped.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks import ROOT

from .sets import SETS, LogSet, listed

KEPT = ROOT / "benchmarks" / "results" / "unmoved.json"
MEASURED = ROOT / "runs" / "unmoved"
CLOSE = 1e-6
AT_ONCE = 2
Result = dict[str, Any]


def measured(one: LogSet, code: Path, place: Path) -> Result:
    """Write a set of logs, diagnose it with the code in a folder, and return what `measure` says of it."""
    folder = place / one.name
    folder.mkdir(parents=True)
    one.write(folder).unlink()
    environment = os.environ | {"PYTHONPATH": str(code)}

    def call(*arguments: str) -> None:
        done = subprocess.run(
            [sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False
        )
        if done.returncode:
            raise SystemExit(f"{one.name}: {' '.join(done.stderr.split())[-600:]}")

    if one.imported:
        files = sorted(str(file.relative_to(folder)) for file in (folder / "measured").iterdir())
        call("-m", "hjcamp", "import", *files, "--map", "import.yaml", "--into", "logs")
    call(str(Path(__file__).with_name("measure.py")), str(folder), *one.options)
    found: Result = json.loads((folder / "measured.json").read_text(encoding="utf-8"))
    return found


def differences(before: Any, after: Any, close: float, at: str = "") -> Iterator[str]:
    """Yield where two results differ, by the path of their keys; numbers may differ by a relative `close`."""
    if isinstance(before, dict) and isinstance(after, dict):
        for name in sorted(before.keys() | after.keys()):
            yield from differences(before.get(name), after.get(name), close, f"{at}.{name}" if at else str(name))
    elif isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        for k, (one, other) in enumerate(zip(before, after, strict=True)):
            yield from differences(one, other, close, f"{at}[{k}]")
    elif isinstance(before, float) and isinstance(after, (int, float)) and close:
        if not math.isclose(before, after, rel_tol=close, abs_tol=1e-12):
            yield f"{at}: {before!r} -> {after!r}"
    elif before != after:
        yield f"{at}: {str(before)[:60]} -> {str(after)[:60]}"


def without(result: Result, *names: str) -> Result:
    """Return a result without some of its keys."""
    return {name: value for name, value in result.items() if name not in names}


@dataclass(frozen=True)
class Code:
    """A version of the code: its folder, and its commit; no commit for files that may change."""

    folder: Path
    commit: str = ""

    def result(self, one: LogSet, place: Path) -> Result:
        """Return what this code says of a set of logs; what its commit has said once is read, not computed again."""
        file = MEASURED / self.commit / f"{one.name}.json"
        if self.commit and file.exists():
            kept: Result = json.loads(file.read_text(encoding="utf-8"))
            return kept
        result = measured(one, self.folder, place)
        if self.commit:
            file.parent.mkdir(parents=True, exist_ok=True)
            part = file.with_suffix(".part")
            part.write_text(json.dumps(result), encoding="utf-8")
            part.replace(file)
        return result


@contextlib.contextmanager
def checked_out(commit: str, folder: Path) -> Iterator[Code]:
    """Yield the code of a commit in a work tree of its own, which is removed afterwards."""
    git = ["git", "-C", str(ROOT)]
    name = subprocess.run([*git, "rev-parse", f"{commit}^{{commit}}"], check=True, capture_output=True, text=True)
    subprocess.run([*git, "worktree", "add", "--detach", "--quiet", str(folder), commit], check=True)
    try:
        yield Code(folder, name.stdout.strip())
    finally:
        subprocess.run([*git, "worktree", "remove", "--force", str(folder)], check=True)


def compared(one: LogSet, base: Code | None, now: Code, kept: dict[str, Result], place: Path) -> tuple[Result, list[str]]:
    """Return the present result of a set, and where it differs from the other one."""
    after = now.result(one, place / "now")
    rows: list[str] = []
    if base is not None:
        before = base.result(one, place / "base")
        rows = list(differences(without(before, "seconds"), without(after, "seconds"), 0.0))
        times = f"{before['seconds']:6.1f} s before, {after['seconds']:6.1f} s now"
    else:
        times = f"{after['seconds']:6.1f} s"
        if one.name in kept:
            left_out = ("seconds", "arrays", "page")
            rows = list(differences(without(kept[one.name], *left_out), without(after, *left_out), CLOSE))
    said = [f"{one.name:26} {times}: {f'{len(rows)} moved' if rows else 'unmoved'}", *rows[:12]]
    print("\n  ".join(said), flush=True)
    return after, rows


def main() -> int:
    """Compare, and return 1 where anything moved."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.unmoved", description=__doc__)
    parser.add_argument("--base", help="a commit; without it the committed results")
    parser.add_argument("--now", help="a commit that is compared with it; without it the files as they are")
    parser.add_argument("--only", default="", help="sets whose name has this in it")
    parser.add_argument("--long", action="store_true", help="the sixty cases of long_list.txt, in two hours")
    parser.add_argument("--write", action="store_true", help="keep the present results")
    options = parser.parse_args()
    chosen = [one for one in (listed() if options.long else SETS) if options.only in one.name]
    if options.long and not options.base:
        parser.error("--long needs --base COMMIT")
    kept = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() and not options.write else {}
    with contextlib.ExitStack() as stack:
        place = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="unmoved_")))
        base = stack.enter_context(checked_out(options.base, place / "code")) if options.base else None
        now = stack.enter_context(checked_out(options.now, place / "code_now")) if options.now else Code(ROOT)
        with ThreadPoolExecutor(AT_ONCE) as pool:
            found = list(pool.map(lambda one: compared(one, base, now, kept, place), chosen))
    if options.write:
        results = {one.name: result for one, (result, _) in zip(chosen, found, strict=True)}
        KEPT.write_text(json.dumps(results, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    moved = sum(bool(rows) for _, rows in found)
    print(f"{len(chosen) - moved} of {len(chosen)} sets unmoved")
    return 1 if moved else 0


if __name__ == "__main__":
    sys.exit(main())
