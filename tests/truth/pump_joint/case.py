"""One hidden case: a rig, what hides in it, a campaign of tests on it, and the sealed answer."""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from truth.pump_joint.controller import Procedure
from truth.pump_joint.hidden import EFFECTS, LIBRARY_NAMES
from truth.pump_joint.hidden_law import chosen_law, with_law
from truth.pump_joint.logs import write_log
from truth.pump_joint.menu import MENUS, Condition, vary
from truth.pump_joint.plant import BASE_FIELDS, Plant, draw_rig
from truth.pump_joint.scatter import Scatter, draw_test
from truth.pump_joint.simulate import COLUMNS, run

# Samples that the phases before and after the command may take at most.
OTHER_PHASES = 1600
BRASS_MASS, BRASS_WEIGHT = 0.292, 0.49
CONTACTS = ("asperities", "bristles", "smooth", "sharp")


@dataclass(frozen=True)
class Case:
    """A rig with its hidden effects and the conditions that are tested on it."""

    plant: Plant
    changes: dict[str, dict[str, float]]
    conditions: tuple[Condition, ...]
    repetitions: int
    seed: int
    payload: str = "none"
    orientation: str = "horizontal"
    scatter: Scatter = field(default_factory=Scatter)
    first_test: int = 0


def build_case(
    effects: Sequence[str] = (),
    strength: str | float = "medium",
    seed: int = 0,
    menu: str = "standard",
    repetitions: int | None = None,
    payload: str = "none",
    orientation: str = "horizontal",
    conditions: Sequence[Condition] = (),
    contact: str = "asperities",
    form: str | None = None,
) -> Case:
    """Draw a rig and a campaign from the seed and hide the named effects in it; no effect gives a null.

    ``conditions`` are tests that somebody asked for on the same rig later, in place of the menu; ``contact`` is one of
    CONTACTS. ``form`` is the law of effects that have several (`hidden_law.LAWS`): its name, "random" for one drawn by the
    seed, the first one where it is None.
    """
    unknown = [name for name in effects if name not in EFFECTS]
    if unknown:
        raise ValueError(f"effect {unknown[0]!r}: known are {', '.join(EFFECTS)}")
    if menu not in MENUS:
        raise ValueError(f"menu {menu!r}: known are {', '.join(MENUS)}")
    if contact not in CONTACTS:
        raise ValueError(f"contact {contact!r}: known are {', '.join(CONTACTS)}")
    plant = draw_rig(seed)._replace(contact_law=float(CONTACTS.index(contact)))
    changes = {}
    for name in effects:
        effect = EFFECTS[name]
        # the same draw for every strength, so that strengths of one seed differ in amplitude alone
        random = np.random.default_rng([seed, 109, list(EFFECTS).index(name)])
        changes[name] = with_law(name, chosen_law(name, form, seed), effect.build(effect.level(strength), random))
        plant = plant._replace(**changes[name])
    if payload == "brass_8p5g":
        plant = plant._replace(load_mass=plant.load_mass + BRASS_MASS)
        if orientation == "vertical":
            plant = plant._replace(weight_force=plant.weight_force + BRASS_WEIGHT)
    if repetitions is None:
        repetitions = 1 if menu == "few" else 3
    chosen = tuple(conditions) or vary(MENUS[menu], seed)
    first_test = 1000 if conditions else 0
    return Case(plant, changes, chosen, repetitions, seed, payload, orientation, first_test=first_test)


