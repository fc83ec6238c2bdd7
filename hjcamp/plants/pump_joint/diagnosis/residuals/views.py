"""Views of the error: windows of the joint restarted from measured states, and the lines driven by pump and arm."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.run.simulator import Simulator
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence
from hjcamp.plants.pump_joint.diagnosis.measured.hardware import simulator
from hjcamp.plants.pump_joint.diagnosis.models.per_test_states import OwnStarts
from hjcamp.plants.pump_joint.diagnosis.residuals.courses import Courses
from hjcamp.plants.pump_joint.diagnosis.residuals.kernel_choice import chosen_for
from hjcamp.plants.pump_joint.diagnosis.residuals.memo import Recent
from hjcamp.plants.pump_joint.diagnosis.residuals.passes import force_errors, joint_errors, line_errors
from hjcamp.plants.pump_joint.diagnosis.residuals.reach import (
    balances_itself,
    gates_of,
    idle,
    reaching_places,
    shows_otherwise,
)
from hjcamp.plants.pump_joint.diagnosis.residuals.replay_parallel import follow
from hjcamp.workers.pool import Crew

Array = NDArray[np.float64]
CHANNELS = ("arm", "difference", "line_sum", "line_difference", "sliding", "breakaway", "home")
HOME = CHANNELS.index("home")
WINDOWED = 4
TOLERANCE = 10.0
KEPT = 24
SEEN = tuple(channel.signal for channel in PumpJoint.channels)
PRESSURES = tuple(channel.signal for channel in PumpJoint.channels if channel.field.startswith("pressure"))
LINES = slice(CHANNELS.index("line_sum"), CHANNELS.index("line_difference") + 1)
FORCES = CHANNELS.index("sliding")


def _weighs(hardware: Any) -> bool:
    """Whether the setup itself has a weight on the arm."""
    weight = hardware.effects.get("gravity_load")
    return bool(weight and weight["load_mass"] > 0)


def _slope(shown: Array, true: Array) -> float:
    """Return the slope of the line through what is shown over what is; 1 where it does not move."""
    true = true - true.mean()
    power = float(true @ true)
    return float(shown @ true) / power if power > 0.0 else 1.0


class Views:
    """Residuals (model minus measurement) of a candidate on the evidence, from two compiled models with gated effects."""

    def __init__(self, evidence: Evidence, effects: tuple[Any, ...], crew: Crew | None = None) -> None:
        self.evidence = evidence
        self.courses = Courses(evidence)
        self.effects = effects
        self.crew = crew or Crew()
        self.names = tuple(effect.name for effect in effects)
        self._recent_states: Recent[tuple[Array, Array]] = Recent(KEPT)
        self._recent_lines: Recent[Array] = Recent(KEPT)
        self._recent_balance: Recent[Array] = Recent(KEPT)

    def __reduce__(self) -> tuple[Any, ...]:
        return _views_by_name, (self.evidence, self.names)

    def joint(self, candidate: Candidate, hardware: Any) -> Simulator:
        """Return the plant driven by the measured pump."""
        return simulator(self._needed(candidate, hardware), "pump")

    def lines(self, candidate: Candidate, hardware: Any) -> Simulator:
        """Return the lines driven by the measured pump and arm."""
        return simulator(self._needed(candidate, hardware), "lines")

    def inverse(self, candidate: Candidate, hardware: Any) -> Simulator:
        """Return the joint's force balance with every measured state given."""
        return simulator(self._needed(candidate, hardware), "inverse")

    def _needed(self, candidate: Candidate, hardware: Any) -> tuple[Any, ...]:
        weight = {"gravity_load"} if _weighs(hardware) and "gravity_load" in self.names else set()
        return chosen_for(self.effects, frozenset(candidate.effects) | weight)

    def vector(self, model: Simulator, candidate: Candidate, hardware: Any) -> Array:
        """Return the parameter vector of ``candidate`` on ``hardware``: gates open, the setup's own load added."""
        values: dict[str, float] = {**hardware.values, **candidate.base}
        own = hardware.effects.get("payload_inertia")
        if own:
            values["moving_mass"] += own["load_mass"] * (own["radius"] / values["pulley_radius"]) ** 2
        for name, parameters in candidate.effects.items():
            values[f"gate.{name}"] = 1.0
            values.update({f"{name}.{parameter}": value for parameter, value in parameters.items()})
        weight = hardware.effects.get("gravity_load")
        if _weighs(hardware) and "gravity_load" in self.names:
            chosen = candidate.effects.get("gravity_load", {})
            values["gate.gravity_load"] = 1.0
            radius = chosen.get("radius", weight["radius"])
            values["gravity_load.radius"] = radius
            values["gravity_load.rest_angle"] = chosen.get("rest_angle", weight["rest_angle"])
            values["gravity_load.load_mass"] = chosen.get("load_mass", 0.0) + weight["load_mass"] * weight["radius"] / radius
        return model.vector(values)

    def _key(self, model: Simulator, p: Array, outputs: Sequence[str]) -> tuple[frozenset[str], bytes]:
        """Return what the outputs of a model depend on: the effects present, and the parameters that can reach them."""
        effects, cut = model.composition.effects, model.composition.cut.name
        present = frozenset(effect.name for effect in effects if p[gates_of(effects)[effect.name]] != 0.0)
        return present, p[reaching_places(effects, cut, present, tuple(outputs))].tobytes()

    def _line_key(self, candidate: Candidate, index: int) -> tuple[Any, Simulator, Array]:
        """Return of one group of tests what its lines depend on, their model without what cannot change them, its parameters."""
        hardware = self.courses.groups[index][1]
        present = self._that_reach(candidate, "lines", SEEN)
        model = self.lines(present, hardware)
        p = self.vector(model, present, hardware)
        key: tuple[Any, ...] = (index, *self._key(model, p, SEEN))
        if self._hung(candidate):
            key = (*key, self.vector(self.joint(candidate, hardware), candidate, hardware).tobytes())
        return key, model, p

    def _states(self, candidate: Candidate, index: int) -> tuple[Array, Array]:
        """Return of one group of tests the observed states (n, 4) and the sliders' smooth travel (n, 1) with the sensors'
        errors taken out."""
        if not self._shown_otherwise(candidate):
            return self.courses.plain_states[index]
        key, model, p = self._line_key(candidate, index)
        return self._recent_states.get(key, lambda: self._true_states(model, p, candidate, index))

    def _line_readings(self, candidate: Candidate, index: int) -> Array:
        """Return of one group of tests the readings (n, 4) of the lines driven by pump and arm, of which the pressures count."""
        hardware = self.courses.groups[index][1]
        present = self._that_reach(candidate, "lines", PRESSURES)
        model = self.lines(present, hardware)
        p = self.vector(model, present, hardware)
        states = self._line_key(candidate, index)[0] if self._shown_otherwise(candidate) else ()
        key = (index, *self._key(model, p, PRESSURES), states)

        def compute() -> Array:
            observed, _ = self._states(candidate, index)
            course = self.courses.course(self.courses.groups[index][0], observed[:, [0, 3]], observed, "tests")
            return follow(model, p, course, self.crew, TOLERANCE).readings

        return self._recent_lines.get(key, compute)

    def _that_reach(self, candidate: Candidate, cut: str, outputs: Sequence[str]) -> Candidate:
        """Return the candidate without the effects that cannot change the outputs: a kernel without any is far faster."""
        present = tuple(effect for effect in self.effects if effect.name in candidate.effects)
        return candidate.without(idle(present, cut, tuple(outputs)))

    def _true_states(self, model: Simulator, p: Array, candidate: Candidate, index: int) -> tuple[Array, Array]:
        (part, hardware), (observed, track) = self.courses.groups[index], self.courses.plain_states[index]
        radius = hardware.values["pulley_radius"]
        if self._hung(candidate):
            # What hangs between sliders and arm moves while the arm stands: only the joint's own motion tells.
            course = self.courses.course(part, observed[:, :1], observed, "windows")
            joint = self.joint(candidate, hardware)
            seen = follow(joint, self.vector(joint, candidate, hardware), course, self.crew, TOLERANCE)
        else:
            seen = follow(model, p, self.courses.course(part, observed[:, [0, 3]], observed, "tests"), self.crew, TOLERANCE)
        shown = np.column_stack([seen.readings[:, 1], seen.readings[:, 2], seen.readings[:, 0] * radius])
        ideal = seen.ideal[:, 1:]
        # A sensor with a scale is inverted where it was read, not where the model would have it.
        stretch = np.array([_slope(shown[:, 0], ideal[:, 0]), _slope(shown[:, 1], ideal[:, 1]), 1.0])
        true = np.hstack([observed[:, :1], ideal + (observed[:, 1:] - shown) / stretch])
        return true, track - (shown - ideal)[:, 2:]

    def _shown_otherwise(self, candidate: Candidate) -> bool:
        return not self._misleading.isdisjoint(candidate.effects)

    def _hung(self, candidate: Candidate) -> bool:
        """Whether the model has an effect between the sliders and the arm."""
        return not self._hanging.isdisjoint(candidate.effects)

    @cached_property
    def _hanging(self) -> frozenset[str]:
        return frozenset(effect.name for effect in self.effects if "arm_angle" in effect.terms)

    @cached_property
    def _misleading(self) -> frozenset[str]:
        return frozenset(effect.name for effect in self.effects if shows_otherwise(effect))

    @cached_property
    def _circular(self) -> frozenset[str]:
        return frozenset(effect.name for effect in self.effects if balances_itself(effect))

    def joint_readings(self, candidate: Candidate, *, windows: bool = True, scatter: Array | None = None) -> Array:
        """Return predicted readings (n, 4) of the joint view, SI: arm, pressure 1 and 2, pump.

        With ``windows`` off it runs through every test from its first sample.
        """
        found = []
        for index, (part, hardware) in enumerate(self.courses.groups):
            observed, _ = self._states(candidate, index)
            course = self.courses.course(part, observed[:, :1], observed, "windows" if windows else "tests", scatter)
            model = self.joint(candidate, hardware)
            p = self.vector(model, candidate, hardware)
            found.append(follow(model, p, course, self.crew, TOLERANCE).readings)
        return found[0] if len(found) == 1 else np.concatenate(found)

    def _balance(self, candidate: Candidate, index: int) -> Array:
        """Return push, friction, static friction (N) and mass (kg) of one group of tests (n, 4)."""
        part, hardware = self.courses.groups[index]
        balanced = self._that_reach(candidate.without(self._circular), "inverse", PumpJoint.balance)
        model = self.inverse(balanced, hardware)
        p = self.vector(model, balanced, hardware)
        key: tuple[Any, ...] = (index, *self._key(model, p, PumpJoint.balance))
        if self._shown_otherwise(candidate):
            key = (key, self._line_key(candidate, index)[0])

        def compute() -> Array:
            observed, track = self._states(candidate, index)
            driven = np.hstack([observed[:, :3], track])
            course = self.courses.course(part, driven, driven, "samples")
            return follow(model, p, course, self.crew, TOLERANCE).forces

        return self._recent_balance.get(key, compute)

    def _sensor_scale(self, candidate: Candidate, index: int) -> float:
        """Return the slope of the pressure difference that the sensors of a candidate show over the true one."""
        if not self._shown_otherwise(candidate):
            return 1.0
        observed, shown = self._states(candidate, index)[0], self.courses.plain_states[index][0]
        return _slope(shown[:, 1] - shown[:, 2], observed[:, 1] - observed[:, 2])

    def residuals(self, candidate: Candidate, windows: bool = True) -> Array:
        """Return the residuals (n, channels): arm (rad), pressure difference, line sum, line difference (Pa), forces (N)
        and where the test begins (rad).

        A constant of each test is taken out of the line view: it is the error of the initial pressures. What a test
        begins with and no rig repeats (`Parameter.each_test`) is set for each test on its own, as the lines tell it.
        Without ``windows`` the joint is not simulated, and arm and pressure difference are 0.

        Forces while the arm slides: push - friction - mass times acceleration. At each breakaway: the largest push of the
        16 ms before the arm moves, less the static friction there, positive where the joint holds more than the model says;
        a difference beyond a tenth of the static friction counts little more, since the contact of a hunting joint is
        fresh. Forces are read in the sensors' own units: a scale of both sensors, with all forces scaled alike, must
        explain nothing.
        """
        out = np.zeros((len(self.courses.measured), len(CHANNELS)))
        if windows:
            joint_errors(self.joint_readings(candidate), self.courses.measured, out)
        acceleration, slides = self.courses.columns["acceleration"], self.evidence.sliding
        for index, (part, _) in enumerate(self.courses.groups):
            events, edges = self.courses.places[index]
            line_errors(self._line_readings(candidate, index), self.courses.measured[part], edges, out[part], LINES.start)
            balance, scale = self._balance(candidate, index), self._sensor_scale(candidate, index)
            force_errors(balance, scale, slides[part], acceleration[part], events, out[part], FORCES)
        homes = self.evidence.homes
        out[self.evidence.edges[:-1], HOME] = np.where(np.isfinite(homes), self.shown_at_zero(candidate) - homes, 0.0)
        out[:, LINES] += self._own_starts.corrections(candidate, out[:, LINES])
        return out

    def centred(self, candidate: Candidate) -> Candidate:
        """Return the candidate with the mean of the tests for what each test begins with."""
        return self._own_starts.centred(candidate)

    @cached_property
    def _own_starts(self) -> OwnStarts:
        return OwnStarts(self.effects, self.evidence.edges, self._line_errors)

    def _line_errors(self, candidate: Candidate) -> Array:
        """Return the residuals (n, 2) of the line view alone, Pa: sum and difference."""
        out = np.empty((len(self.courses.measured), 2))
        for index, (part, _) in enumerate(self.courses.groups):
            lines, edges = self._line_readings(candidate, index), self.courses.places[index][1]
            line_errors(lines, self.courses.measured[part], edges, out[part], 0)
        return out

    def shown_at_zero(self, candidate: Candidate) -> float:
        """Return the reading (rad) of an arm at rest at its true zero."""
        if not self._shown_otherwise(candidate):
            return 0.0
        part, hardware = slice(int(self.evidence.edges[0]), int(self.evidence.edges[0]) + 2), self.courses.groups[0][1]
        course = self.courses.course(part, np.zeros((2, 2)), np.zeros((2, 4)), "tests")
        model = self.lines(candidate, hardware)
        p = self.vector(model, candidate, hardware)
        return float(follow(model, p, course, self.crew, TOLERANCE).readings[0, 0])


def _views_by_name(evidence: Evidence, names: tuple[str, ...]) -> Views:
    """Return the views in another process, which reads the effects from its own library."""
    from hjcamp.effects import load_effects

    library = load_effects()
    return Views(evidence, tuple(library[name] for name in names))
