"""What is said of an error beside its floor, whatever the plant."""

from __future__ import annotations

NEAR = 1.3
NO_FLOOR = (
    "No test was repeated, so there is no floor, and nothing tells how much of the error is the model's; "
    "repetitions of the same tests give one (3 of each condition are usual: hjcamp run ... repetitions=3)."
)
WORSE = 1.02


def worse_calibrated(name: str, before: float, after: float, why: str) -> list[str]:
    """Return in words that a model is further off with its base parameters calibrated than as it stands; nothing where it is not.

    ``before`` and ``after`` are its errors over the floor (or spread), ``why`` says what the fit looks at.
    """
    if not after > WORSE * before:
        return []
    return [f"Calibrated, {name} is further off than as it stands ({after:.2f} against {before:.2f}): {why}."]