def simulate_test(case: Case, index: int, repetition: int, phases: str = "command") -> np.ndarray:
    """Return the samples of one test, shape (n, 11): the command phase alone, or "all" phases."""
    condition, plant = case.conditions[index], case.plant
    reference = condition.reference()
    draw = draw_test(case.seed, case.first_test + index, repetition, reference.size + OTHER_PHASES, case.scatter)
    # the operator stops preloading on the *readings*, so a wrong sensor makes a wrong pressure
    readings = condition.preload_mpa * 1e6 + draw.pressures
    adjustment = condition.adjustment_mpa * 1e6
    if adjustment and reference[1:].sum() < 0:
        adjustment = -0.5 * adjustment
    procedure = Procedure(
        closed_loop=float(condition.closed_loop),
        dither_volt=condition.dither_volt,
        start_pressure1=(readings[0] - plant.pressure1_offset) / plant.pressure1_gain,
        start_pressure2=(readings[1] - plant.pressure2_offset) / plant.pressure2_gain,
        adjustment_difference=adjustment,
        waiting_time=draw.waiting_time,
        previous_rest=draw.previous_rest,
        start_travel=draw.start_travel,
        start_in_play=draw.start_in_play,
    )
    if plant.stiffness_decay:
        # the rig is warmer in each repetition: as if one more test of 4 s had passed
        warmth = math.exp(-plant.stiffness_decay * 4 * repetition)
        plant = plant._replace(stiffness1=plant.stiffness1 * warmth, stiffness2=plant.stiffness2 * warmth)
    rows, first = run(plant, procedure, reference, draw.profile, draw.directions, draw.noise, draw.counts)
    return rows if phases == "all" else rows[first : first + reference.size]


def write_case(
    folder: Path | str,
    effects: Sequence[str] = (),
    strength: str | float = "medium",
    seed: int = 0,
    *,
    menu: str = "standard",
    repetitions: int | None = None,
    payload: str = "none",
    orientation: str = "horizontal",
    phases: str = "command",
    conditions: Sequence[Condition] = (),
    contact: str = "asperities",
    form: str | None = None,
) -> Path:
    """Write a case's logs `<condition>_r<k>.mcap` into `folder`; return the answer file, `<folder>.answer.json`."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    case = build_case(effects, strength, seed, menu, repetitions, payload, orientation, conditions, contact, form)
    for index, condition in enumerate(case.conditions):
        for repetition in range(case.repetitions):
            rows = simulate_test(case, index, repetition, phases)
            metadata = _metadata(case, condition, repetition)
            write_log(folder / f"{condition.name}_r{repetition + 1}.mcap", list(COLUMNS), rows, metadata)
    answer = folder.parent / f"{folder.name}.answer.json"
    forms = {"forms": {name: chosen_law(name, form, seed) for name in effects}} if form else {}
    answer.write_text(json.dumps(sealed_answer(case, strength, menu) | forms, indent=2) + "\n", encoding="utf-8")
    return answer


def sealed_answer(case: Case, strength: str | float, menu: str) -> dict[str, object]:
    """Return what a diagnosis is judged by: verdict, effects, drivers, hidden parameters and base parameters (SI)."""
    names = list(case.changes)
    outside = [name for name in names if name not in LIBRARY_NAMES]
    verdict = "cannot_tell" if menu == "few" else "nothing_missing"
    if names and menu != "few":
        verdict = "outside_library" if outside else "effect"
    hidden = {
        name: {"quantity": EFFECTS[name].quantity, "unit": EFFECTS[name].unit, "level": EFFECTS[name].level(strength)}
        for name in names
    }
    return {
        "verdict": verdict,
        "effects": names,
        "drivers": sorted({driver for name in outside for driver in EFFECTS[name].drivers}),
        "strength": strength if names else None,
        "hidden": hidden,
        "changes": case.changes,
        "base": {name: getattr(case.plant, name) for name in BASE_FIELDS},
        "seed": case.seed,
        "menu": menu,
        "repetitions": case.repetitions,
    }


def _metadata(case: Case, condition: Condition, repetition: int) -> dict[str, str]:
    return {
        "campaign": "bench",
        "condition": condition.name,
        "trajectory": condition.trajectory,
        "controller": "pid" if condition.closed_loop else "open_loop",
        "payload": case.payload,
        "orientation": case.orientation,
        "pump": "pump2",
        "amplifier": "high_gain",
        "tubing": "ldpe_300mm",
        "backend": "nidaqmx",
        "repetition": str(repetition + 1),
        "preload_mpa": f"{condition.preload_mpa:g}",
    }
