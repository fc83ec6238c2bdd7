"""The simulator as a rig: one resolved configuration and one seed give the columns of one test log."""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.controllers import find_controller
from hjcamp.controllers.controller import Controller
from hjcamp.effects import chosen_effects
from hjcamp.errors import HjcampError
from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.scatter import Scatter, draw
from hjcamp.model.run.simulator import PERIOD, Simulator
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.factors import changed_loop, changed_values
from hjcamp.plants.pump_joint.feedforward import Feedforward
from hjcamp.plants.pump_joint.loop import ClosedLoop, JointSimulator, NotEndedError
from hjcamp.plants.pump_joint.procedure import Procedure
from hjcamp.trajectories import build_trajectory

Array = NDArray[np.float64]
DEGREE = math.pi / 180
# Preload, adjustment and release take less than this in all published campaigns; noise is drawn for it.
USUAL_PHASES_S = 2.0
FARTHEST_DEG = 360.0  # the string goes round its pulley two and a half times; the arm meets the joint before
LOG_NAMES = {
    "phase": ("phase", 1.0),
    "reference": ("reference_deg", 1 / DEGREE),
    "command": ("command_deg", 1 / DEGREE),
    "pid": ("pid_deg", 1 / DEGREE),
    "feedforward": ("feedforward_deg", 1 / DEGREE),
    "dither": ("dither_v", 1.0),
}


def model_values(config: Mapping[str, Any]) -> tuple[dict[str, float], dict[str, dict[str, float]]]:
    """Return the plant parameters of the configured hardware and model, and the effects with their parameters."""
    model = config["model"]
    values = PumpJoint.configured(config) | {name: float(value) for name, value in (model.get("parameters") or {}).items()}
    effects = {name: dict(given or {}) for name, given in (model.get("effects") or {}).items()}
    for name, given in (config.get("effects") or {}).items():
        effects[name] = {**effects.get(name, {}), **(given or {})}
    return values, effects


@functools.lru_cache(maxsize=16)
def _model(effects: tuple[Any, ...]) -> Simulator:
    return Simulator(Composition(PumpJoint, effects))


@functools.lru_cache(maxsize=16)
def _simulator(effects: tuple[Any, ...], controller: type[Controller]) -> JointSimulator:
    return JointSimulator(Composition(PumpJoint, effects), controller=controller)


def simulator_of(config: Mapping[str, Any]) -> JointSimulator:
    """Return the simulator of a resolved configuration: the joint with its effects, and the controller."""
    law: Any = find_controller(config["controller"]["name"])
    return _simulator(tuple(chosen_effects(model_values(config)[1])[0]), law)


def full_values(values: dict[str, float], effects: Mapping[str, Mapping[str, float]]) -> dict[str, float]:
    """Return plant and effect parameters under their full names."""
    return values | {f"{effect}.{name}": value for effect, given in effects.items() for name, value in given.items()}


def reference_of(config: Mapping[str, Any]) -> tuple[Array, float]:
    """Return the reference (n, 3) in rad and the direction of the first motion."""
    trajectory = build_trajectory(config["trajectory"])
    time = np.arange(round(trajectory.duration / PERIOD)) * PERIOD
    return np.column_stack(trajectory.reference(time)), trajectory.first_direction


def control_values(config: Mapping[str, Any], law: type[Controller], direction: float) -> dict[str, float]:
    """Return the controller's parameters from its configuration; ``positive.kp`` becomes ``positive_kp``."""
    flat: dict[str, float] = {}
    for name, value in config["controller"].items():
        if isinstance(value, Mapping) and name in ("positive", "negative"):
            flat.update({f"{name}_{gain}": number for gain, number in value.items()})
        elif name in law.parameters:
            flat[name] = value
    if "first_direction" in law.parameters:
        flat["first_direction"] = direction
    return flat


