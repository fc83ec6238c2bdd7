"""The cases of the hidden-effect benchmark: what is hidden, how strongly, on which rig, and with which library."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from typing import Any
from zlib import crc32

from numpy.random import default_rng
from truth.pump_joint.case import CONTACTS
from truth.pump_joint.hidden import LIBRARY_NAMES, OUTSIDE_NAMES, STRENGTHS
from truth.pump_joint.hidden_law import chosen_law

# Results of another plan are never taken for results of this one: 1 had one contact and one law of each effect, 2 other second
# laws of the sensors, 3 an orifice in the line.
PLAN = 4
# Development used rigs 1 - 206 and 300 - 313.
FIRST_SEED = {"single": 1000, "pair": 1400, "outside": 1500, "taken_out": 1600, "null": 2000}
SEEDS = 2
NULLS = {"small": 12, "fresh": 30, "full": 30}
SIZES = tuple(NULLS)
NOTHING, EFFECT, ONE_OF, OUTSIDE = "nothing_missing", "effect", "one_of", "outside_library"
# The same thing but for its size, by the method's own list of traps: naming the other one is no error there.
SAME = (frozenset({"line_inertance", "payload_inertia"}),)
PAIRS = (
    ("leakage", "position_friction"),
    ("entrained_air", "encoder_eccentricity"),
    ("tubing_creep", "gravity_load"),
    ("line_resistance", "pressure_friction"),
    ("cross_leakage", "encoder_lag"),
    ("pump_backlash", "stribeck_friction"),
    ("payload_inertia", "leakage"),
    ("pressure_gain", "position_friction"),
    ("entrained_air", "gravity_load"),
    ("encoder_eccentricity", "tubing_creep"),
)
TAKEN_OUT = (
    "leakage",
    "entrained_air",
    "tubing_creep",
    "line_resistance",
    "pump_backlash",
    "stribeck_friction",
    "position_friction",
    "pressure_friction",
    "gravity_load",
    "payload_inertia",
    "encoder_eccentricity",
    "encoder_lag",
)


@dataclass(frozen=True)
class HiddenCase:
    """One case; ``without`` are the effects that the diagnosis must do without, and the verdict is judged by ``kind``."""

    name: str
    kind: str
    effects: tuple[str, ...]
    strength: str
    seed: int
    without: tuple[str, ...] = ()
    small: bool = False

    @property
    def contact(self) -> str:
        """The law of dry friction of the rig, drawn by its seed."""
        return str(default_rng([self.seed, 127]).choice(CONTACTS))

    @property
    def laws(self) -> dict[str, str]:
        """The law of each hidden effect that has several, drawn by the rig's seed."""
        drawn = {effect: chosen_law(effect, "random", self.seed) for effect in self.effects}
        return {effect: law for effect, law in drawn.items() if law}

    def on_rig(self, seed: int) -> HiddenCase:
        """Return the case with the same effect hidden in another rig."""
        return replace(self, seed=seed, name=f"{self.name.rsplit('-', 1)[0]}-{seed}")

    def row(self) -> dict[str, Any]:
        """Return the case as plain values."""
        return asdict(self) | {"contact": self.contact, "laws": self.laws}


def similar(name: str) -> frozenset[str]:
    """Return ``name`` with the effects that are the same thing as it is."""
    return next((group for group in SAME if name in group), frozenset({name}))


def plan(size: str, nulls: int | None = None, shift: int = 0) -> list[HiddenCase]:
    """Return the cases of a benchmark of ``size``, those of the small one first; a null keeps its rig at any number.

    "fresh" are the cases of the full one that the small one, which development looks at, does not have; they are mixed,
    so that a run that is stopped has seen all kinds. ``shift`` is added to every seed: the same plan on other rigs.
    """
    cases = [*_singles(), *_nulls(NULLS[size] if nulls is None else nulls), *_pairs(), *_outside(), *_taken_out()]
    cases = [case.on_rig(case.seed + shift) for case in cases]
    small, others = [case for case in cases if case.small], [case for case in cases if not case.small]
    others.sort(key=lambda case: crc32(case.name.encode()))
    return (small if size != "fresh" else []) + (others if size != "small" else [])


def _singles() -> Iterator[HiddenCase]:
    for place, effect in enumerate(LIBRARY_NAMES):
        for step, strength in enumerate(STRENGTHS):
            for number in range(SEEDS):
                # each case has a rig of its own, so that cases are independent of each other
                seed = FIRST_SEED["single"] + (place * len(STRENGTHS) + step) * SEEDS + number
                small = number == 0 and step == place % len(STRENGTHS)
                yield HiddenCase(f"{effect}-{strength}-{seed}", "single", (effect,), strength, seed, small=small)


def _nulls(count: int) -> Iterator[HiddenCase]:
    for seed in range(FIRST_SEED["null"], FIRST_SEED["null"] + count):
        small = seed - FIRST_SEED["null"] < NULLS["small"]
        yield HiddenCase(f"null-{seed}", "null", (), "", seed, small=small or count > NULLS["full"])


def _pairs() -> Iterator[HiddenCase]:
    for place, pair in enumerate(PAIRS):
        seed, strength = FIRST_SEED["pair"] + place, ("medium", "strong")[place % 2]
        yield HiddenCase(f"{'+'.join(pair)}-{strength}-{seed}", "pair", pair, strength, seed, small=place < 5)


def _outside() -> Iterator[HiddenCase]:
    for place, effect in enumerate(OUTSIDE_NAMES):
        for step, strength in enumerate(STRENGTHS):
            for number in range(SEEDS):
                seed = FIRST_SEED["outside"] + (place * len(STRENGTHS) + step) * SEEDS + number
                small = number == 0 and step > 0
                yield HiddenCase(f"{effect}-{strength}-{seed}", "outside", (effect,), strength, seed, small=small)


def _taken_out() -> Iterator[HiddenCase]:
    for place, effect in enumerate(TAKEN_OUT):
        seed, without = FIRST_SEED["taken_out"] + place, tuple(sorted(similar(effect)))
        name = f"without-{effect}-{seed}"
        yield HiddenCase(name, "taken_out", (effect,), "strong", seed, without, small=place % 2 == 0)
