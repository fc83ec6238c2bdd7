"""Write docs/thesis_gap.md: what makes the simulated indicators meet Tables 5.4.1 and 5.4.2, and what it predicts."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import thesis_gap_checks as checks
from thesis_gap_forward import forward
from thesis_gap_page import PICTURE, draw, page
from thesis_gap_results import results
from thesis_gap_study import Study

from hjcamp.storage import write_whole

HERE = Path(__file__).parent
DOCS = HERE.parent / "docs"


def study(path: Path) -> Study:
    """Run what is missing of the study; finished parts are read from ``path``."""
    found = Study.begin(path)
    models, accepted = forward(found)
    found.ledger.keep("accepted", lambda: accepted)
    checks.predict(found, models)
    checks.leave_out(found, models[:2])
    checks.twins(found, models, accepted)
    checks.alike(found, models[accepted])
    return found


def main() -> None:
    """Run the study, then write its results, pictures and page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--ledger", type=Path, default=Path("runs/thesis_gap.json"), help="finished parts are kept here"
    )
    given = parser.parse_args()
    given.ledger.parent.mkdir(parents=True, exist_ok=True)
    done = study(given.ledger)
    found = results(done.ledger.found, done.cells)
    write_whole(DOCS / "thesis_gap.json", json.dumps(found, indent=1) + "\n")
    draw(found, DOCS / PICTURE)
    write_whole(DOCS / "thesis_gap.md", page(found, (HERE / "thesis_gap_reading.md").read_text(encoding="utf-8")))


if __name__ == "__main__":
    main()
