"""Makes the rows of an axis on a serial line and writes them into docs/rig_faults.md: python tests/rigs/write_serial_faults.py."""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

from lab_of_rigs import AXIS
from serial_faults import CASES, TEST, WHEN, make_row

from hjcamp.configuration.check import check_configuration
from hjcamp.configuration.composer import Composer, free

TABLE = Path(__file__).parents[2] / "docs" / "rig_faults.md"
TITLE = "## An axis on a serial line"
HEAD = f"""{TITLE}

Written by `python tests/rigs/write_serial_faults.py`: an axis (the template of `hjcamp plants new`) on the text protocol of
[rig_protocol.md](rig_protocol.md) over a pseudo-terminal, no hardware. 30 samples of rest, 80 at 1 V, 40 of rest; the fault begins
at sample 15, 70 or 130. Its watchdog makes the outputs safe 50 samples (50 ms of the plant) after the last write.

* *outputs*: by the device's own record. "Within 2 samples": of the one in which the fault showed, the loop did it. "Within 51
  samples": of the last write, by the device's watchdog where the loop came later or the device was not reached (the plant's time
  passes by itself in these rows, at a tenth of the clock).
* *code*: exit code of the run; -9 is the kill itself.

| fault | when | outputs | code | said |
|---|---|---|---|---|
"""


def main() -> int:
    """Write the rows; returns 1 where one was not safe in time."""
    rows, start = [], os.getcwd()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "plants").mkdir()
        (folder / "plants" / "axis1.py").write_text(AXIS)
        os.environ["XDG_STATE_HOME"] = str(folder / "state")
        os.chdir(folder)
        config = Composer().compose([free(line) for line in TEST[:-2]]).config
        check_configuration(config)
        config = Composer().compose([free(line) for line in TEST]).config
        for case in CASES:
            for when in WHEN:
                rows.append(make_row(case, when, config, folder))
                print(rows[-1].line(), rows[-1].samples, rows[-1].message[:120], flush=True)
        os.chdir(start)
    page = TABLE.read_text(encoding="utf-8").partition(TITLE)[0].rstrip()
    TABLE.write_text(f"{page}\n\n{HEAD}" + "".join(f"{row.line()}\n" for row in rows), encoding="utf-8")
    return int(any("ONLY" in row.line() for row in rows))


if __name__ == "__main__":
    sys.exit(main())
