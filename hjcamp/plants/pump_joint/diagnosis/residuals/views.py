"""Views of the error: windows of the joint restarted from measured states, and the lines driven by pump and arm."""

from __future__ import annotations

import functools
import re
from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.candidate import Candidate
from hjcamp.model.course import Course, inputs_along
from hjcamp.model.simulator import Simulator
from hjcamp.model.structure import influences, reaching
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence
from hjcamp.plants.pump_joint.diagnosis.measured.hardware import composition, simulator
from hjcamp.plants.pump_joint.diagnosis.measured.signals import PERIOD
from hjcamp.plants.pump_joint.diagnosis.models.per_test_states import OwnStarts
from hjcamp.plants.pump_joint.diagnosis.residuals.kernel_choice import chosen_for
from hjcamp.plants.pump_joint.diagnosis.residuals.memo import Recent
from hjcamp.plants.pump_joint.diagnosis.residuals.passes import force_errors, joint_errors, line_errors
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


@functools.lru_cache(maxsize=512)
def _reaching(effects: tuple[Any, ...], cut: str, present: frozenset[str], outputs: tuple[str, ...]) -> Any:
    """Return the positions of the parameters that reach the outputs when only some effects are present."""
    whole = composition(effects, cut)
    some = composition(tuple(effect for effect in effects if effect.name in present), cut, gated=False)
    names = influences(some, outputs)
    return np.array([position for position, name in enumerate(whole.parameters) if name in names], dtype=np.int64)


@functools.lru_cache(maxsize=64)
def _gates(effects: tuple[Any, ...]) -> dict[str, int]:
    """Return the position of every effect's gate among the parameters."""
    order = list(composition(effects, "pump").parameters)
    return {effect.name: order.index(f"gate.{effect.name}") for effect in effects}


@functools.lru_cache(maxsize=512)
def _idle(effects: tuple[Any, ...], cut: str, outputs: tuple[str, ...]) -> frozenset[str]:
    """Return the names of those effects without which the outputs are computed in the same way."""
    left = effects
    for effect in effects:
        fewer = tuple(other for other in left if other is not effect)
        if _computed(fewer, cut, outputs) == _computed(left, cut, outputs):
            left = fewer
    return frozenset(effect.name for effect in effects if effect not in left)


def _computed(effects: tuple[Any, ...], cut: str, outputs: tuple[str, ...]) -> str:
    # The places of states and parameters in their vectors depend on what else there is; their names tell.
    return re.sub(r"\[\d+\]", "", reaching(composition(effects, cut, gated=False), outputs))


def _shows_otherwise(effect: Any) -> bool:
    return any(slot == "arm_angle" or slot.endswith("_reading") for slot in effect.terms)


