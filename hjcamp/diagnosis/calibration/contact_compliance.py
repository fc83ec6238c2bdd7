"""The form of a contact: how it gives way before it slips, which a model of dry friction leaves open and no test is asked for.

A rig's contact has bristles of micrometres; a model that lets it stick and slip at once errs about each reversal, and laws of
other kinds bend towards that error. Where it is seen and small, the base has it; where it is large, it is an effect like others.
"""

from __future__ import annotations

import math
from collections.abc import Container, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.estimation.gauss_newton import Fitted
from hjcamp.diagnosis.levels import GRANTED
from hjcamp.diagnosis.residuals.initial_states import rate_of
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.diagnosis.selection.search import Search
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.port import Port
from hjcamp.model.language.amount import dimension
from hjcamp.model.language.vocabulary import read_vocabulary

# Of the usual speed: below it a contact may come to rest.
AT_REST = 0.05
# What is tried, in shares of what is granted.
TRIED = (0.1, 0.3, 1.0, 5.0)


def forms_among(library: Mapping[str, type[Effect]]) -> dict[str, type[Effect]]:
    """Return the effects that are forms of a contact."""
    return {name: effect for name, effect in library.items() if effect.granted}


def with_contact_forms(search: Search, base: Scored, shown: Container[str] = ()) -> Scored:
    """Return the base with the form of each contact that the tests show, and is granted; the best fits are kept as starts.

    What was ``shown`` in windows of another length needs no more than to predict better here.
    """
    windows = search.windows
    for port in read_vocabulary(windows.layout.measured.plant).ports.values():
        before, forms, slides = base, windows.forms, windows.slides
        names = _forms(search, port)
        had = {name for name in names if name in before.names}
        # of a saved model: within what is granted it is a form like others
        forms |= {
            name for name in had if _own(search, before, name) <= _granted(search, before.fitted, search.library[name], port)
        }
        kept = forms, slides
        for name in [] if had else names:
            search.report(f"trying friction variants of {port.name.replace('_', ' ')}", 0.5)
            windows.forms, windows.slides, windows.place = forms | {name}, None, before.place
            found = _with_form(search, before, name, port, slides)
            # one that chance may give is none: it makes a rough base, beside which little is promised of what is missing
            if found is not None and found.left_out < base.left_out and (name in shown or search.beats(found, before)):
                base, kept = found, (windows.forms, windows.slides)
        windows.forms, windows.slides = kept
    windows.place = base.place
    return base


def _forms(search: Search, port: Port) -> list[str]:
    """Return the names of the effects that are forms of this contact."""
    return [name for name, one in forms_among(search.library).items() if port.names.get("friction") in one.terms]


def _with_form(search: Search, before: Scored, name: str, port: Port, others: NDArray[np.bool_] | None) -> Scored | None:
    """Return the base with this form of a contact, if it fits within what is granted; ``others`` slide in these windows."""
    effect, windows = search.library[name], search.windows
    most = _granted(search, before.fitted, effect, port)
    if most <= 0.0:
        return None
    best = search.best_of(list(_tried(search, before.fitted, effect, most)), before.fitted)
    if not np.isfinite(best.loss):
        return None
    search.begins[name] = dict(best.candidate.effects[name])
    if best.candidate.effects[name][effect.granted] > TRIED[-1] * most:
        return None
    windows.slides = _slides(search, best, port, others)
    found = search.fitted(best.candidate, best)
    if not found.left_out < before.left_out:
        return None
    found = search.resettled(found)
    search.begins[name] = dict(found.fitted.candidate.effects[name])
    return found if _own(search, found, name) <= most else None


def _own(search: Search, found: Scored, name: str) -> float:
    """Return how far a contact gives way in a fit."""
    return found.fitted.candidate.effects[name][search.library[name].granted]


def _granted(search: Search, fitted: Fitted, effect: type[Effect], port: Port) -> float:
    """Return what is granted to a contact of a speed, or of a deflection for each unit of friction; 0 where unknown."""
    plant: Any = search.windows.layout.measured.plant
    unit, velocity = effect.parameters[effect.granted].unit, port.names["velocity"]
    if dimension(unit) == dimension(plant.states[velocity].unit):
        return AT_REST * _usual_speed(_speed(search, fitted, port))
    travel = port.names.get("travel") or rate_of(plant).get(velocity, "")
    low, high = search.ranges.get(travel, (0.0, 0.0))
    friction = max((abs(one) for one in search.ranges.get(port.names["static"], (0.0, 0.0))), default=0.0)
    return GRANTED * (high - low) / friction if friction > 0.0 else 0.0


def _speed(search: Search, fitted: Fitted, port: Port) -> NDArray[np.float64]:
    """Return the velocity of a contact in all windows (n,)."""
    windows = search.windows
    place = list(windows.layout.measured.plant.states).index(port.names["velocity"])
    return np.asarray(windows.readings(fitted.candidate)[1][:, place])


def _usual_speed(speed: NDArray[np.float64]) -> float:
    return math.sqrt(float(np.mean(speed**2)))


def _slides(search: Search, fitted: Fitted, port: Port, others: NDArray[np.bool_] | None) -> NDArray[np.bool_]:
    """Return in which windows (windows,) this contact slides all the time, one way, and so do ``others``."""
    speed = _speed(search, fitted, port)
    each = speed.reshape(len(search.windows.starts), -1)
    least = AT_REST * _usual_speed(speed)
    found = (each.min(axis=1) > least) | (each.max(axis=1) < -least)
    return np.asarray(found if others is None else found & others)


def _tried(search: Search, before: Fitted, effect: type[Effect], most: float) -> Iterator[Candidate]:
    """Yield the model with the form that is known of windows of another length, else with several compliances.

    Each with the other shapes as usual, and with one of them least.
    """
    known, usual = search.begins.get(effect.name), effect.defaults()
    others = [item for item in effect.parameters.values() if item.shape and item.name != effect.granted]
    shapes = [{}, *({item.name: item.bounds[0]} for item in others)]
    for own in [known] if known else [{**usual, effect.granted: share * most, **one} for share in TRIED for one in shapes]:
        yield before.candidate.with_effect(effect.name, own)
