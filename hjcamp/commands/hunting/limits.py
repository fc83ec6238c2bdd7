"""Whether a test stays within the limits that hold for it, in simulation with every model that remains."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from hjcamp import backends
from hjcamp.backends import plant_simulation
from hjcamp.errors import HjcampError, UsageError

if TYPE_CHECKING:
    from hjcamp.model.declare.candidate import Candidate

SEED = 1


def beyond_limits(config: Mapping[str, Any], models: Sequence[Candidate]) -> str:
    """Return which limit a test would pass with one of the ``models``, empty where it passes none.

    The whole test is simulated with its controller. Limits are those of its rig and of the plant, and what outputs and sensors reach.
    """
    from hjcamp.diagnosis.results.model_file import savable

    watches = backends.watches(config, reach=True)
    for model in map(savable, models):
        simulated = {
            **config,
            "backend": {"name": "simulation"},
            "model": {**config["model"], "parameters": {}, "effects": {}},
            "parameters": dict(model.base),
            "effects": {name: dict(values) for name, values in model.effects.items()},
        }
        try:
            columns, _ = plant_simulation.run_test(simulated, SEED)
        except UsageError:
            raise
        except HjcampError as problem:
            return str(problem)
        for one in watches:
            margin = one.margin(one.values(columns))
            if margin is not None and margin < 0.0:
                ends = " to ".join("-" if end is None else f"{end:.4g}" for end in (one.low, one.high))
                return f"{one.name} would leave {ends} {one.unit} by {-margin:.3g}"
    return ""