def _balances_itself(effect: Any) -> bool:
    """Whether an effect takes its force from the acceleration, which the force balance is there to explain."""
    terms = (*effect.terms.values(), *effect.rates.values(), *effect.updates.values())
    return any("slider_acceleration" in term.arguments for term in terms)


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

    @cached_property
    def _groups(self) -> list[tuple[slice, Any]]:
        """Runs of neighbouring tests with the same hardware, as sample ranges."""
        edges, tests = self.evidence.edges, self.evidence.tests
        groups: list[tuple[slice, Any]] = []
        begin = 0
        for index in range(1, len(tests) + 1):
            if index == len(tests) or tests[index].hardware != tests[begin].hardware:
                groups.append((slice(int(edges[begin]), int(edges[index])), tests[begin].hardware))
                begin = index
        return groups

    @cached_property
    def _columns(self) -> dict[str, Array]:
        names = ("time", "arm", "pressure1", "pressure2", "pump", "dither", "velocity", "track", "acceleration")
        return {name: self.evidence.joined(name) for name in names}

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
            values["gravity_load.load_mass"] = (
                chosen.get("load_mass", 0.0) + weight["load_mass"] * weight["radius"] / radius
            )
        return model.vector(values)

    @cached_property
    def _measured(self) -> Array:
        return np.column_stack([self._columns["arm"], self._columns["pressure1"], self._columns["pressure2"]])

    @cached_property
    def _marks(self) -> dict[str, Any]:
        """Restarts of a course with windows and of one without, and what a course has where nothing differs (n,)."""
        whole = self.evidence.restart
        tests, n = np.where(whole == 2, 2, 0), len(whole)
        return {
            "windows": whole,
            "tests": tests,
            "samples": np.maximum(whole, 1),
            "zeros": np.zeros((n, 1)),
        }

    def _course(
        self, part: slice, driven: Array, observed: Array, restarts: str, scatter: Array | None = None
    ) -> Course:
        """Return a part of all tests as a course that restarts in each of its "windows", "samples" or "tests" alone."""
        columns, marks = self._columns, self._marks
        return Course(
            period=PERIOD,
            restart=marks[restarts][part],
            time=columns["time"][part],
            driven=np.ascontiguousarray(driven),
            observed=np.ascontiguousarray(observed),
            velocity=marks["zeros"][part] if restarts == "tests" else columns["velocity"][part, None],
            given=self._given[part] if scatter is None else self._scattered(scatter)[part],
        )

    @cached_property
    def _given(self) -> Array:
        """The plant's inputs (n, inputs) as they were recorded."""
        return inputs_along(PumpJoint, len(self._columns["time"]), dither=self._columns["dither"])

    def _scattered(self, scatter: Array) -> Array:
        return inputs_along(PumpJoint, len(scatter), dither=self._columns["dither"], friction_scatter=scatter)

    def _key(self, model: Simulator, p: Array, outputs: Sequence[str]) -> tuple[frozenset[str], bytes]:
        """Return what the outputs of a model depend on: the effects present, and the parameters that can reach them."""
        effects, cut = model.composition.effects, model.composition.cut.name
        present = frozenset(effect.name for effect in effects if p[_gates(effects)[effect.name]] != 0.0)
        return present, p[_reaching(effects, cut, present, tuple(outputs))].tobytes()

    def _line_key(self, candidate: Candidate, index: int) -> tuple[Any, Simulator, Array]:
        """Return of one group of tests what its lines depend on, their model without what cannot change them, its parameters."""
        hardware = self._groups[index][1]
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
            return self._plain_states[index]
        key, model, p = self._line_key(candidate, index)
        return self._recent_states.get(key, lambda: self._true_states(model, p, candidate, index))

    def _line_readings(self, candidate: Candidate, index: int) -> Array:
        """Return of one group of tests the readings (n, 4) of the lines driven by pump and arm, of which the pressures count."""
        hardware = self._groups[index][1]
        present = self._that_reach(candidate, "lines", PRESSURES)
        model = self.lines(present, hardware)
        p = self.vector(model, present, hardware)
        states = self._line_key(candidate, index)[0] if self._shown_otherwise(candidate) else ()
        key = (index, *self._key(model, p, PRESSURES), states)

        def compute() -> Array:
            observed, _ = self._states(candidate, index)
            course = self._course(self._groups[index][0], observed[:, [0, 3]], observed, "tests")
            return follow(model, p, course, self.crew, TOLERANCE).readings

        return self._recent_lines.get(key, compute)

    def _that_reach(self, candidate: Candidate, cut: str, outputs: Sequence[str]) -> Candidate:
        """Return the candidate without the effects that cannot change the outputs: a kernel without any is far faster."""
        present = tuple(effect for effect in self.effects if effect.name in candidate.effects)
        return candidate.without(_idle(present, cut, tuple(outputs)))

    @cached_property
    def _plain_states(self) -> list[tuple[Array, Array]]:
        """Observed states (n, 4) and travel (n, 1) of each group of tests as they were read."""
        columns, found = self._columns, []
        for part, hardware in self._groups:
            lead, radius = hardware.values["pump_lead"], hardware.values["pulley_radius"]
            pump, arm = columns["pump"][part] * lead, columns["arm"][part] * radius
            observed = np.column_stack([pump, columns["pressure1"][part], columns["pressure2"][part], arm])
            found.append((observed, columns["track"][part, None]))
        return found

    def _true_states(self, model: Simulator, p: Array, candidate: Candidate, index: int) -> tuple[Array, Array]:
        (part, hardware), (observed, track) = self._groups[index], self._plain_states[index]
        radius = hardware.values["pulley_radius"]
        if self._hung(candidate):
            # What hangs between sliders and arm moves while the arm stands: only the joint's own motion tells.
            course = self._course(part, observed[:, :1], observed, "windows")
            joint = self.joint(candidate, hardware)
            seen = follow(joint, self.vector(joint, candidate, hardware), course, self.crew, TOLERANCE)
        else:
            seen = follow(model, p, self._course(part, observed[:, [0, 3]], observed, "tests"), self.crew, TOLERANCE)
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
        return frozenset(effect.name for effect in self.effects if _shows_otherwise(effect))

    @cached_property
    def _circular(self) -> frozenset[str]:
        return frozenset(effect.name for effect in self.effects if _balances_itself(effect))

    def joint_readings(self, candidate: Candidate, *, windows: bool = True, scatter: Array | None = None) -> Array:
        """Return predicted readings (n, 4) of the joint view, SI: arm, pressure 1 and 2, pump.

        With ``windows`` off it runs through every test from its first sample.
        """
        found = []
        for index, (part, hardware) in enumerate(self._groups):
            observed, _ = self._states(candidate, index)
            course = self._course(part, observed[:, :1], observed, "windows" if windows else "tests", scatter)
            model = self.joint(candidate, hardware)
            p = self.vector(model, candidate, hardware)
            found.append(follow(model, p, course, self.crew, TOLERANCE).readings)
        return found[0] if len(found) == 1 else np.concatenate(found)

    def _balance(self, candidate: Candidate, index: int) -> Array:
        """Return push, friction, static friction (N) and mass (kg) of one group of tests (n, 4)."""
        part, hardware = self._groups[index]
        balanced = self._that_reach(candidate.without(self._circular), "inverse", PumpJoint.balance)
        model = self.inverse(balanced, hardware)
        p = self.vector(model, balanced, hardware)
        key: tuple[Any, ...] = (index, *self._key(model, p, PumpJoint.balance))
        if self._shown_otherwise(candidate):
            key = (key, self._line_key(candidate, index)[0])

        def compute() -> Array:
            observed, track = self._states(candidate, index)
            driven = np.hstack([observed[:, :3], track])
            course = self._course(part, driven, driven, "samples")
            return follow(model, p, course, self.crew, TOLERANCE).forces

        return self._recent_balance.get(key, compute)

    def _sensor_scale(self, candidate: Candidate, index: int) -> float:
        """Return the slope of the pressure difference that the sensors of a candidate show over the true one."""
        if not self._shown_otherwise(candidate):
            return 1.0
        observed, shown = self._states(candidate, index)[0], self._plain_states[index][0]
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
        out = np.zeros((len(self._measured), len(CHANNELS)))
        if windows:
            joint_errors(self.joint_readings(candidate), self._measured, out)
        acceleration, slides = self._columns["acceleration"], self.evidence.sliding
        for index, (part, _) in enumerate(self._groups):
            events, edges = self._places[index]
            line_errors(self._line_readings(candidate, index), self._measured[part], edges, out[part], LINES.start)
            balance, scale = self._balance(candidate, index), self._sensor_scale(candidate, index)
            force_errors(balance, scale, slides[part], acceleration[part], events, out[part], FORCES)
        homes = self.evidence.homes
        out[self.evidence.edges[:-1], HOME] = np.where(np.isfinite(homes), self.shown_at_zero(candidate) - homes, 0.0)
        out[:, LINES] += self._own_starts.corrections(candidate, out[:, LINES])
        return out

    @cached_property
    def _places(self) -> list[tuple[NDArray[np.int64], NDArray[np.int64]]]:
        """Breakaways, and edges of the tests, of each group, counted from where it begins."""
        events, edges, found = np.asarray(self.evidence.breakaways, dtype=np.int64), self.evidence.edges, []
        for part, _ in self._groups:
            own = events[(events >= part.start) & (events < part.stop)] - part.start
            found.append((own, edges[(edges >= part.start) & (edges <= part.stop)] - part.start))
        return found

    def centred(self, candidate: Candidate) -> Candidate:
        """Return the candidate with the mean of the tests for what each test begins with."""
        return self._own_starts.centred(candidate)

    @cached_property
    def _own_starts(self) -> OwnStarts:
        return OwnStarts(self.effects, self.evidence.edges, self._line_errors)

    def _line_errors(self, candidate: Candidate) -> Array:
        """Return the residuals (n, 2) of the line view alone, Pa: sum and difference."""
        out = np.empty((len(self._measured), 2))
        for index, (part, _) in enumerate(self._groups):
            lines, edges = self._line_readings(candidate, index), self._places[index][1]
            line_errors(lines, self._measured[part], edges, out[part], 0)
        return out

    def shown_at_zero(self, candidate: Candidate) -> float:
        """Return the reading (rad) of an arm at rest at its true zero."""
        if not self._shown_otherwise(candidate):
            return 0.0
        part, hardware = slice(int(self.evidence.edges[0]), int(self.evidence.edges[0]) + 2), self._groups[0][1]
        course = self._course(part, np.zeros((2, 2)), np.zeros((2, 4)), "tests")
        model = self.lines(candidate, hardware)
        p = self.vector(model, candidate, hardware)
        return float(follow(model, p, course, self.crew, TOLERANCE).readings[0, 0])


def _views_by_name(evidence: Evidence, names: tuple[str, ...]) -> Views:
    """Return the views in another process, which reads the effects from its own library."""
    from hjcamp.effects import load_effects

    library = load_effects()
    return Views(evidence, tuple(library[name] for name in names))
