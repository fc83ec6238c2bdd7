"""Find the effects that are missing: screen all, fit the best, step forward while it matters, then score the rivals."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fit, Fitter
from hjcamp.plants.pump_joint.diagnosis.models.unknowns import (
    Unknown,
    base_unknowns,
    beside_known,
    effect_unknowns,
    read,
    surprise,
    written,
)
from hjcamp.plants.pump_joint.diagnosis.screening.normal_equations import Gram, Group, Known, all_gains
from hjcamp.plants.pump_joint.diagnosis.screening.responses import Probe, probe_all, strength_is_a_shape

Array = NDArray[np.float64]
FACTORS = (0.3, 1.0, 2.5)
WORTH = 4.0
SHAPES = 3
# Static friction of less than this over Coulomb friction is none: nothing sticks and slips by it.
LOST = 1.05
SHAPE_STEPS = 4
Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class Screening:
    """Gains of every effect about one fitted model, predicted from its finite responses.

    ``ranked`` holds the probes of each effect with their coefficients, the largest gain first. ``instead`` holds, for the
    effects that promise more there, the screening about the same model with the published shape of friction.
    """

    about: Fit
    noise_floor: Array
    probes: list[Probe]
    gram: Gram
    known: Known
    gains: dict[str, float]
    unknowns: list[Unknown]
    ranked: dict[str, list[tuple[Probe, Array]]] = field(default_factory=dict)
    instead: dict[str, Screening] = field(default_factory=dict)

    @property
    def jacobian(self) -> Array:
        """The responses (unknowns, blocks, channels) of the unknowns in the model."""
        return self.gram.columns[: len(self.unknowns)]

    @property
    def best(self) -> dict[str, tuple[Probe, Array]]:
        """The probe of each effect that gains most, and its coefficients."""
        return {name: found[0] for name, found in self.ranked.items()}

    @property
    def groups(self) -> list[Group]:
        """The columns of each probe behind those of the unknowns in the model."""
        base = len(self.unknowns)
        return [
            Group(tuple(base + column for column in one.columns), one.signed, np.array(one.shifts).reshape(-1, base))
            for one in self.probes
        ]


@dataclass(frozen=True, eq=False)
class Step:
    """One step forward: the screening, the fits of its survivors, their weights, and the chance of such a gain.

    ``null_gains`` (twins,) are the largest gains of twins of the model before this step.
    """

    screening: Screening
    fits: dict[str, Fit]
    weights: dict[str, float]
    p_value: float
    null_gains: Array

    @property
    def best(self) -> str:
        """The effect of the largest weight: of two that fit alike the one that asks less."""
        return max(self.weights, key=lambda name: self.weights[name])

    @property
    def gain(self) -> float:
        """By how much the loss falls with the best effect."""
        return self.gain_of(self.best)

    def gain_of(self, name: str) -> float:
        """Return by how much the loss falls with an effect that was fitted."""
        return self.screening.about.loss - self.fits[name].loss

    def chance_of(self, name: str) -> float:
        """Return how often a twin of the model before this step gains as much as an effect that was fitted."""
        return float((1 + np.sum(self.null_gains >= self.gain_of(name))) / (1 + len(self.null_gains)))


def by_gain(
    probes: Sequence[Probe], gains: Array, coefficients: Sequence[Array]
) -> dict[str, list[tuple[Probe, Array, float]]]:
    """Return for each effect its probes, their coefficients and gains, the largest gain first."""
    found: dict[str, list[tuple[Probe, Array, float]]] = {}
    for probe, gain, coefficient in zip(probes, gains, coefficients, strict=True):
        found.setdefault(probe.effect, []).append((probe, coefficient, float(gain)))
    return {name: sorted(rows, key=lambda row: -row[2]) for name, rows in found.items()}


def screen(fitter: Fitter, about: Fit, effects: Sequence[type[Effect]], names: Collection[str] | None = None) -> Screening:
    """Return the predicted gain of every effect beside the base parameters and the effects already in the model.

    With ``names`` only these are looked at, with an empty collection only what is in the model already. Where the base has
    lost its static friction, which an effect may have taken, it is looked for beside the published shape of friction, too.
    """
    found = _screen_about(fitter, about, effects, names)
    shaped = with_static_friction(about.candidate)
    if shaped is None or not found.gains:
        return found
    other = _screen_about(fitter, fitter.fit(shaped, unknowns_of(shaped, effects), steps=SHAPE_STEPS), effects, names)
    # A fit may gain twice its prediction; of that the other shape has to make up what it is behind.
    behind = 0.5 * (other.about.loss - about.loss)
    better = {
        name: gain - behind
        for name, gain in other.gains.items()
        if name in other.ranked and name in found.ranked and gain - behind > found.gains[name]
    }
    return replace(found, gains=found.gains | better, instead=dict.fromkeys(better, other))


def with_static_friction(candidate: Candidate) -> Candidate | None:
    """Return the candidate with the published ratio of static to Coulomb friction in the directions that have lost it.

    None where both directions have static friction.
    """
    published = {name: parameter.default for name, parameter in PumpJoint.parameters.items()}
    given = {**published, **candidate.base}
    lost = {
        f"static_{sign}": given[f"coulomb_{sign}"] * published[f"static_{sign}"] / published[f"coulomb_{sign}"]
        for sign in ("positive", "negative")
        if given[f"static_{sign}"] < LOST * given[f"coulomb_{sign}"]
    }
    return candidate.with_base(lost) if lost else None


def _screen_about(fitter: Fitter, about: Fit, effects: Sequence[type[Effect]], names: Collection[str] | None) -> Screening:
    noise_floor = fitter.features.noise_floor(about.features)
    here = base_unknowns()
    for effect in effects:
        if effect.name in about.candidate.effects:
            here += effect_unknowns(effect)
    known = Known(np.array([unknown.spread for unknown in here]) ** -2.0, beside_known(about.candidate, here))
    wanted = {effect.name for effect in effects} if names is None else set(names)
    left = [effect for effect in effects if effect.name in wanted - set(about.candidate.effects)]
    jacobian = fitter.jacobian(about, here)
    probes, columns = probe_all(fitter, about, noise_floor, left, here, jacobian)
    gram = Gram.of(np.concatenate([jacobian, columns]), fitter.features, fitter.least)
    screening = Screening(about, noise_floor, probes, gram, known, {}, here)
    gains, coefficients = all_gains(gram, about.features, known, screening.groups)
    found = by_gain(probes, gains, coefficients)
    visible = {effect.name: found[effect.name][0][2] if effect.name in found else 0.0 for effect in left}
    ranked = {name: [(probe, coefficient) for probe, coefficient, _ in rows] for name, rows in found.items()}
    return Screening(about, noise_floor, probes, gram, known, visible, here, ranked)


def started(screening: Screening, effect: type[Effect], factor: float = 1.0, rank: int = 0) -> Candidate:
    """Return the model with ``effect`` at ``factor`` times the amplitude that the screening predicts for a probe."""
    probe, found = screening.ranked[effect.name][rank]
    coefficients, move = found[len(screening.unknowns) :], found[: len(screening.unknowns)].copy()
    for coefficient, shift in zip(coefficients, probe.shifts, strict=True):
        move += float(coefficient) * np.array(shift)
    parameters = {**effect.defaults(), **probe.parameters}
    heights = dict(zip(probe.lifted, probe.heights, strict=True))
    for name, value in probe.lifts(coefficients).items():
        if name == probe.angle:
            parameters[name] = value
            continue
        low, high = effect.parameters[name].bounds
        least = 0.05 * factor * abs(heights[name])
        parameters[name] = min(max(factor * value if abs(factor * value) > least else least, low), high)
    for name, parameter in effect.parameters.items():
        if parameter.off is not None and name not in probe.lifted and not parameter.shape:
            parameters[name] = parameter.off
    candidate = screening.about.candidate
    places = read(candidate, screening.unknowns) + factor * np.clip(move, -1.0, 1.0)
    return written(candidate, screening.unknowns, places).with_effect(effect.name, parameters)


def unknowns_of(candidate: Candidate, effects: Sequence[type[Effect]]) -> list[Unknown]:
    """Return the base parameters and the parameters of the effects in a candidate."""
    found = base_unknowns()
    for effect in effects:
        if effect.name in candidate.effects:
            found += effect_unknowns(effect)
    return found


def starts_of(screening: Screening, effect: type[Effect]) -> list[tuple[int, ...]]:
    """Return the ranks of the probes among which each fit of an effect chooses its start: one fit for most effects.

    Where the strength itself is a shape the loss has several valleys, of which no straight line tells: a fit for each.
    """
    ranks = range(min(SHAPES, len(screening.instead.get(effect.name, screening).ranked[effect.name])))
    return [(rank,) for rank in ranks] if strength_is_a_shape(effect) else [tuple(ranks)]


def fit_effect(fitter: Fitter, screening: Screening, effect: type[Effect], effects: Sequence[type[Effect]], steps: int) -> Fit:
    """Return the joint fit of one more effect, the best of those from its starts."""
    fits = [fit_from(fitter, screening, effect, effects, steps, ranks) for ranks in starts_of(screening, effect)]
    return min(fits, key=lambda fit: fit.loss)


def fit_from(
    fitter: Fitter,
    screening: Screening,
    effect: type[Effect],
    effects: Sequence[type[Effect]],
    steps: int,
    ranks: Sequence[int],
) -> Fit:
    """Return the joint fit of one more effect, from the best start that the screening's probes of these ranks give."""
    begun = best_start(fitter, screening, effect, ranks)
    start = begun.candidate
    here = unknowns_of(start, effects)
    calm = fitter.smooth()
    smooth = calm.fit(start, here, steps=3 * steps, enough=0.1)
    first, second = sorted((begun, fitter.look(smooth.candidate)), key=lambda fit: fit.loss)
    found = fitter.fit(first.candidate, here, steps=steps, enough=0.05)
    # Slips answer too wildly to lead there from a start where lines and forces are far better.
    if second.candidate is smooth.candidate and calm.look(found.candidate).loss > smooth.loss + WORTH:
        other = fitter.fit(second.candidate, here, steps=2 * steps, enough=0.05)
        found = min(found, other, key=lambda fit: fit.loss)
    if strength_is_a_shape(effect):
        # The base goes first, so that the strength does not run away while it stands where it cannot be right.
        held = fitter.fit(start, [unknown for unknown in here if unknown.effect != effect.name], steps=SHAPE_STEPS)
        found = min(found, fitter.fit(held.candidate, here, steps=steps, enough=0.05), key=lambda fit: fit.loss)
    return found


