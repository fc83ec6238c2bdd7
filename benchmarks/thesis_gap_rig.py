"""The rig of chapter 5 in memory: every test of a campaign, simulated with any base parameter, effect or opening."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.backends.simulation import DEGREE, PreparedTest, prepare
from hjcamp.campaign.planning import make_plan
from hjcamp.configuration.composer import Composer
from hjcamp.controllers.ffwd_pid import FfwdPid
from hjcamp.effects import load_effects
from hjcamp.errors import HjcampError
from hjcamp.model.compose import Composition
from hjcamp.model.parameter import Parameter
from hjcamp.model.simulator import PERIOD
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.loop import JointSimulator
from hjcamp.plants.pump_joint.procedure import Procedure
from hjcamp.records.log import TestLog
from hjcamp.records.plan import seed_of
from hjcamp.report.indicators import INDICATORS, indicators_of

Array = NDArray[np.float64]
Settings = Mapping[str, float]
LOST = 200.0
KEYS = ("trajectory", "controller", "payload", "orientation")


def _factor(low: float, high: float, text: str) -> Parameter:
    return Parameter("1", 1.0, (low, high), "log-uniform", text)


#: What the text leaves open or may have misprinted, each a named hypothesis with the same standing as an effect.
OPENINGS: dict[str, Parameter] = {
    "controller_scale": _factor(0.1, 4.0, "factor on the scale of the PID output (E8)"),
    "feedforward_gain": _factor(0.4, 1.6, "factor on the feedforward of 5.3.3 (E9)"),
    "pump_bandwidth": _factor(0.4, 3.0, "factor on the speed of the pump's poles (4.3.4)"),
    "pump_latency": _factor(0.2, 8.0, "factor on the pump's delay (4.3.4)"),
    "pump_ratio": _factor(0.6, 1.6, "factor on the volume that the pump moves (bores, lead)"),
    "derivative_gain": _factor(0.1, 4.0, "factor on Kd (5.2.1)"),
    "integral_gain": _factor(0.2, 4.0, "factor on Ki (5.2.1)"),
    "moving_mass": PumpJoint.parameters["moving_mass"],
    "head_start": _factor(0.2, 3.0, "factor on the initial pressure differences (5.2.4.1)"),
    "dither_gain": Parameter("rad/V", 0.628, (1e-3, 20.0), "log-uniform", "pump command equivalent to one volt (E11)"),
}


@dataclass(frozen=True)
class Place:
    """One test: the choices that name its row of a table, its repetition, and all that it takes to run it."""

    choices: dict[str, str]
    repetition: int
    prepared: PreparedTest


@lru_cache(maxsize=1)
def gated_simulator() -> JointSimulator:
    """Return the closed loop with the whole effect library behind gates, compiled once."""
    library = load_effects([])
    effects = tuple(library[name] for name in sorted(library))
    return JointSimulator(Composition(PumpJoint, effects, gated=True), controller=FfwdPid)


@lru_cache(maxsize=8)
def configurations(campaign: str) -> dict[str, dict[str, Any]]:
    """Return the resolved configuration of each condition of a campaign."""
    composer = Composer()
    lines = [f"campaign={campaign}"]
    plan = make_plan(composer.compose(lines).config, campaign, lines, composer)
    return {condition.name: condition.config for condition in plan.conditions}


def planned(campaign: str, repetitions: int, seed: int) -> list[Place]:
    """Return the tests of a campaign with the seeds that `hjcamp run` gives them."""
    places = []
    for name, config in configurations(campaign).items():
        choices = {key: str(config[key]["name"]) for key in KEYS}
        for repetition in range(1, repetitions + 1):
            places.append(Place(choices, repetition, prepare(config, seed_of(seed, name, repetition))))
    return places


@dataclass(frozen=True)
class Rig:
    """Tests that are simulated together; the same seeds for every setting (common random numbers)."""

    places: Sequence[Place]

    @property
    def conditions(self) -> list[dict[str, str]]:
        """The conditions in order of first appearance."""
        found: dict[tuple[str, ...], dict[str, str]] = {}
        for place in self.places:
            found.setdefault(tuple(place.choices.values()), place.choices)
        return list(found.values())

    def indicators(self, settings: Settings) -> Array:
        """Return (conditions, repetitions, 4) in degrees: RMSE1, RMSE2, largest error, steady state error.

        A test that does not run to its end counts as lost: 200 deg. Undefined steady state errors are NaN.
        """
        rows: dict[tuple[str, ...], list[list[float]]] = {}
        for place in self.places:
            rows.setdefault(tuple(place.choices.values()), []).append(run_one(place, settings))
        return np.array(list(rows.values()))


def run_one(place: Place, settings: Settings) -> list[float]:
    """Return the four indicators of one test in degrees."""
    try:
        columns = recorded(place, settings)
    except HjcampError:
        return [LOST] * 3 + [LOST if place.choices["trajectory"].startswith("cycloid") else np.nan]
    row = indicators_of(TestLog(columns, {**place.choices, "pump": "", "amplifier": "", "tubing": "", "friction": ""}))
    return [np.nan if row[name] is None else float(row[name]) for name in INDICATORS]


def recorded(place: Place, settings: Settings) -> dict[str, Array]:
    """Return time, reference, arm angle and pressures of the command phase of one test, in the units of a log."""
    simulator = gated_simulator()
    test = changed_loop(place.prepared, settings)
    run = simulator.run(place.prepared.start, vector_of(place.prepared, settings), test)
    command = run["phase"] == 3.0
    columns = {"time_s": np.arange(int(command.sum())) * PERIOD, "reference_deg": run["reference"][command] / DEGREE}
    for channel in PumpJoint.channels:
        columns[channel.field] = run[channel.field][command] * channel.log_scale
    return columns


def vector_of(prepared: PreparedTest, settings: Settings) -> Array:
    """Return the parameter vector of a test: its own hardware and payload, then the settings."""
    values = dict(zip(prepared.simulator.composition.parameters, map(float, prepared.p), strict=True))
    present = {name.split(".")[0] for name in values if "." in name}
    for name, value in settings.items():
        if name == "payload_inertia.load_mass":
            values[name] = values.get(name, 0.0) + value
        elif name.startswith("gravity_load.") and "gravity_load" in present:
            continue
        elif name in PumpJoint.parameters or "." in name:
            values[name] = value
    present |= {name.split(".")[0] for name in settings if "." in name}
    speed = settings.get("pump_bandwidth", 1.0)
    for name, power in (("pump_gain", 3), ("pump_a2", 1), ("pump_a1", 2), ("pump_a0", 3)):
        values[name] *= speed**power
    values["pump_area"] *= settings.get("pump_ratio", 1.0)
    return gated_simulator().vector(values | {f"gate.{effect}": 1.0 for effect in present})


def changed_loop(prepared: PreparedTest, settings: Settings) -> Any:
    """Return the closed loop with controller, feedforward, delay and procedure as the settings say."""
    test = prepared.test
    control, procedure, reference = test.control.copy(), test.procedure.copy(), test.reference.copy()
    gains = list(FfwdPid.parameters)
    control[gains.index("scale")] *= settings.get("controller_scale", 1.0)
    for side in ("positive", "negative"):
        control[gains.index(f"{side}_kd")] *= settings.get("derivative_gain", 1.0)
        control[gains.index(f"{side}_ki")] *= settings.get("integral_gain", 1.0)
    procedure[list(Procedure.parameters).index("difference")] *= settings.get("head_start", 1.0)
    reference[:, 3] *= settings.get("feedforward_gain", 1.0)
    delay = test.delay * settings.get("pump_latency", 1.0)
    return replace(test, control=control, procedure=procedure, reference=reference, delay=delay)
