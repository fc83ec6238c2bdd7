"""Simulated twins of the user's own campaign: the same pump motion on a rig that is exactly the fitted model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.scatter import coloured
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fit
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence, TestEvidence
from hjcamp.plants.pump_joint.diagnosis.measured.repetition import RepetitionScatter
from hjcamp.plants.pump_joint.diagnosis.measured.signals import (
    PERIOD,
    STRIDE,
    breakaways,
    misfit_of,
    slider_motion,
    smooth,
)
from hjcamp.plants.pump_joint.diagnosis.models.unknowns import base_unknowns
from hjcamp.plants.pump_joint.diagnosis.residuals.features import Features
from hjcamp.plants.pump_joint.diagnosis.residuals.views import CHANNELS, Views

Array = NDArray[np.float64]
DRIFT_TIME = 0.05
LEAST_LENGTH = 1e-4
DIFFERENCE, SUM, SLIDING = (CHANNELS.index(name) for name in ("difference", "line_sum", "sliding"))


def imperfect(candidate: Candidate, generator: np.random.Generator) -> Candidate:
    """Return the candidate with the parameters that are only known to within a spread drawn anew."""
    base = dict(candidate.base)
    for unknown in base_unknowns(PumpJoint.uncertain):
        value = base.get(unknown.name, unknown.parameter.default)
        base[unknown.name] = unknown.back(unknown.forth(value) + unknown.spread * generator.standard_normal())
    return Candidate(base, candidate.effects)


def match_scatter(views: Views, fit: Fit, scatter: RepetitionScatter, rounds: int = 4) -> RepetitionScatter:
    """Return the scatter with which the floor of twins is the floor of the measurements.

    Friction sets the floors of the pressure difference in the joint view and of the sliding force, slow pressure noise
    that of the line sum. Conditions count alike: one that hunts would else speak for all.
    """
    if not views.evidence.repeated:
        return scatter
    features = Features(views.evidence)
    noise_floor = features.floor_by_condition(fit.features)
    for number in range(rounds):
        copied = make_twin(views, fit.candidate, scatter, 10_000 + number)
        own = Features(copied)
        found = own.floor_by_condition(own.of(Views(copied, views.effects, views.crew).residuals(fit.candidate)))
        with np.errstate(all="ignore"):
            ratios = np.log(noise_floor / found)
        seen = ratios[:, [DIFFERENCE, SLIDING]]
        ratio = float(np.exp(np.clip(np.mean(seen[np.isfinite(seen)]), -0.9, 0.7))) if np.isfinite(seen).any() else 1.0
        missing = max(float(np.nanmean(noise_floor[:, SUM] ** 2 - found[:, SUM] ** 2)), -0.5 * scatter.pressure_drift**2)
        scatter = replace(
            scatter,
            friction_between=min(scatter.friction_between, 0.06) if number == 0 else scatter.friction_between * ratio**0.5,
            friction_within=scatter.friction_within * ratio,
            pressure_drift=float(np.sqrt(max(scatter.pressure_drift**2 + 0.5 * missing, 0.0))),
        )
    return scatter


def twin_scatter(evidence: Evidence, scatter: RepetitionScatter, generator: np.random.Generator) -> Array:
    """Return the factor on friction (n,) of every test, drawn as the rig's repetitions scatter.

    Each test draws its own level, its own difference of the directions, and a variation along time and along travel.
    """
    parts = []
    for test in evidence.tests:
        between = scatter.friction_between * generator.standard_normal()
        directions = 0.5 * scatter.friction_between * generator.standard_normal(2)
        along_time = coloured(generator, test.samples, scatter.correlation / PERIOD)
        moving = np.abs(test.velocity[test.velocity != 0.0])
        length = max(scatter.correlation * float(np.median(moving)) if len(moving) else 0.0, LEAST_LENGTH)
        along_travel = _profile(generator, test.track, length)
        within = scatter.friction_within * (along_time + along_travel) / np.sqrt(2.0)
        parts.append(np.exp(between + np.where(_heading(test.velocity) > 0, directions[0], directions[1]) + within))
    return np.concatenate(parts)


def _profile(generator: np.random.Generator, travel: Array, length: float) -> Array:
    """Return a random function of the travel (n,) with unit variance and a correlation over ``length`` (m)."""
    from scipy.ndimage import gaussian_filter1d

    count = int(np.clip(np.ptp(travel) / (0.25 * length) + 40, 50, 5000))
    rough = gaussian_filter1d(generator.standard_normal(count), 3.0)
    grid = np.linspace(travel.min() - length, travel.max() + length, count)
    return np.asarray(np.interp(travel, grid, rough / max(float(rough.std()), 1e-12)))


def _heading(velocity: Array) -> Array:
    """Return the direction of the last motion (n,), +1 before the first."""
    moving = np.flatnonzero(velocity)
    if len(moving) == 0:
        return np.ones(len(velocity))
    last = np.searchsorted(moving, np.arange(len(velocity)), side="right") - 1
    return np.asarray(np.where(last >= 0, np.sign(velocity[moving[np.maximum(last, 0)]]), 1.0))


def make_twin(views: Views, candidate: Candidate, scatter: RepetitionScatter, seed: int) -> Evidence:
    """Return evidence as it would be if ``candidate`` were the whole truth about the rig.

    Each test starts from its own measured state and follows its own pump; friction scatters, the encoder counts, the
    pressure samples are noisy, and everything is then prepared as measured logs are.
    """
    evidence = views.evidence
    generator = np.random.default_rng([20260721, seed])
    candidate = imperfect(candidate, generator)
    joint = views.joint_readings(candidate, windows=False, scatter=twin_scatter(evidence, scatter, generator))
    shown = views.shown_at_zero(candidate)
    tests: list[TestEvidence] = []
    for index, test in enumerate(evidence.tests):
        part = joint[evidence.edges[index] : evidence.edges[index + 1]]
        fine = np.arange(len(test.log.command_phase["time_s"])) / STRIDE
        coarse = np.arange(test.samples)
        count = test.hardware.values["encoder_count"]
        phase = generator.uniform()
        arm = np.floor(np.interp(fine, coarse, part[:, 0]) / count + phase) * count
        noisy = []
        for channel in (1, 2):
            clean = np.interp(fine, coarse, part[:, channel])
            drift = scatter.pressure_drift * coloured(generator, len(fine), DRIFT_TIME * 1e3)
            noisy.append(clean + drift + scatter.pressure_noise * generator.standard_normal(len(fine)))
        travel, velocity, acceleration = slider_motion(arm, test.hardware.values["pulley_radius"], STRIDE)
        half, pick = STRIDE // 2, slice(0, None, STRIDE)
        tests.append(
            replace(
                test,
                arm=smooth(arm, half)[pick],
                pressure1=smooth(noisy[0], half)[pick],
                pressure2=smooth(noisy[1], half)[pick],
                velocity=velocity,
                track=travel,
                acceleration=acceleration,
                misfit=misfit_of(arm[pick], travel, test.hardware.values),
                breaks=breakaways(arm, count),
                home=test.home if np.isnan(test.home) else shown + evidence.home_scatter * generator.standard_normal(),
            )
        )
    return Evidence(tuple(tests))