def best_start(fitter: Fitter, screening: Screening, effect: type[Effect], ranks: Sequence[int] = (0,)) -> Fit:
    """Return the best of what the screening's probes of these ranks predict for one more effect, not fitted."""
    screening = screening.instead.get(effect.name, screening)
    looked = [fitter.look(started(screening, effect, factor, rank)) for rank in ranks for factor in FACTORS]
    return min(looked, key=lambda fit: fit.loss)


def refit_without(fitter: Fitter, fit: Fit, name: str, effects: Sequence[type[Effect]], steps: int) -> Fit:
    """Return the fit without one of its effects."""
    candidate = fit.candidate.without([name])
    return fitter.fit(candidate, unknowns_of(candidate, effects), steps=steps, enough=0.05)


def asks(candidate: Candidate, effects: Sequence[type[Effect]]) -> float:
    """Return what a model asks: the surprise of its base parameters and of the sizes of its effects, where something is
    known of them, and 2 for each amplitude and shape.
    """
    named = [(effect.parameters, candidate.effects[effect.name]) for effect in effects if effect.name in candidate.effects]
    number = sum(one.shape or one.off is not None for known, _ in named for one in known.values())
    unusual = sum(known[name].unusual(value) ** 2 for known, given in named for name, value in given.items())
    return float(np.sum(surprise(candidate, base_unknowns()) ** 2)) + 2.0 * number + unusual


