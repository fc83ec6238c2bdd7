"""A model in which every effect is behind a gate: what is absent costs nothing and changes nothing."""

from __future__ import annotations

import numpy as np
import pytest
from plain_kernel import uncompiled

from hjcamp.effects import load_effects
from hjcamp.errors import UsageError
from hjcamp.model.compile.compose import MOST_GATED, Composition
from hjcamp.model.compile.shared import CURVED, PRESENT, STATES
from hjcamp.model.compile.source_text import behind_one_test
from hjcamp.model.declare.effect import Effect
from hjcamp.model.run.simulator import Simulator
from hjcamp.plants.pump_joint import PumpJoint

NAMES = ("leakage", "line_inertance", "presliding", "pump_backlash", "string_elasticity", "tubing_creep")
LIBRARY = tuple(load_effects([])[name] for name in NAMES)
CUT = PumpJoint.cut("pump")
SPAN = 1e-3
SLOPE = 10.0


class Plain:
    """A kernel as plain Python, and what it needs for one step."""

    def __init__(self, effects: tuple[type[Effect], ...], gated: bool) -> None:
        self.simulator = Simulator(Composition(PumpJoint, effects, CUT, gated=gated))
        uncompiled(self.simulator)
        self.functions = vars(self.simulator.kernel)

    def step(self, direction: float, values: dict[str, float], state: dict[str, float], gate: str = "") -> dict[str, float]:
        """Return the state after one step with correction by name, that with all rates corrected by ``name all``."""
        names, call = self.simulator.states, self.functions
        p = self.simulator.vector(values | ({f"gate.{gate}": 1.0} if gate else {}))
        z, u = np.array([state.get(name, 0.0) for name in names]), self.simulator.inputs()
        plan, space, steps = self.simulator.propagators(z, p)
        row = call["regime_row"](1 if direction else 0, 0, p, plan, space, steps, SPAN)
        found: dict[str, float] = {}
        for kind in ("", " all"):
            # a kernel's scratch rows are longer than its states; slopes are carried on from the step before
            a, before = np.zeros(3 * len(names)), np.zeros(3 * len(names))
            for k in plan[STATES + plan[PRESENT] :][: plan[CURVED]]:
                at = plan[STATES + k]
                before[len(names) + at] = SLOPE * self.simulator.composition.states[names[at]].typical
            begin = (0.1, SPAN, direction, z, u, p)
            sparse = plan[PRESENT] > call["WRITTEN"]
            if sparse:
                call["predict_present"](*begin, plan, space, steps, row, a, before)
            else:
                call["predict"](*begin, steps, row, a, before)
            end, rest = (0.1 + SPAN, SPAN, direction, z, a, u, p), (steps, row, before, 1.0)
            if kind or (sparse and plan[CURVED]):
                call["correct_present"](*end, plan, space, *rest, kind != "")
            elif plan[CURVED]:
                call["correct"](*end, *rest)
            found |= {f"{name}{kind}": value for name, value in zip(names, a, strict=False)}
        return found


@pytest.fixture(scope="module")
def gated() -> Plain:
    return Plain(LIBRARY, True)


@pytest.mark.parametrize("direction", [0.0, 1.0])
@pytest.mark.parametrize("effect", LIBRARY, ids=NAMES)
def test_with_one_gate_open_a_step_is_that_of_the_effect_alone(gated: Plain, effect: type[Effect], direction: float) -> None:
    alone = Plain((effect,), False)
    generator = np.random.default_rng(7)
    states = gated.simulator.composition.states
    start = {name: one.typical * float(generator.uniform(-1.0, 1.0)) for name, one in states.items()}
    start["slider_velocity"] = direction * 2e-3
    values = {f"{effect.name}.{key}": value for key, value in effect.defaults().items()}
    found, wanted = gated.step(direction, values, start, effect.name), alone.step(direction, values, start)
    assert [found[name] for name in wanted] == pytest.approx(list(wanted.values()), rel=1e-9)
    absent = [name for name in found if name not in wanted]
    assert absent
    assert all(found[name] == start[name.removesuffix(" all")] for name in absent)


def test_effects_on_one_slot_stand_behind_one_test() -> None:
    lines = ["gates = int(p_gates)", "a = 1.0", "if gates & 1: a = a + 2.0", "if gates & 8: a = a * 3.0"]
    lines += ["b = a", "if gates & 4: b = b + 1.0", "c = b"]
    text = "\n".join(behind_one_test(lines))
    assert "if gates & 9:\n    if gates & 1: a = a + 2.0\n    if gates & 8: a = a * 3.0\nb = a\nif gates & 4: b" in text
    for opened, wanted in ((0, 1.0), (1, 3.0), (8, 3.0), (9, 9.0), (13, 10.0)):
        scope = {"p_gates": float(opened)}
        exec(text, scope)
        assert scope["c"] == wanted


def test_a_library_too_large_to_be_compared_at_once_is_refused() -> None:
    many = LIBRARY[:1] * (MOST_GATED + 1)
    with pytest.raises(UsageError, match=rf"{MOST_GATED + 1} effects .* at most {MOST_GATED}"):
        Composition(PumpJoint, many, CUT, gated=True)
