"""Makes the rows of the fault table and writes docs/rig_faults.md: python tests/rig/write_fault_table.py [WORD ...].

Takes some minutes. With words only the rows whose name contains one of them are made, the others stay as they are.
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import pytest
from client_run import KINDS, PHASES, make_client_row
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
* Where the watchdog is first ("late samples", "device disappears" and all rows of a client) the pump is held at its last
  *command*, not where it was measured: a watchdog can keep a voltage, it cannot read an encoder. The two differ by what
  the pump lags behind, 30 deg of its motor or 0.08 mm in the middle of this ramp.
* *client*: one test on a virtual rig whose time passes by itself (`hjcamp rig serve --real-time`); in each phase the
  client is killed, stopped until the watchdog has tripped, or cut off so that nothing arrives any more. "Within 5
  samples": of the last reset of the watchdog (5 ms) by the rig's own record. In preload and release the preload drive runs
  at 1 mm/s (2 V) until then. A rig without a watchdog would keep its outputs. Code -9 is the kill itself.
* *log*: what `hjcamp log recover` makes of the `.part` file. *code*: exit code of the run. *resumed*: after
  `hjcamp resume` without the fault.
* A device that disappears, or a server that does not answer, cannot be written to: the device's own watchdog makes the
  outputs safe, and the message says so and names the outputs with what was last written to them.
* A stuck arm encoder is told from an arm that friction holds by what pump and pressures say: it is noticed once the
  arm has turned by about 6 deg more than they allow, at the latest while the pump returns to its start. One that sticks
  in the last moments of a test that ends where it began is not noticed before the next test moves.
* Disk full: here the write is refused by a stand-in; `tests/rig/test_full_disk.py` fills a real file system.

| what | when | outputs | log | code | resumed | said |
|---|---|---|---|---|---|---|
"""


def main(words: Sequence[str] = ()) -> int:
    """Write the table; returns the number of rows that could not be made."""
    composer, rows, problems = Composer(), [], 0
    patches = pytest.MonkeyPatch()
    start = os.getcwd()
    makers: list[tuple[str, str, Callable[[Path, Composer], Row]]] = [
        (case.name, when, partial(make_row, case, when, monkeypatch=patches)) for case in CASES for when in WHEN
    ]
    makers += [(kind, phase, partial(make_client_row, kind, phase)) for kind in KINDS for phase in PHASES]
    for name, when, maker in makers:
        kept = row_of(name, when) if words and not any(word in name for word in words) else None
        if kept is not None:
            rows.append(kept)
            continue
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                row = maker(Path(folder), composer)
                rows.append(f"{row.line()} {said(row)} |")
                print(rows[-1], flush=True)
            except Exception as error:
                problems += 1
                print(f"{name}, {when}: {type(error).__name__}: {error}", file=sys.stderr)
            finally:
                os.chdir(start)
    if not problems:
        serial = "".join(TABLE.read_text(encoding="utf-8").partition("\n## ")[1:])
        TABLE.write_text(HEAD + "\n".join(rows) + "\n" + serial, encoding="utf-8")
    print(f"{len(rows)} rows, {problems} not made")
    return problems


def row_of(name: str, when: str) -> str | None:
    """Return a row of the table as it is, None where there is none."""
    lines = TABLE.read_text(encoding="utf-8").splitlines()
    return next((line for line in lines if line.startswith(f"| {name} | {when} |")), None)


def said(row: Row) -> str:
    """Return the reason alone."""
    first = row.message.splitlines()[0] if row.message else ""
    before, found, after = first.partition(row.folder)
    text = before + after.partition(" ")[2] if found and row.folder else first
    return text.removeprefix("the rig was made safe: ").replace("|", "/")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
