"""From the study's ledger to the numbers of its page: plain values, committed as docs/thesis_gap.json."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from thesis_gap_cells import Cells, cells_for, robust
from thesis_gap_checks import PREDICTED, TWINS
from thesis_gap_search import Quantity, base_quantities, candidate_quantities
from thesis_gap_study import candidates

from hjcamp.report.published import published_cells

ALIKE = 0.8
INSIDE = 0.2


def results(ledger: Mapping[str, Any], cells: Cells) -> dict[str, Any]:
    """Return everything that the page says, as plain values."""
    predicted = cells_for(_conditions(PREDICTED), PREDICTED)
    accepted = int(ledger["accepted"])
    models = range(sum(1 for name in ledger if name.startswith("model ")))
    names = ["published", *map(str, models)]
    steps = range(1, 1 + sum(1 for name in ledger if name.endswith("refined control")))
    return {
        "fitted": _cells(cells, {name: ledger[f"table {name}"] for name in names}),
        "predicted": _cells(predicted, {name: ledger[f"prediction {name}"] for name in names}),
        "accepted": accepted,
        "models": [_model(ledger, number) for number in models],
        "steps": [_step(ledger, step) for step in steps],
        "left_out": _left_out(ledger, cells),
        "twins": _twins(ledger, cells),
        "alike": _alike(ledger),
        "loop_gain": loop_gain(),
    }


def _conditions(tables: Sequence[str]) -> list[dict[str, str]]:
    found: list[dict[str, str]] = []
    for row in published_cells().iter_rows(named=True):
        place = {key: row[key] for key in ("trajectory", "controller", "payload", "orientation")}
        if row["table"] in tables and place not in found:
            found.append(place)
    return found


def _cells(cells: Cells, tables: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    count = range(len(cells.printed))
    found: dict[str, Any] = {
        "labels": [list(cells.label(cell)) for cell in count],
        "printed": cells.printed.tolist(),
        "sigma": cells.sigma.round(4).tolist(),
        "means": {},
        "errors": {},
        "loss": {},
    }
    for name, table in tables.items():
        values = np.array(table["means"])
        errors = cells.errors(values)
        found["means"][name] = values.round(3).tolist()
        found["errors"][name] = errors.round(2).tolist()
        found["loss"][name] = round(float(robust(errors).sum()), 1)
    return found


def _model(ledger: Mapping[str, Any], number: int) -> dict[str, Any]:
    model = ledger[f"model {number}"]
    ending = f" model {number}"
    folds = [found["values"] for name, found in ledger.items() if name.startswith("without ") and name.endswith(ending)]
    ranges = (
        {name: [min(f[name] for f in folds), max(f[name] for f in folds)] for name in model["values"]} if folds else {}
    )
    return {
        "names": model["names"],
        "values": {name: float(f"{value:.4g}") for name, value in model["values"].items()},
        "printed": {one.name: one.parameter.default for one in _quantities(model["names"])},
        "units": {one.name: one.parameter.unit for one in _quantities(model["names"])},
        "ranges": {name: [float(f"{value:.3g}") for value in pair] for name, pair in ranges.items()},
        "surprise": round(float(model["surprise"]), 1),
        "quantities": len(model["values"]),
    }


def _quantities(names: Sequence[str]) -> list[Quantity]:
    return base_quantities() + [one for name in names for one in candidate_quantities(name)]


def _step(ledger: Mapping[str, Any], step: int) -> dict[str, Any]:
    def loss(stage: str, name: str, ending: str = "") -> float | None:
        key = f"step {step} {stage} {name}{ending}"
        return float(ledger[key]["loss"]) if key in ledger else None

    gains: dict[str, list[float | None]] = {}
    for name in candidates():
        if loss("here", name) is None:
            continue
        longer = [
            value for start in ("here", "fresh") if (value := loss("refined", name, f" from {start}")) is not None
        ]
        pairs = [(loss(start, "control"), loss(start, name)) for start in ("here", "fresh")]
        pairs.append((loss("refined", "control"), min(longer, default=None)))
        gains[name] = [round(a - b, 1) if a is not None and b is not None else None for a, b in pairs]
    control = [round(loss(start, "control") or 0.0, 1) for start in ("here", "fresh", "refined")]
    return {"control": control, "gains": gains}


def _left_out(ledger: Mapping[str, Any], cells: Cells) -> dict[str, Any]:
    trajectories = list(dict.fromkeys(condition["trajectory"] for condition in cells.conditions))
    published = np.array(ledger["published errors"])
    found: dict[str, Any] = {}
    for trajectory in trajectories:
        outside = np.array([cells.label(cell)[0] == trajectory for cell in range(len(cells.printed))])
        found[trajectory] = [round(float(robust(published[outside]).sum()), 1)]
        for number in (0, 1):
            errors = np.array(ledger[f"without {trajectory} model {number} errors"])
            found[trajectory].append(round(float(robust(errors).sum()), 1))
    return found


def _twins(ledger: Mapping[str, Any], cells: Cells) -> dict[str, Any]:
    def gain(key: str) -> float:
        return float(ledger[f"{key} without"]["loss"] - ledger[f"{key} with"]["loss"])

    accepted = np.array(ledger[f"table {ledger['accepted']}"]["means"])
    loss = float(robust(cells.errors(accepted)).sum())
    gains = [gain(f"twin {number}") for number in range(TWINS)]
    losses = [float(ledger[f"twin {number} of accepted"]) for number in range(TWINS)]
    found = gain("twin real")
    return {
        "gain": round(found, 1),
        "gains": sorted(round(value, 1) for value in gains),
        "p_gain": round((1 + sum(value >= found for value in gains)) / (1 + TWINS), 3),
        "loss": round(loss, 1),
        "losses": sorted(round(value, 1) for value in losses),
        "p_loss": round((1 + sum(value >= loss for value in losses)) / (1 + TWINS), 3),
    }


def _alike(ledger: Mapping[str, Any]) -> dict[str, Any]:
    own = np.array(ledger["responses"]["own"]).T
    basis, _ = np.linalg.qr(own)
    left, inside = {}, []
    for name, response in ledger["responses"]["other"].items():
        column = np.array(response)
        size = float(np.linalg.norm(column))
        rest = column - basis @ (basis.T @ column)
        if size < 1e-6 or float(np.linalg.norm(rest)) < INSIDE * size:
            inside.append(name)
        else:
            left[name] = rest / np.linalg.norm(rest)
    pairs = [
        [first, second, round(float(left[first] @ left[second]), 2)]
        for place, first in enumerate(left)
        for second in list(left)[place + 1 :]
        if abs(float(left[first] @ left[second])) > ALIKE
    ]
    return {"inside": inside, "pairs": pairs}


def loop_gain() -> list[dict[str, Any]]:
    """Return what the ramps say without any simulation: how much stronger the integral acts than printed.

    In a steady ramp of 120 deg/s the integral alone turns the pump, so the mean error is 120 / (K_i k), and RMSE2 is at
    least that: k >= 120 / (K_i RMSE2) with the largest RMSE2 that rounds to the printed one.
    """
    found = []
    for trajectory, gain in (("ramp_pos", 70.0), ("ramp_neg", 90.0)):
        for row in published_cells().iter_rows(named=True):
            place = (row["table"], row["trajectory"], row["controller"], row["indicator"])
            if place == ("5.4.1", trajectory, "pid", "rmse2_deg"):
                printed = row["mean"]
                values = {"trajectory": trajectory, "printed": printed, "published": round(120 / gain, 2)}
                found.append(values | {"least": round(120 / (gain * (printed + 0.05)), 2)})
    return found
