"""Makes the sample logs and the sealed answer of `hjcamp tour`: python tests/cli/make_tour_data.py (10 s)."""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))
from truth.pump_joint.case import write_case

from hjcamp.plants.pump_joint.tour.samples import SAMPLES, SEALED, pack, seal
from hjcamp.plants.pump_joint.tour.spindle import SPINDLE
from hjcamp.records.find import read_logs

EFFECT, STRENGTH, SEED = "leakage", "medium", 3
# What the plant calls it, what the library calls it.
PARAMETERS = {"leak_conductance": "conductance", "leak_opening_pressure": "threshold"}
NOTE = (
    "In the rig the gap of the leak widens steadily above the threshold (flow as its third power); in the library the "
    "flow grows along a straight line above it. One law stands for the other, and an interval takes its law for granted."
)
BASE = ("static_positive", "coulomb_positive", "viscous_positive", "static_negative", "coulomb_negative")


def sealed(answer: dict[str, Any]) -> dict[str, Any]:
    """Return what hides in the words of the diagnosis: effects, their parameters and base parameters, SI."""
    changes, base = answer["changes"][EFFECT], answer["base"]
    stiffness = (base["stiffness1"] + base["stiffness2"]) / 2
    return {
        "verdict": answer["verdict"],
        "effects": answer["effects"],
        "parameters": {EFFECT: {name: changes[field] for field, name in PARAMETERS.items()}},
        "base": {name: base[name] for name in (*BASE, "viscous_negative")} | {"line_stiffness": stiffness},
        "note": NOTE,
        "made_by": f"python -m tests.truth OUT --effect {EFFECT} --strength {STRENGTH} --seed {SEED}",
    }


def sealed_spindle() -> dict[str, Any]:
    """Return what brakes the spindle of `hjcamp tour --plant`, as docs/gallery/make_logs.py has it."""
    sys.path.insert(0, str(Path(__file__).parents[2] / "docs" / "gallery"))
    import make_logs

    return {
        "verdict": "effect",
        "effects": ["quadratic_drag"],
        "parameters": {"quadratic_drag": {"drag": -make_logs.drag(1.0)}},
        "base": make_logs.SPINDLE,
        "note": "",
        "made_by": "python docs/gallery/make_logs.py",
    }


def main(samples: Path = SAMPLES, answer: Path = SEALED) -> None:
    """Hide the effect, run the tests, pack the logs and seal the answer."""
    with tempfile.TemporaryDirectory() as folder:
        file = write_case(Path(folder) / "logs", [EFFECT], STRENGTH, SEED)
        logs = {log.path.stem: log for log in read_logs([Path(folder) / "logs"]) if log.path}
        pack(logs, samples)
        seal(sealed(json.loads(file.read_text(encoding="utf-8"))), answer)
    seal(sealed_spindle(), SPINDLE.sealed)
    print(f"{samples.name}: {len(logs)} tests, {samples.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