def rival_weights(fits: dict[str, Fit], least: Array, effects: Sequence[type[Effect]]) -> dict[str, float]:
    r"""Return the weight of each fitted model beside the best one, from the differences test by test.

    .. math:: w = \min\bigl(2 \Phi(-d / s),\ e^{-d / 2}\bigr)\ e^{-(k - k_{best}) / 2}

    with d the difference of the logarithms of error, s its standard error, and k what the model asks, which does not scatter
    from test to test: the squared standard deviations by which it moves base parameters that are known beforehand, and 2
    for each amplitude and shape of its effects (Akaike 1974, doi:10.1109/TAC.1974.1100705).

    The unit of evidence is the test: the sum of differences of log error over its standard error is a standard normal
    deviate for models that fit alike (Vuong 1989, Econometrica 57(2), 307-333). A few clear tests among many silent ones
    scatter much, so that the likelihood ratio counts where it is smaller: as if each test were one sample in each channel.
    """
    from scipy.special import ndtr

    losses = {name: np.log(fit.mean_square + least**2).sum(axis=1) for name, fit in fits.items()}
    asked = {name: asks(fit.candidate, effects) for name, fit in fits.items()}
    best = min(fits, key=lambda name: fits[name].loss)
    weights = {}
    for name, loss in losses.items():
        difference = loss - losses[best]
        error = np.std(difference, ddof=1) * np.sqrt(len(difference)) if len(difference) > 1 else 1.0
        behind = max(float(difference.sum()), 0.0)
        weights[name] = min(float(2.0 * ndtr(-behind / max(error, 0.7))), np.exp(-0.5 * behind))
        weights[name] *= np.exp(-0.5 * (asked[name] - asked[best]))
    total = sum(weights.values())
    return {name: weight / total for name, weight in weights.items()}