def dither_of(config: Mapping[str, Any], samples: int) -> Array:
    """Return the square wave (samples,) in volts; its half period is a whole number of samples."""
    dither = config["controller"].get("dither") or {"amplitude_v": 0.0, "frequency_hz": 250.0}
    half = round(0.5 / (dither["frequency_hz"] * PERIOD))
    return np.where((np.arange(samples) // half) % 2 == 0, 1.0, -1.0) * float(dither["amplitude_v"])


def procedure_values(config: Mapping[str, Any], direction: float, control: float) -> dict[str, float]:
    """Return the parameters of the test procedure, SI, for a test that starts in ``direction``."""
    given, pump = config["procedure"], config["pump"]
    adjustment = given["adjustment"]
    turn = 2 * math.pi / (pump["lead_mm_per_rev"])
    preset = given.get("initial", {}).get("pressure1_mpa") is not None
    return {
        "preload": given["preload_mpa"] * 1e6,
        "preload_speed": given["preload_speed_mm_per_s"] * 1e-3,
        "adjust": 1.0 if adjustment["enabled"] else 0.0,
        "difference": adjustment["positive_mpa" if direction > 0 else "negative_mpa"] * 1e6,
        "first_direction": direction,
        "adjustment_speed": adjustment["speed_mm_per_s"] * turn,
        "rest": given["rest_ms"] * 1e-3,
        "control": control,
        "release": given["release_mpa"] * 1e6,
        "limit": given["phase_limit_s"],
        "first_phase": 2.0 if preset else 0.0,
    }


@functools.lru_cache(maxsize=64)
def _feedforward(text: str) -> Array:
    config = json.loads(text)
    reference, direction = reference_of(config)
    given = config["controller"]["feedforward"]
    model = config["controller_model"]
    values = PumpJoint.configured(config) | {name: float(value) for name, value in (model.get("parameters") or {}).items()}
    effects, parameters = chosen_effects(model.get("effects") or {})
    procedure = config["procedure"]
    middle = procedure["preload_mpa"] * 1e6
    ahead = procedure["adjustment"]["positive_mpa" if direction > 0 else "negative_mpa"] * 1e6
    ahead = direction * ahead if procedure["adjustment"]["enabled"] else 0.0
    law = Feedforward(given["gain"], given["static_friction"], given["friction_direction"])
    simulator = _model(tuple(effects))
    start = (middle + 0.5 * ahead, middle - 0.5 * ahead)
    return law.command(simulator, full_values(values, parameters), reference, start, direction)


def feedforward_of(config: Mapping[str, Any], samples: int) -> Array:
    """Return the feedforward (samples,), rad of the pump motor; zero for a controller without one."""
    if not find_controller(config["controller"]["name"]).uses_feedforward:
        return np.zeros(samples)
    keys = ("pump", "amplifier", "tubing", "joint", "friction", "rig", "controller", "trajectory", "procedure")
    decisive = {key: config[key] for key in keys} | {"controller_model": config.get("controller_model") or {}}
    return _feedforward(json.dumps(decisive, sort_keys=True))


@dataclass(frozen=True)
class PreparedTest:
    """All that one test needs: the simulator, its parameter vector, the start and the closed loop with its draws."""

    simulator: JointSimulator
    p: Array
    start: dict[str, float]
    test: ClosedLoop


def prepare(config: Mapping[str, Any], seed: int, whole: bool = True) -> PreparedTest:
    """Return what a resolved configuration and a seed say about one test, before anything is run.

    ``whole`` draws noise for as long as the test may last by its phases' limits, else for as long as it usually lasts.
    """
    law: Any = find_controller(config["controller"]["name"])
    values, given = model_values(config)
    effects, parameters = chosen_effects(given)
    simulator = _simulator(tuple(effects), law)
    factors = {name: float(value) for name, value in (config["model"].get("factors") or {}).items()}
    changed = changed_values(values, factors) if factors else values
    p = simulator.vector(full_values(changed, parameters))
    plant = dict(zip(simulator.composition.parameters, p, strict=True))
    reference, direction = reference_of(config)
    samples = len(reference)
    procedure = procedure_values(config, direction, samples * PERIOD)
    longest = samples + round((procedure["rest"] + 3 * procedure["limit"]) / PERIOD)
    channels = PumpJoint.channels
    noise = np.array([plant[channel.noise] if channel.noise else 0.0 for channel in channels])
    counts = np.array([plant[channel.counts] if channel.counts else 0.0 for channel in channels])
    scatter = config["rig"]["scatter"]
    rows = None if whole else min(longest, samples + round((procedure["rest"] + USUAL_PHASES_S) / PERIOD))
    drawn = draw(
        seed,
        longest,
        noise,
        Scatter(
            scatter["friction_between"],
            scatter["friction_within"],
            scatter.get("friction_correlation_s", 0.2),
            scatter["initial_pressure_mpa"] * 1e6,
        ),
        rows=rows,
    )
    given_procedure = config["procedure"]
    initial = given_procedure.get("initial", {})
    base = given_procedure["start_preload_mpa"]
    pressures = [base if initial.get(name) is None else initial[name] for name in ("pressure1_mpa", "pressure2_mpa")]
    start = {f"pressure{i + 1}": pressures[i] * 1e6 + drawn.pressures[i] for i in range(2)}
    test = ClosedLoop(
        control=law.vector(control_values(config, law, direction)),
        procedure=Procedure.vector(procedure),
        reference=np.column_stack([reference, feedforward_of(config, samples)]),
        dither=dither_of(config, samples),
        delay=plant["pump_delay"],
        preload_area=values["pump_area"],
        counts=counts,
        phases=drawn.phases,
        noise=drawn.noise,
        scatter=drawn.friction,
    )
    return PreparedTest(simulator, p, start, changed_loop(test, law, factors) if factors else test)


def kernel_texts(config: Mapping[str, Any]) -> dict[str, tuple[str, str]]:
    """Return the kernels that a test needs: what each is in words, its text, and the function that is compiled last."""
    simulator = simulator_of(config)
    return {f"the test loop with {effects_in(simulator)}": (simulator.source, "closed_loop"), **feedforward_text(config)}


def effects_in(simulator: JointSimulator) -> str:
    """Return the names of a simulator's effects, with commas."""
    return ", ".join(effect.name for effect in simulator.composition.effects) or "no effect"


def feedforward_text(config: Mapping[str, Any]) -> dict[str, tuple[str, str]]:
    """Return the kernel of the model in the feedforward, as `kernel_texts` does; nothing where the controller has none."""
    if not find_controller(config["controller"]["name"]).uses_feedforward:
        return {}
    known = tuple(chosen_effects((config.get("controller_model") or {}).get("effects") or {})[0])
    return {"the model of the feedforward": (_model(known).source, "signals")}


def run_test(config: Mapping[str, Any], seed: int) -> tuple[dict[str, Array], dict[str, str]]:
    """Simulate one test; return the columns of its log (contract units) and what is worth noting as metadata.

    The same configuration and seed give the same columns bit for bit, in any process. Raises ``HjcampError`` where the
    test does not come to its end, or where the arm goes where none can.
    """
    prepared = prepare(config, seed, whole=False)
    try:
        recorded = prepared.simulator.run(prepared.start, prepared.p, prepared.test)
    except NotEndedError:
        prepared = prepare(config, seed)
        recorded = prepared.simulator.run(prepared.start, prepared.p, prepared.test)
    columns = log_columns(recorded)
    farthest = float(np.abs(columns["arm_deg"]).max())
    if farthest > FARTHEST_DEG:
        raise HjcampError(
            f"the simulated arm went {farthest:.4g} deg from its start, more than a turn: no arm of this joint can; "
            "check the controller's gains and scale, the trajectory and model.parameters"
        )
    return columns, log_notes(recorded, config["procedure"])


def log_columns(recorded: Mapping[str, Any]) -> dict[str, Array]:
    phase = recorded["phase"]
    first = int(np.argmax(phase == 3.0))
    columns = {"time_s": np.asarray((np.arange(len(phase)) - first) * PERIOD, dtype=np.float64)}
    for name, (field, scale) in LOG_NAMES.items():
        columns[field] = recorded[name] * scale
    for channel in PumpJoint.channels:
        columns[channel.field] = recorded[channel.field] * channel.log_scale
    return columns


def log_notes(recorded: Mapping[str, Any], procedure: Mapping[str, Any]) -> dict[str, str]:
    moving = recorded["phase"] == 3.0
    lowest = min(recorded["pressure1_mpa"][moving].min(), recorded["pressure2_mpa"][moving].min()) * 1e-6
    notes = {"preload_mpa": f"{procedure['preload_mpa']:g}"}
    if lowest < procedure["warn_below_mpa"]:
        notes["warning"] = f"a line ran down to {lowest:.3f} MPa gauge, below {procedure['warn_below_mpa']:g} MPa"
    return notes
