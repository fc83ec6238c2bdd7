r"""What the form of laws adds to the interval of a parameter: so much that 95 % of such intervals hold the truth on other rigs.

.. math:: |e_i| \le t \sqrt{\Delta_i^2 + f^2} \quad \text{on 95 % of the rigs } i

with e the error and Delta the jackknife's standard deviation, both as shares of the value, and Student's t: a quantile, since errors of
form have long tails. The rigs are those of `effects.csv`, with one effect under one of several laws and one of four contacts, where
that effect alone was named. No number of tests of one rig tells it. Of n rigs the (n + 1) 0.95 th smallest counts, the largest of
fewer than 19 (split conformal; Lei et al. 2018, doi:10.1080/01621459.2017.1307116).
"""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

from hjcamp.plants.pump_joint.diagnosis.levels import rows_of

TABLE = Path(__file__).with_name("intervals.csv")
COVERED = 0.95
# The largest of fewer rigs holds for fewer than three of four others.
FEWEST = 3


@cache
def form_of(effect: str, name: str) -> float:
    """Return the standard deviation, a share of the value, that the form of laws adds to a parameter of an effect (or the base).

    Of a parameter that the table does not have, or of too few rigs, it is that of all effects (or of the base) together.
    """
    needed = _needed()
    own = needed.get((effect, name), [])
    if len(own) < FEWEST:
        own = [one for (of, _), rows in needed.items() if bool(of) == bool(effect) for one in rows]
    return sorted(own)[min(math.ceil(COVERED * (len(own) + 1)), len(own)) - 1] if own else 0.0


@cache
def _needed() -> dict[tuple[str, str], list[float]]:
    from scipy.special import stdtrit

    found: dict[tuple[str, str], list[float]] = {}
    for row in rows_of(TABLE):
        t = float(stdtrit(int(row["freedom"]), 0.5 + COVERED / 2.0))
        needed = max((float(row["error"]) / t) ** 2 - float(row["deviation"]) ** 2, 0.0) ** 0.5
        found.setdefault((row["effect"], row["parameter"]), []).append(needed)
    return found
