"""The numbers that the hand-written part of docs/thesis_gap.md names, and whether it fits the result at all."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from typing import Any

from thesis_gap_cells import FORM_SHARE

NEAR = 2.0


class Facts(dict[str, Any]):
    """Numbers by name; a model that this run did not follow to its end has none."""

    def __missing__(self, key: str) -> str:
        return "(not followed)"


def short(found: dict[str, Any], name: str) -> str:
    """Return the name by which the hand-written part calls a model: published, base, loop, or its candidates."""
    if name in ("published", "0", "1"):
        return {"published": "published", "0": "base", "1": "loop"}[name]
    return "_and_".join(found["models"][int(name)]["names"][2:])


def facts(found: dict[str, Any]) -> Facts:
    """Return the numbers that the hand-written part may name, ``<what>_<model>`` or ``<what>_<quantity>_<model>``."""
    values = Facts(form=f"{FORM_SHARE:.0%}", cells=len(found["fitted"]["printed"]))
    values["predictions"] = len(found["predicted"]["printed"])
    for kind in ("fitted", "predicted"):
        for name, errors in found[kind]["errors"].items():
            model = short(found, name)
            values[f"{kind}_near_{model}"] = near(errors)
            values[f"{kind}_loss_{model}"] = f"{found[kind]['loss'][name]:.0f}"
            values[f"{kind}_ratio_{model}"] = f"{statistics.median(ratios(found[kind], name)):.2g}"
    for number, fitted in enumerate(found["models"]):
        for name, value in fitted["values"].items():
            key = f"{name.replace('.', '_')}_{short(found, str(number))}"
            values[f"value_{key}"] = f"{value:.3g}"
            if fitted["printed"][name]:
                values[f"factor_{key}"] = f"{value / fitted['printed'][name]:.2g}"
        values |= {f"{key}_{short(found, str(number))}": text for key, text in _derived(fitted["values"]).items()}
    for place, name in enumerate(("published", "base", "loop")):
        values[f"held_{name}"] = f"{sum(row[place] for row in found['left_out'].values()):.0f}"
    twins = found["twins"]
    values |= {"twin_gain": twins["gain"], "twin_best_gain": twins["gains"][-1], "twin_p": f"{twins['p_gain']:.2f}"}
    values |= {"twin_loss": twins["loss"], "twin_worst_loss": twins["losses"][-1], "twins": len(twins["gains"])}
    for row in found["loop_gain"]:
        values[f"loop_{row['trajectory']}"] = row["least"]
        values[f"lag_{row['trajectory']}"] = row["published"]
    return values


def _derived(values: dict[str, float]) -> dict[str, str]:
    """Return the whole gain of the feedforward, and how far the bristles give way before a positive breakaway."""
    found = {"feedforward": f"{1.23 * values.get('feedforward_gain', 1.0):.2f}"}
    if "presliding.compliance" in values:
        way = values["presliding.compliance"] * values["coulomb_positive"] * values["drop_positive"]
        found |= {"give_mm": f"{1e3 * way:.1f}", "give_deg": f"{math.degrees(way / 3.41e-3):.0f}"}
    return found


def written(found: dict[str, Any], reading: str) -> str:
    """Return the hand-written part with its numbers; its first line names the accepted model for which it was written."""
    about, text = reading.split("\n", 1)
    accepted = short(found, str(found["accepted"]))
    warning = (
        "" if about == f"<!-- {accepted} -->" else f"**Written for another result; this run accepts {accepted}.**\n\n"
    )
    return warning + text.lstrip("\n").format_map(facts(found))


def near(errors: Sequence[float]) -> int:
    """Return how many errors are within two standard errors."""
    return sum(abs(error) <= NEAR for error in errors)


def ratios(cells: dict[str, Any], name: str) -> list[float]:
    """Return simulated over printed of every RMSE and largest error."""
    rows = zip(cells["labels"], cells["means"][name], cells["printed"], strict=True)
    return [mean / printed for label, mean, printed in rows if label[-1] != "sse_deg"]
