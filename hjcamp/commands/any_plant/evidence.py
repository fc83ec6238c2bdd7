"""The evidence of a diagnosis of any plant for its page: what is missing, the law, the worst test, chance, correlations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from hjcamp.commands.any_plant.verdict_words import Words
    from hjcamp.diagnosis.candidates.nonparametric_terms import Unknown
    from hjcamp.diagnosis.decision.periodic_disturbance import Swing
    from hjcamp.diagnosis.selection.scored import Scored
    from hjcamp.report.pictures.evidence import Branch, Missing

POINTS = 1500
# Models whose shares are drawn.
SHOWN = 12


def evidence_pictures(words: Words) -> dict[str, str]:
    """Return the pictures of the evidence by name, in order."""
    from hjcamp.records.log import observed
    from hjcamp.report.pictures.evidence import (
        draw_correlations,
        draw_explained,
        draw_missing,
        draw_worst_test,
    )

    analysis, verdict = words.analysis, words.verdict
    found: dict[str, str] = {}
    if words.shows_a_law:
        found |= {f"missing_{name}": svg for name, svg in draw_missing(missing_of(words)).items()}
    if verdict.swing:
        found["swing"] = draw_worst_test(*_swing(verdict.swing), observed="calibrated")
    models = {"calibrated": analysis.base}
    if verdict.effects:
        models["with what was found"] = verdict.model
    errors = {name: _without_starts(words, model) for name, model in models.items()}
    found["worst_test"] = draw_worst_test(
        *_worst_test(words, errors), observed=observed(test.log for test in analysis.measured.tests)
    )
    if verdict.named or verdict.terms:
        found["gains"] = draw_explained(*explained_of(words))
    return found | draw_correlations(*_correlations(words, errors))


def _without_starts(words: Words, model: Scored) -> Any:
    """Return a model's residuals (n, sensors), SI, without what another start of each window would explain.

    Their smooth part is that of the features, from which the starts' part is gone; what is faster is as it is.
    """
    windows = words.analysis.windows
    layout, windows.place = windows.layout, model.place
    raw = windows.errors(model.fitted.candidate)
    shape = (len(layout.of_test), raw.shape[1], layout.basis.shape[1])
    less = layout.predictions(model.fitted.features).reshape(shape) - layout.coefficients(raw)
    smooth = np.einsum("wso,to->wts", less, layout.basis).reshape(raw.shape)
    return raw + smooth * layout.measured.noise


def missing_of(words: Words) -> Missing:
    """Return what the calibrated model misses over the driver of the freest law, the named law there, and the residual."""
    from hjcamp.diagnosis.decision.free_curve import curve_of
    from hjcamp.diagnosis.decision.law_curve import law_curves

    analysis, verdict = words.analysis, words.verdict
    first = verdict.term or _same_law(words) or verdict.terms[0]
    name = next(one for one in first.names if one in analysis.search.unknowns)
    known = analysis.search.unknowns[name]
    curve = curve_of(analysis, first, name)
    law: tuple[Branch, ...] = ()
    after: tuple[Branch, ...] = ()
    added = verdict.model.beyond(analysis.base)
    if added:
        curves = law_curves(analysis, verdict.model, known, first.fitted.candidate)
        law = tuple(_law_branch(words, one) for one in curves)
        rest = _after(words, known)
        after = (_branch(curve_of(analysis, rest, name)),) if rest is not None else ()
    missing = _missing(known, curve, _branches(words, known, curve), law, after, added)
    return missing if added else replace(missing, forms=_forms(words, curve))


def _same_law(words: Words) -> Scored | None:
    """Return the non-parametric term that a named effect is a form of; None where none was fitted."""
    from hjcamp.diagnosis.candidates.equivalence import equivalent_laws

    search, verdict = words.analysis.search, words.verdict
    named = [search.library[name] for name in verdict.effects]
    for one in verdict.terms:
        known = search.unknowns[one.beyond(words.analysis.base)[0]]
        if any(equivalent_laws(known, effect) for effect in named):
            return one
    return None


def _forms(words: Words, curve: dict[str, Any]) -> tuple[Branch, ...]:
    """Return the formulas that fit the curve of the law that the answer has, over its places."""
    from hjcamp.effects._forms import FORMS
    from hjcamp.report.pictures.evidence import Branch

    found, x = words.content["formulas"], np.array(curve["x"])
    rows = [] if not found or found["none"] else found["forms"]
    values = [[one["value"] for one in row["parameters"].values()] for row in rows]
    return tuple(
        Branch(row["words"], x, FORMS[row["form"]](x, one, row.get("reference", 1.0)))
        for row, one in zip(rows, values, strict=True)
    )


def _missing(
    known: Unknown,
    curve: dict[str, Any],
    before: tuple[Branch, ...],
    law: tuple[Branch, ...],
    after: tuple[Branch, ...],
    added: Sequence[str],
) -> Missing:
    from hjcamp.report.pictures.evidence import Missing

    against = ", against the motion" if known.quantity == "friction" else ""
    driver = known.signal.replace("_", " ")
    return Missing(driver, curve["x_unit"], known.what + against, curve["y_unit"], before, law, after, " and ".join(added))


def _branches(words: Words, known: Unknown, curve: dict[str, Any]) -> tuple[Branch, ...]:
    """Return the curve of a non-parametric term, of each condition over the time of its tests where these have courses of their own."""
    from hjcamp.report.pictures.evidence import Branch
    from hjcamp.report.wording.names import readable

    if not known.apart:
        return (_branch(curve),)
    conditions = list(words.analysis.measured.conditions)
    x, *rows = (np.array(curve[key]) for key in ("x", "y", "low", "high"))
    longest = known.high - known.apart * (len(conditions) - 1)
    found = []
    for number, name in enumerate(conditions):
        own = x - number * known.apart
        inside = (own > -1e-9 * longest) & (own < (1.0 + 1e-9) * longest)
        found.append(Branch(readable(name), own[inside], *(row[inside] for row in rows)))
    return tuple(found)


def _branch(curve: dict[str, Any], way: str = "both ways") -> Branch:
    from hjcamp.report.pictures.evidence import Branch

    return Branch(way, *(np.array(curve[key]) for key in ("x", "y", "low", "high")))


def _law_branch(words: Words, curve: Any) -> Branch:
    """Return a law with the band of its amplitude: an interval of that scales the whole curve."""
    from hjcamp.report.pictures.evidence import BACKWARD, BOTH, FORWARD, Branch

    added = words.verdict.model.beyond(words.analysis.base)
    low, high = amplitude_band(words.content["candidates"], added, words.analysis.search.library)
    way = {1.0: FORWARD, -1.0: BACKWARD}.get(curve.sign, BOTH)
    ends = np.sort(np.stack([low * curve.y, high * curve.y]), axis=0)
    return Branch(way, curve.x, curve.y, ends[0], ends[1])


def amplitude_band(candidates: list[dict[str, Any]], effects: Any, library: Any) -> tuple[float, float]:
    """Return the ends of the 95 % interval of the first amplitude of one named effect, as factors; 1 and 1 for several."""
    if len(effects) != 1:
        return 1.0, 1.0
    rows: dict[str, Any] = next((row["parameters"] for row in candidates if row["effect"] == effects[0]), {})
    items = library[effects[0]].parameters
    name = next((name for name in rows if items[name].off is not None), None)
    if name is None or not rows[name]["value"] or items[name].off != 0.0 or not rows[name].get("told", True):
        return 1.0, 1.0
    ends = [end / rows[name]["value"] for end in rows[name]["ci95"]]
    return min(ends), max(ends)


def _after(words: Words, known: Unknown) -> Scored | None:
    """Return the same non-parametric term in addition to the model with what was named."""
    model = words.verdict.model
    search = words.analysis.search.at(model.place)
    none = {**known.ends, **dict.fromkeys(known.amplitudes, 0.0)}
    fitted = search.fitted(model.fitted.candidate.with_effect(known.effect.name, none))
    return fitted if np.isfinite(fitted.left_out) else None


def explained_of(words: Words) -> tuple[Any, ...]:
    """Return the arguments of the picture of what each model explains: names, shares, which are not ruled out, and delta."""
    analysis, verdict = words.analysis, words.verdict
    base = analysis.base.features
    models = dict.fromkeys(
        (verdict.model, *verdict.rivals, *([verdict.term] if verdict.term else []), *verdict.named, *verdict.terms)
    )
    found = [(one.beyond(analysis.base), analysis.channels.share(one.features, base, base)) for one in models]
    found = sorted((one for one in found if one[0]), key=lambda one: -one[1])[:SHOWN]
    kept = {*verdict.confidence_set, *([verdict.term.beyond(analysis.base)] if verdict.term else [])}
    labels = [" + ".join(label_of(analysis.search, name) for name in names) for names, _ in found]
    return labels, [share for _, share in found], [names in kept for names, _ in found], verdict.delta


def label_of(search: Any, name: str) -> str:
    """Return how a candidate is called in a picture: an effect by its name, a term by what it is and what drives it."""
    known = search.unknowns.get(name)
    return name if known is None else f"{known.quantity} over {known.signal}".replace("_", " ")


def _worst_test(words: Words, errors: dict[str, Any]) -> tuple[Any, ...]:
    """Return the arguments of the picture of the test and channel that the calibrated model predicts worst."""
    from hjcamp.report.wording.names import readable

    layout = words.analysis.windows.layout
    measured = layout.measured
    of_row = np.repeat(layout.of_test, layout.width)
    test, k = worst_of(words, errors)
    rows = np.flatnonzero(of_row == test)
    rows = rows[:: max(1, len(rows) // POINTS)]
    sensor = measured.sensors[k]
    shown = [(name, (layout.readings[rows, k] - one[rows, k]) * sensor.scale) for name, one in errors.items()]
    title = f"worst test: {readable(measured.tests[test].name)}"
    return (
        title,
        sensor.quantity.replace("_", " "),
        sensor.unit,
        layout.time[rows],
        layout.readings[rows, k] * sensor.scale,
        shown,
    )


def worst_of(words: Words, errors: dict[str, Any]) -> tuple[int, int]:
    """Return the test and the sensor that the calibrated model predicts worst, by the noise of the sensors."""
    layout = words.analysis.windows.layout
    of_row = np.repeat(layout.of_test, layout.width)
    over = np.nan_to_num(errors["calibrated"]) / layout.measured.noise
    worst = {int(test): np.mean(over[of_row == test] ** 2, axis=0) for test in np.unique(layout.of_test)}
    test = max(worst, key=lambda one: float(worst[one].max()))
    return test, int(np.argmax(worst[test]))


def _swing(swing: Swing) -> tuple[Any, ...]:
    """Return the arguments of the picture of what a model errs by over a whole test, and the sine in it."""
    from hjcamp.report.wording.names import readable

    rows, sensor = slice(0, None, max(len(swing.time) // POINTS, 1)), swing.sensor
    title = f"{readable(swing.test)}: oscillation at {swing.frequency:.4g} Hz"
    errors, line = (one[rows] * sensor.scale for one in (swing.errors, swing.line))
    return title, f"error of {sensor.quantity.replace('_', ' ')}", sensor.unit, swing.time[rows], errors, [("a sine", line)]


def _correlations(words: Words, errors: dict[str, Any]) -> tuple[list[tuple[str, Any]], list[Any]]:
    """Return the correlations of each model's errors with an input that changes, and those between repetitions.

    In the sensor that the calibrated model predicts worst; between repetitions of what the last model leaves.
    """
    from hjcamp.report.tables.correlations import correlations, of_repetitions

    layout = words.analysis.windows.layout
    of_row = np.repeat(layout.of_test, layout.width)
    edges = {int(test): np.flatnonzero(of_row == test) for test in np.unique(of_row)}
    parts = {test: slice(int(rows[0]), int(rows[-1]) + 1) for test, rows in edges.items()}
    names = [name for name in layout.measured.plant.inputs if name not in ("time", "direction")]
    inputs = {name.replace("_", " "): layout.inputs[:, k] for k, name in enumerate(names)}
    some = dict(list(inputs.items())[:1])
    _, k = worst_of(words, errors)
    left = {name: np.nan_to_num(one[:, k]) for name, one in errors.items()}
    period = layout.measured.period
    repeated = [[parts[test] for test in tests if test in parts] for tests in layout.measured.conditions.values()]
    models = [(name, correlations(one, some, list(parts.values()), period)) for name, one in left.items()]
    return models, of_repetitions(list(left.values())[-1], some, [tests for tests in repeated if tests], period)
