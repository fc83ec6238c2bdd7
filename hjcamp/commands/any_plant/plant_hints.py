"""What a plant's file could say, and does not, that an answer stands on."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from hjcamp.model.declare.base_values import DELAY
from hjcamp.report.wording.units import plain, told

if TYPE_CHECKING:
    from hjcamp.diagnosis.residuals.windows import Windows
    from hjcamp.model.declare.plant import Plant

# So many times its usual size a state lies elsewhere than its file says.
ELSEWHERE = 10.0


def plant_hints(
    windows: Windows, rows: Mapping[str, Mapping[str, Any]], unknowns: Iterable[Mapping[str, Any]], left: bool
) -> list[str]:
    """Return all of these, of calibrated ``rows`` and ``unknowns`` that are shown; ``left``: no effect takes the residual."""
    measured = windows.layout.measured
    plant, found = measured.plant, early_inputs(measured.plant, rows, measured.period)
    return found + without_contact(plant, unknowns) + far_states(windows) + (without_position(plant) if left else [])


def early_inputs(plant: type[Plant], rows: Mapping[str, Mapping[str, Any]], period: float) -> list[str]:
    """Return which held inputs act earlier than logged, by half a sample of ``period`` or more: as those do that run on."""
    found = []
    for name in (name for name, item in plant.given_inputs().items() if item.hold == "previous"):
        low, high = rows.get(f"{DELAY}{name}", {}).get("ci95", (None, None))
        if high is not None and high < 0.0 and (low is None or low <= -0.5 * period):
            found.append(
                f"{name} acts {plain(-rows[f'{DELAY}{name}']['value'] / period, 2)} samples earlier than logged. One that runs on from "
                'sample to sample is half a sample early (write hold="linear" at it, and ask again), one that is logged at the end '
                "of what it held for a whole one."
            )
    return found


def without_contact(plant: type[Plant], unknowns: Iterable[Mapping[str, Any]]) -> list[str]:
    """Return that no friction was looked for where what is missing depends on the velocity of a body that no contact brakes."""
    from hjcamp.model.language.vocabulary import read_vocabulary

    ports = read_vocabulary(plant).ports.values()
    braked = {port.names.get("velocity") for port in ports if port.kind == "contact"}
    free = {port.names.get("velocity", "") for port in ports if port.kind == "body"} - braked
    found = sorted(free & {str(one["signal"]) for one in unknowns} & set(plant.states))
    return [
        f"No friction was looked for at {name}, which no contact brakes: write brake = contact(state.{name}), and take brake from its "
        "force."
        for name in found
    ]


def without_position(plant: type[Plant]) -> list[str]:
    """Return that no force over the position of a body was looked for where its file gives none."""
    from hjcamp.model.language.vocabulary import read_vocabulary

    bodies = [port for port in read_vocabulary(plant).ports.values() if port.kind == "body"]
    names = sorted({port.names.get("velocity", "") for port in bodies if "position" not in port.names} & set(plant.states))
    return [
        f"Nothing that depends on where the body of {name} stands (an unbalance, a weight, a spring) was looked for, as its position "
        f"is no state: write rate.position = state.{name} and body(..., position=state.position), though nothing measures it."
        for name in names
    ]


def far_states(windows: Windows) -> list[str]:
    """Return which states that nothing measures lie many times their usual size from 0, and what to write."""
    plant = windows.layout.measured.plant
    usual = dict(zip(plant.states, np.sqrt(np.mean(windows.starts**2, axis=0)), strict=True))
    far = [name for k, name in enumerate(plant.states) if windows.unseen[k] and usual[name] > ELSEWHERE * windows.sizes[k]]
    if not far:
        return []
    values = ", ".join(told(float(usual[name]), plant.states[name].unit) for name in far)
    return [
        f"{', '.join(far)}, which nothing measures, began at 0 and came to {values}, many times what is typical by the plant's file: "
        "write typical= and, where there is one, low= of such states there, and ask again."
    ]
