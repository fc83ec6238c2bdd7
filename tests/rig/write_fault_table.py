"""Makes every row of the fault table and writes docs/rig_faults.md: python tests/rig/write_fault_table.py (minutes)."""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

import pytest
from fault_cases import CASES, WHEN
from fault_run import Row, make_row

from hjcamp.configuration.composer import Composer

TABLE = Path(__file__).parents[2] / "docs" / "rig_faults.md"
HEAD = """# What happens when something goes wrong on the rig

Written by `python tests/rig/write_fault_table.py`, on the virtual rig through the vendor's client code: each row is a
run of two tests (`trajectory=ramp_pos`, 1.8 s each) whose first test is disturbed at its start (sample 20, preload),
in its middle (sample 1000, halfway along the ramp) or at its end (sample 1500, ramp not yet over).

* *outputs*: dither off, preload standing still, the pump held where it was measured. "Within 2 samples": of the sample
  in which the fault showed; for a fault that shows later (a stuck encoder), of the sample in which a limit was passed.
  Where the device's watchdog was first (late samples, device disappears) the pump is held at its last command instead:
  a watchdog knows no measurement.
* *log*: what `hjcamp log recover` makes of the `.part` file. *code*: exit code of the run. *resumed*: after
  `hjcamp resume` without the fault.
* A device that disappears cannot be written to: its own watchdog makes the outputs safe, and the message says so.
* A stuck arm encoder is told from an arm that friction holds by what pump and pressures say: it is noticed once the
  arm has turned by about 6 deg more than they allow, at the latest while the pump returns to its start. One that sticks
  in the last moments of a test that ends where it began is not noticed before the next test moves.
* Disk full: here the write is refused by a stand-in; `tests/rig/test_full_disk.py` fills a real file system.

| what | when | outputs | log | code | resumed | said |
|---|---|---|---|---|---|---|
"""


def main() -> int:
    """Write the table; returns the number of rows that could not be made."""
    composer, rows, problems = Composer(), [], 0
    patches = pytest.MonkeyPatch()
    start = os.getcwd()
    for case in CASES:
        for when in WHEN:
            with tempfile.TemporaryDirectory() as folder:
                os.chdir(folder)
                try:
                    row = make_row(case, when, Path(folder), composer, patches)
                    rows.append(f"{row.line()} {said(row)} |")
                except Exception as error:
                    problems += 1
                    print(f"{case.name}, {when}: {type(error).__name__}: {error}", file=sys.stderr)
                finally:
                    os.chdir(start)
    if not problems:
        TABLE.write_text(HEAD + "\n".join(rows) + "\n", encoding="utf-8")
    print(f"{len(rows)} rows, {problems} not made")
    return problems


def said(row: Row) -> str:
    """Return the reason alone."""
    first = row.message.splitlines()[0] if row.message else ""
    before, found, after = first.partition(row.folder)
    text = before + after.partition(" ")[2] if found and row.folder else first
    return text.removeprefix("the rig was made safe: ").replace("|", "/")


if __name__ == "__main__":
    sys.exit(main())
