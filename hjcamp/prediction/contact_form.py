"""The form of a contact: how it gives way before it slips, which a model of dry friction leaves open and no test is asked for.

A rig's contact has bristles of micrometres; a model that lets it stick and slip at once errs about each reversal, and laws of
other kinds bend towards that error. Where it is seen and small, the base has it; where it is large, it is an effect like others.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.candidate import Candidate
from hjcamp.model.effect import Effect
from hjcamp.model.port import Port
from hjcamp.model.vocabulary import read_vocabulary
from hjcamp.prediction.fitting import Fitted
from hjcamp.prediction.levels import GRANTED
from hjcamp.prediction.selection import Scored, Search
from hjcamp.prediction.starts import rate_of

# Of the usual speed: below it a contact may come to rest.
AT_REST = 0.05
# What is tried, in shares of the travel per friction that is granted.
TRIED = (0.1, 0.3, 1.0, 5.0)


def with_contact_forms(search: Search, base: Scored) -> Scored:
    """Return the base with the form of each contact that the tests show, and is granted; the best fits are kept as starts."""
    for name, effect in search.library.items():
        if name in base.names:
            continue
        for port in _contacts(search, effect):
            most = _granted(search, base.fitted, port)
            if most <= 0.0:
                continue
            search.report(f"form of {port.name.replace('_', ' ')}", 0.5)
            windows, before = search.windows, (search.windows.forms, search.windows.slides)
            windows.forms, windows.slides = windows.forms | {name}, None
            best = search.best_of(list(_tried(search, base.fitted, effect, most)), base.fitted)
            if np.isfinite(best.loss):
                search.begins[name] = dict(best.candidate.effects[name])
                if best.candidate.effects[name][effect.granted] <= most:
                    windows.slides = _slides(search, best, port, before[1])
                    found = search.resettled(search.fitted(best.candidate, best))
                    small = found.fitted.candidate.effects[name][effect.granted] <= most
                    # it is claimed of nobody: what predicts chapters left out better is taken
                    if small and found.left_out < base.left_out:
                        base = found
                        search.begins[name] = dict(found.fitted.candidate.effects[name])
                        continue
            windows.forms, windows.slides = before
    search.windows.place = base.place
    return base


def _contacts(search: Search, effect: type[Effect]) -> Iterator[Port]:
    """Yield the contact whose form an effect is, where it is one."""
    if not effect.granted:
        return
    for port in read_vocabulary(search.windows.layout.measured.plant).ports.values():
        if port.names.get("friction") in effect.terms:
            yield port


def _granted(search: Search, fitted: Fitted, port: Port) -> float:
    """Return the deflection for each unit of friction that is granted to a contact, by its travel in the tests; 0 where unknown."""
    plant: Any = search.windows.layout.measured.plant
    travel = port.names.get("travel") or rate_of(plant).get(port.names["velocity"], "")
    low, high = search.ranges.get(travel, (0.0, 0.0))
    friction = max((abs(one) for one in search.ranges.get(port.names["static"], (0.0, 0.0))), default=0.0)
    return GRANTED * (high - low) / friction if friction > 0.0 else 0.0


def _slides(search: Search, fitted: Fitted, port: Port, others: NDArray[np.bool_] | None) -> NDArray[np.bool_]:
    """Return in which windows (windows,) this contact slides all the time, one way, and so do ``others``."""
    windows = search.windows
    plant = windows.layout.measured.plant
    speed = windows.readings(fitted.candidate)[1][:, list(plant.states).index(port.names["velocity"])]
    each = speed.reshape(len(windows.starts), -1)
    least = AT_REST * math.sqrt(float(np.mean(speed**2)))
    found = (each.min(axis=1) > least) | (each.max(axis=1) < -least)
    return found if others is None else found & others


def _tried(search: Search, before: Fitted, effect: type[Effect], most: float) -> Iterator[Candidate]:
    """Yield the model with the form that is known of windows of another length, else with several compliances.

    Each with the other shapes as usual, and with one of them least.
    """
    known, usual = search.begins.get(effect.name), effect.defaults()
    others = [item for item in effect.parameters.values() if item.shape and item.name != effect.granted]
    shapes = [{}, *({item.name: item.bounds[0]} for item in others)]
    for own in (
        [known] if known else [{**usual, effect.granted: share * most, **one} for share in TRIED for one in shapes]
    ):
        yield before.candidate.with_effect(effect.name, own)
