"""Write the features of the models of three motors, which `test_verdict` decides between."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent), str(HERE.parents[1]), str(HERE.parent / "machines")]


def features_of(models: object) -> dict[str, np.ndarray]:
    """Return what a decision needs of fitted models, in half precision."""
    known = models.analysis.channels  # type: ignore[attr-defined]
    kept = models.all  # type: ignore[attr-defined]
    base = models.base  # type: ignore[attr-defined]
    blocks = [[b in one.blocks for b in range(len(models.names))] for one in kept]  # type: ignore[attr-defined]
    return {
        "features": np.array([one.features for one in (base, *(one.scored for one in kept))], dtype=np.float16),
        "fitted": np.array([one.fitted.features for one in (base, *(one.scored for one in kept))], dtype=np.float16),
        "names": np.array(["+".join(one.scored.beyond(base)) for one in kept]),
        "terms": np.array(sorted(models.terms)),  # type: ignore[attr-defined]
        "chosen": np.array(blocks),
        "blocks": models.blocks,  # type: ignore[attr-defined]
        "ends": np.array([[one.start, one.stop] for one in known.columns]),
        "squares": known.repeatability.squares,
        "unsure": known.repeatability.unsure,
    }


def main() -> None:
    """Write the three files; each machine in a folder of its own."""
    from asked import analysed
    from test_by_condition import motor as loaded
    from test_given_constants import motor as pushed
    from test_over_each import WINDS
    from test_over_each import motor as blown

    from hjcamp.diagnosis.choice.models import Models

    sets: dict[str, Callable[[], object]] = {
        "nothing": lambda: loaded(1.0),
        "effect": lambda: pushed(0.01),
        "outside": lambda: blown(dict.fromkeys(WINDS, WINDS["storm"])),
    }
    for name, made in sets.items():
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            found = features_of(Models(analysed(made(), ["constant_force", "sensor_lag", "sensor_gain"])))  # type: ignore[arg-type]
        np.savez_compressed(HERE / f"features_{name}.npz", **found)  # type: ignore[arg-type]
        print(name, found["features"].shape)


if __name__ == "__main__":
    main()
