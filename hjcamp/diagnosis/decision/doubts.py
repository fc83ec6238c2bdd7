"""What speaks against a verdict: bounds that hold the base, errors that no floor explains, a delay that stands at its most."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.decision.borne_out import names_not_borne_out, not_in_windows
from hjcamp.diagnosis.estimation.intervals import intervals
from hjcamp.diagnosis.levels import FORGOTTEN, LEVEL, MATTERS, MOST_OF_IT
from hjcamp.diagnosis.residuals.simulated import ZERO
from hjcamp.diagnosis.selection.scored import Scored, Step
from hjcamp.diagnosis.validation.blocks import critical
from hjcamp.errors import plain
from hjcamp.model.declare.base_values import DELAY


def doubt_of_nothing(analysis: Analysis, p_value: float) -> str:
    """Return in words why "nothing is missing" cannot be said; empty where it can.

    So it is where the base left what it may be, or an effect takes a share that matters but is not shown to remember. Without
    repetitions it is so where most of what a sensor errs by is more than its own noise, whatever near-replicates differ by: what no
    log tells makes them differ. Where these tell nothing either, and all of the error is more than chance, it is so where a delay of
    the base stands at its most, or whole short tests show an effect.
    """
    if doubt := held_by_bounds(analysis) or _without_memory(analysis):
        return doubt
    if analysis.noise_floor.source == "repetitions":
        return ""
    shown = p_value <= LEVEL
    nearest, doubt = _nearest(analysis) if shown else "", ""
    if shown and analysis.noise_floor.source == "sensor":
        doubt = _late(analysis, p_value) or ("" if nearest else not_in_windows(analysis, analysis.search.steps[0]))
    if doubt:
        return doubt
    sensors = analysis.measured.sensors
    over = np.sqrt(
        np.mean(analysis.base.features.reshape(-1, len(sensors), analysis.windows.layout.basis.shape[1]) ** 2, axis=(0, 2))
    )
    worst = int(np.argmax(over))
    if over[worst] * (1.0 - MOST_OF_IT) <= 1.0:
        return ""
    chance = "which is more than chance" if shown else "though the library explains no more of it than chance"
    return (
        f"{sensors[worst].quantity.replace('_', ' ')} errs by {plain(over[worst], 2)} times its own noise (third differences), "
        f"{chance} (p = {plain(p_value, 2)}), and no effect and no non-parametric term is shown to explain it{nearest}; "
        f"without repetitions {len(analysis.windows.starts)} windows do not show whether that is scatter or something that no log "
        "contains: repeat a test"
    )


def doubt_of_outside(analysis: Analysis, free: Scored | None, p_value: float) -> str:
    """Return in words why no effect of the library may be ruled out; empty where it may.

    So it is where the base stands at a bound, and still does with a ``free`` law that was found; where windows are few times as long
    as an effect remembers that takes a share in them; and where an effect takes most of the error of whole tests, more than that law.
    """
    first, model = analysis.search.steps[0], free or analysis.base
    stands = [one.name for one in intervals(model.fitted, analysis.search.blocks) if not one.effect and one.at_bound]
    held = held_by_bounds(analysis) if free is None or set(analysis.held) & set(stands) else ""
    return held or _late(analysis, p_value, model) or _too_short(analysis, first) or not_in_windows(analysis, first, free)


def _too_short(analysis: Analysis, first: Step) -> str:
    """Return in words that windows are few times as long as an effect remembers that takes a share that matters; else nothing.

    In half of a window the start is to be forgotten, of which 5 % are left after three times.
    """
    search, layout = analysis.search, analysis.windows.layout
    if layout.memory:
        return ""
    width = layout.width * layout.measured.period
    for model in first.named:
        [name] = model.beyond(first.before)
        own, effect = model.fitted.candidate.effects[name], search.library[name]
        longest = max((own[key] for key, item in effect.parameters.items() if item.unit == "s" and key in own), default=0.0)
        share = search.error_ratio(model, first.before)
        if effect.states and width < 2.0 * FORGOTTEN * longest and share <= 1.0 - MATTERS:
            return (
                f"{name} explains {100.0 * (1.0 - share):.0f} % of the error, but windows of {plain(width, 2)} s are only "
                f"{plain(width / longest, 2)} "
                f"times its {plain(longest, 2)} s and do not distinguish it from other laws: make longer tests"
            )
    return ""


def doubt_of_names(analysis: Analysis, model: Scored, names: Sequence[str]) -> str:
    """Return in words what speaks against a name; empty where nothing does.

    Not named is an effect that stands at a bound, and of which the tests tell nothing, nor what whole short tests contradict.
    """
    rows = intervals(model.fitted, analysis.search.blocks)
    # of a gain whose sign is wrong next to nothing is left, of which the tests tell nothing
    alone = intervals(analysis.base.fitted, analysis.search.blocks)
    lost = (not one.effect and one.at_bound and not one.told and not one.name.startswith((DELAY, ZERO)) for one in alone)
    pushed = bool(analysis.held) or any(lost)
    for name in names:
        own = [one for one in rows if one.effect == name]
        if any(one.at_bound for one in own) and (
            not any(one.told for one in own) or (pushed and all(one.at_bound for one in own))
        ):
            return (
                f"{name} was fitted at its bound, and the data do not determine it: columns of the logs may be "
                "exchanged, or a unit or a "
                "sign be wrong"
            )
    return names_not_borne_out(analysis, model, names) if names else ""


def held_by_bounds(analysis: Analysis) -> str:
    """Return in words which base parameter its bounds keep from going on, far from what is declared; empty where none does."""
    if not analysis.held:
        return ""
    return (
        f"{analysis.held[0].replace('_', ' ')} was driven to its bound, far from what is declared: these tests do not "
        "determine it, its "
        "bounds are wrong, or it absorbs the missing effect"
    )


def _without_memory(analysis: Analysis) -> str:
    """Return in words which effect takes a share that matters, but is not shown to remember; empty where none does."""
    search, step = analysis.search, analysis.search.steps[0]
    found = [one for one in step.named if step.p_value <= step.claims and search.takes_a_share(one, step.before, step.level)]
    for model in (one for one in found if search.of_no_memory(one, step.before)):
        [name] = model.beyond(step.before)
        took = 100.0 * (1.0 - search.error_ratio(model, step.before))
        return (
            f"{name} explains {took:.0f} % of the error block by block, but is not shown to remember, and no law without "
            "memory is shown to explain as much: something is missing, but these tests do not show what"
        )
    return ""


def _late(analysis: Analysis, p_value: float, model: Scored | None = None) -> str:
    """Return in words which input's delay stands at the most that the base, or a model, may have; empty where none does."""
    for one in intervals((model or analysis.base).fitted, analysis.search.blocks):
        if not one.effect and one.name.startswith(DELAY) and one.at_bound and one.value > 0.0:
            name = one.name.removeprefix(DELAY).replace("_", " ")
            return (
                f"the delay of {name} is at the largest that the base may have, and the residual exceeds chance "
                f"(p = {plain(p_value, 2)}): something later is missing, but not shown block by block"
            )
    return ""


def _nearest(analysis: Analysis) -> str:
    """Return in words which effect takes most of what matters, where one does: in too few blocks to be shown."""
    search = analysis.search
    found = [(search.error_ratio(one, step.before), one, step) for step in search.steps for one in step.named]
    left, model, step = min(found, key=lambda one: one[0], default=(1.0, analysis.base, None))
    if step is None or left > 1.0 - MATTERS:
        return ""
    [name] = model.beyond(step.before)
    t, count = search.t(model, step.before)
    # of less than two no spread is known
    seen = f"not block by block: t = {t:.1f}, {critical(count, step.level):.1f} needed"
    seen = seen if count >= 2.0 else "in too few parts of the tests"
    return f" ({name} would leave {100.0 * left:.0f} % of it, but {seen})"
