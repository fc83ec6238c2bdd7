"""How much work a diagnosis may do."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Effort:
    """How much work a diagnosis may do: null replicates, fitted survivors of a screening, Gauss-Newton steps, further effects, and
    sweeps of a pattern search that settles each fit.

    A ``hasty`` one looks for a further effect only where the model found so far leaves an error or another promised much.
    """

    replicates: int
    survivors: int
    steps: int
    forward: int
    sweeps: int = 0
    hasty: bool = False


EFFORTS = {
    "quick": Effort(24, 4, 4, 2, hasty=True),
    "standard": Effort(60, 6, 4, 2, 6),
    "thorough": Effort(300, 10, 8, 3, 20),
}
