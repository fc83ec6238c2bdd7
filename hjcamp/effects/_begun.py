"""What an effect file that is begun from a diagnosis holds: tables over one driver."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Table:
    """Values at even steps of the driver, SI, added to ``slots`` with a ``factor`` (-1 or what turns with the motion).

    They are taken from the slots ``against``.
    """

    amplitude: str
    slots: tuple[str, ...]
    values: tuple[float, ...]
    unit: str
    text: str
    factor: str = ""
    against: tuple[str, ...] = ()


@dataclass(frozen=True)
class Begun:
    """What a file begins with: tables over one driver, from ``first`` to ``last``, SI.

    ``expression`` says in names of the plant what drives it, ``arguments`` are these names; ``rests`` names the velocity by
    which a state of its own knows for how long it rests.
    """

    plant: str
    subsystem: str
    driver: str
    expression: str
    arguments: tuple[str, ...]
    unit: str
    first: float
    last: float
    tables: tuple[Table, ...]
    origin: str
    rests: str = ""
