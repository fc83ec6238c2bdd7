"""Hide effects in rigs of the truth plant, diagnose the tables that their benches print, and write how often that is right.

    python -m benchmarks.hidden_tables [--effort quick|standard] [--shift N] [--most N] [--ledger FILE] [--page FILE] [--score]

Each case is `hjcamp diagnose --tables table.csv` in an empty folder, as a user calls it: means and deviations of 14 conditions,
nothing held out. The truth plant (tests/truth) and the indicators share no code with the program. Finished cases are kept in
a ledger, one line each: the same command goes on from it as long as the code is the same.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks import ROOT
from benchmarks.hidden_effects.ledger import Ledger, code_version
from benchmarks.hidden_tables.cases import TableCase, plan, seen, table_of, text_of
from benchmarks.hidden_tables.page import page
from hjcamp.storage import write_whole

PLAN = "hidden_tables/2"
LEDGER = ROOT / "benchmarks" / "results" / "hidden_tables.jsonl"
LONGEST_S = 7200.0
KEPT = ("verdict", "effects", "p_value", "p_left", "steps", "error", "seconds")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the cases that are not finished, then write the page; return the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--effort", choices=("quick", "standard", "thorough"), default="quick")
    parser.add_argument("--shift", type=int, default=0, metavar="N", help="added to every seed: the plan on other rigs")
    parser.add_argument("--most", type=int, metavar="N", help="stop after so many new cases")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--ledger", type=Path, default=LEDGER, metavar="FILE")
    parser.add_argument("--tag", default=code_version(), help="version of the code")
    parser.add_argument("--page", type=Path, metavar="FILE")
    parser.add_argument("--score", action="store_true", help="run nothing, write the page of what is finished")
    given = parser.parse_args(arguments)
    cases, ledger = plan(given.shift), Ledger(given.ledger, PLAN)
    done = ledger.finished(given.tag, given.effort)
    left = [] if given.score else [case for case in cases if case.name not in done][: given.most]
    try:
        for number, case in enumerate(left, start=1):
            line = run_case(case, given.effort, given.tag, given.workers)
            ledger.add(line)
            print(f"{number} of {len(left)}  {case.name}: {line['verdict']} {', '.join(line['effects'])}", flush=True)
    except KeyboardInterrupt:
        print("stopped; the same command goes on from here")
        return 130
    lines = [line for line in ledger.lines(given.tag) if line["effort"] == given.effort]
    if not lines:
        print(f"no finished case of {given.tag} in {given.ledger}", file=sys.stderr)
        return 1
    command = f"python -m benchmarks.hidden_tables --effort {given.effort}" + (f" --shift {given.shift}" if given.shift else "")
    target = given.page or given.ledger.with_suffix(".md")
    write_whole(target, page(lines, len(cases), given.tag, command))
    print(f"page    {target}")
    return 0


def run_case(case: TableCase, effort: str, tag: str, workers: int) -> dict[str, Any]:
    """Make the table of one case, have it diagnosed, and return its line of the ledger."""
    table = table_of(case)
    visible = seen(table, table_of(case, hidden=False)) if case.effect else 0.0
    with tempfile.TemporaryDirectory(prefix="hidden_tables_") as place:
        folder = Path(place)
        (folder / "table.csv").write_text(text_of(table), encoding="utf-8")
        began = time.monotonic()
        call = subprocess.run(
            [
                sys.executable, "-m", "hjcamp", "diagnose", "--tables", "table.csv", "--effort", effort,
                "--workers", str(workers), "--json", "answer.json",
            ],
            cwd=folder, capture_output=True, text=True, timeout=LONGEST_S, check=False,
        )  # fmt: skip
        seconds = round(time.monotonic() - began, 1)
        told: dict[str, Any] = {"verdict": "failed", "effects": []}
        if call.returncode == 0:
            content = json.loads((folder / "answer.json").read_text(encoding="utf-8"))
            told = {name: content.get(name) for name in KEPT}
        else:
            told["message"] = " ".join(call.stderr.split())[-300:] or f"exit code {call.returncode}"
    return {
        "plan": PLAN, "name": case.name, "effort": effort, "tag": tag, "kind": case.kind, "effect": case.effect,
        "strength": case.strength, "seed": case.seed, "right": case.verdict, "visible": round(visible, 3),
        "wall_seconds": seconds, "visibility": {}, **told,
    }  # fmt: skip


if __name__ == "__main__":
    sys.exit(main())
