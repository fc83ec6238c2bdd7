"""Simulated twins of the user's own campaign: the same pump motion on a rig that is exactly the fitted model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hjcamp.discrepancy.evidence import (
    PERIOD,
    STRIDE,
    Evidence,
    TestEvidence,
    _smooth,
    breakaways,
    misfit_of,
    slider_motion,
)
from hjcamp.discrepancy.features import Features
from hjcamp.discrepancy.fit import Fit
from hjcamp.discrepancy.repetition import RepetitionScatter
from hjcamp.discrepancy.unknowns import base_unknowns
from hjcamp.discrepancy.views import Candidate, Views
from hjcamp.model.scatter import coloured
from hjcamp.plants.pump_joint import PumpJoint

Array = NDArray[np.float64]
DRIFT_TIME = 0.05


def imperfect(candidate: Candidate, generator: np.random.Generator) -> Candidate:
    """Return the candidate with the parameters that are only known to within a spread drawn anew."""
    base = dict(candidate.base)
    for unknown in base_unknowns(PumpJoint.uncertain):
        value = base.get(unknown.name, unknown.parameter.default)
        base[unknown.name] = unknown.back(unknown.forth(value) + unknown.spread * generator.standard_normal())
    return Candidate(base, candidate.effects)


def match_scatter(views: Views, fit: Fit, scatter: RepetitionScatter, rounds: int = 4) -> RepetitionScatter:
    """Return the scatter with which the floor of twins is the floor of the measurements.

    Friction sets the floor of the pressure difference in the joint view, slow pressure noise that of the line sum.
    """
    features = Features(views.evidence)
    floor = features.floor(fit.features)
    for number in range(rounds):
        twin = make_twin(views, fit.candidate, scatter, 10_000 + number)
        own = Features(twin)
        found = own.floor(own.of(Views(twin, views.effects).residuals(fit.candidate)))
        ratio = float(np.clip(floor[1] / found[1], 0.4, 2.0))
        missing = max(floor[2] ** 2 - found[2] ** 2, -0.5 * scatter.pressure_drift**2)
        scatter = replace(
            scatter,
            friction_between=min(scatter.friction_between, 0.06) if number == 0 else scatter.friction_between * ratio**0.5,
            friction_within=scatter.friction_within * ratio,
            pressure_drift=float(np.sqrt(max(scatter.pressure_drift**2 + 0.5 * missing, 0.0))),
        )
    return scatter


def twin_scatter(evidence: Evidence, scatter: RepetitionScatter, generator: np.random.Generator) -> Array:
    """Return the factor on friction (n,) of every test, drawn as the rig's repetitions scatter."""
    parts = []
    for test in evidence.tests:
        between = scatter.friction_between * generator.standard_normal()
        within = scatter.friction_within * coloured(generator, test.samples, scatter.correlation / PERIOD)
        parts.append(np.exp(between + within))
    return np.concatenate(parts)


def make_twin(views: Views, candidate: Candidate, scatter: RepetitionScatter, seed: int) -> Evidence:
    """Return evidence as it would be if ``candidate`` were the whole truth about the rig.

    Each test starts from its own measured state and follows its own pump; friction scatters, the encoder counts, the
    pressure samples are noisy, and everything is then prepared as measured logs are.
    """
    evidence = views.evidence
    generator = np.random.default_rng([20260721, seed])
    candidate = imperfect(candidate, generator)
    joint, _ = views.readings(candidate, windows=False, scatter=twin_scatter(evidence, scatter, generator))
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
        travel, velocity, acceleration = slider_motion(arm, test.hardware.values["pulley_radius"])
        half, pick = STRIDE // 2, slice(0, None, STRIDE)
        tests.append(
            replace(
                test,
                arm=_smooth(arm, half)[pick],
                pressure1=_smooth(noisy[0], half)[pick],
                pressure2=_smooth(noisy[1], half)[pick],
                velocity=velocity[pick],
                track=travel[pick],
                acceleration=acceleration[pick],
                misfit=misfit_of(arm, travel, test.hardware.values)[pick],
                breaks=breakaways(arm, count),
            )
        )
    return Evidence(tuple(tests))
