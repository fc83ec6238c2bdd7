"""Makes every mistake of `wrong_logs` and writes what is said of it: python tests/records/write_wrong_logs.py."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from wrong_logs import Wrong, carriage_mistakes, carriage_set, joint_mistakes, joint_set, said

from hjcamp.records.log import TestLog
from hjcamp.storage import whole_file

PAGE = Path(__file__).parents[2] / "docs" / "wrong_logs.md"
HEAD = """# Logs that are wrong on purpose, and what is said of them

Written by `make wrong_logs`. One log of a set of sound ones is spoilt, or a spoilt copy is put next to them; the sentence is that of
`hjcamp log verify`, `import`, `compare`, `diagnose`, `add` and `next`. An *error* is refused by every analysis; after a *warning* a
log that differs from its repetitions is named, by `compare` of the joint in place of a conclusion, and a copy counts once.
Nothing is said of the sound sets.

* *joint*: five conditions of the tour's bench with three repetitions each; the wrong log is the second of `triangle_slow`.
* *carriage*: a motor that pushes a carriage, three conditions with three repetitions each, friction that scatters by 3 %; the wrong
  log is the second of `swing`.

"not named" is a fault that a closer look could see. Where the last column begins with "not known", no look at these logs can: why
is next to it. Two statistics decide (`hjcamp/records/sets/`): an F test of a log's deviation from the mean of its repetitions,
with the degrees of freedom of the deviations' spectra, and how far that ratio stands out of those of all other logs of the set
(Student's t of its logarithm), at a level of one wrongly named log in a hundred sets. In closed loop the scatter is the largest of
all conditions in closed loop, and a repetition has one degree of freedom. An error needs more: the log is impossible as a repetition
(each column that the mistake touches is off by more than it moves), it is near with that one mistake undone, and by chance so near
in one of a thousand sets. How many sound sets are named all the same is counted in [decisions/sets.md](decisions/sets.md).
"""


def row(wrong: Wrong, logs: list[TestLog]) -> tuple[str, bool]:
    """Return a line of the table, and whether the log is named."""
    made = wrong.make(logs)
    lines = said(made, {one.path for one in made if one.path and not any(one is log for log in logs)})
    told = lines[0].partition(".mcap: ")[2] if lines else f"not known: {wrong.unknowable}" if wrong.unknowable else "not named"
    return f"| {wrong.name} | {told.replace('|', '/')} |", bool(lines)


def main() -> None:
    """Write the page."""
    text = [HEAD]
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for name, logs, mistakes in (
            ("joint", joint_set(), joint_mistakes()),
            ("carriage", carriage_set(Path(folder)), carriage_mistakes()),
        ):
            assert not said(logs, {log.path for log in logs if log.path}), name
            rows = [row(one, logs) for one in mistakes]
            named, unknowable = sum(told for _, told in rows), sum(bool(one.unknowable) for one in mistakes)
            text.append(f"\n## {name}: {named} of {len(rows)} named, {unknowable} that nobody could know\n")
            text += ["| mistake | said |", "|---|---|", *(line for line, _ in rows)]
        os.chdir("/")
    with whole_file(PAGE) as stream:
        stream.write(("\n".join(text) + "\n").encode())


if __name__ == "__main__":
    main()
