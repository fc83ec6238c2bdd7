"""Compare what this code answers with what another commit answers: `make unmoved BASE=COMMIT`.

Both versions diagnose the same twelve sets of logs on this machine, in turns on its cores. Nothing may differ: no bit of a
simulated reading or a residual, no count of simulations, no number of an answer or a page. `--write` keeps the present results
in `benchmarks/results/unmoved.json`, and without BASE they are compared with those: other processors round otherwise, so
numbers of the answer are then compared to a relative 1e-6 and digests are not.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from benchmarks import ROOT

from .sets import SETS, LogSet, listed

KEPT = ROOT / "benchmarks" / "results" / "unmoved.json"
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


def compared(one: LogSet, base: Path | None, kept: dict[str, Result], place: Path) -> tuple[Result, list[str]]:
    """Return the present result of a set, and where it differs from the other one."""
    now = measured(one, ROOT, place / "now")
    if base is not None:
        before = measured(one, base, place / "base")
        print(f"{one.name:26} {before['seconds']:6.1f} s before, {now['seconds']:6.1f} s now", flush=True)
        return now, list(differences(without(before, "seconds"), without(now, "seconds"), 0.0))
    print(f"{one.name:26} {now['seconds']:6.1f} s", flush=True)
    if one.name not in kept:
        return now, []
    left_out = ("seconds", "arrays", "page")
    return now, list(differences(without(kept[one.name], *left_out), without(now, *left_out), CLOSE))


def main() -> int:
    """Compare, and return 1 where anything moved."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.unmoved", description=__doc__)
    parser.add_argument("--base", help="a commit; without it the committed results")
    parser.add_argument("--only", default="", help="sets whose name has this in it")
    parser.add_argument("--long", action="store_true", help="the sixty cases of long_list.txt, in two hours")
    parser.add_argument("--write", action="store_true", help="keep the present results")
    options = parser.parse_args()
    chosen = [one for one in (listed() if options.long else SETS) if options.only in one.name]
    if options.long and not options.base:
        parser.error("--long needs --base COMMIT")
    kept = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() and not options.write else {}
    with tempfile.TemporaryDirectory(prefix="unmoved_") as temporary:
        place, base = Path(temporary), None
        if options.base:
            base = place / "code"
            git = ["git", "-C", str(ROOT), "worktree"]
            subprocess.run([*git, "add", "--detach", "--quiet", str(base), options.base], check=True)
        try:
            with ThreadPoolExecutor(AT_ONCE) as pool:
                found = list(pool.map(lambda one: compared(one, base, kept, place), chosen))
        finally:
            if base is not None:
                subprocess.run([*git, "remove", "--force", str(base)], check=True)
    moved = {one.name: rows for one, (_, rows) in zip(chosen, found, strict=True) if rows}
    for name, rows in moved.items():
        print(f"{name}: {len(rows)} moved", *rows[:12], sep="\n  ")
    if options.write:
        results = {one.name: result for one, (result, _) in zip(chosen, found, strict=True)}
        KEPT.write_text(json.dumps(results, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    print(f"{len(chosen) - len(moved)} of {len(chosen)} sets unmoved")
    return 1 if moved else 0


if __name__ == "__main__":
    sys.exit(main())
