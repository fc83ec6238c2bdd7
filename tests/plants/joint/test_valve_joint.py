"""The valve-driven joint against nine calculations by hand (further plants, A.8)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hjcamp.model.compile.compose import Composition
from hjcamp.model.run.simulator import Given, Simulator
from hjcamp.plants.valve_joint.plant import ValveJoint
from hjcamp.plants.valve_joint.valves import Valves

AREA = math.pi / 4 * 4e-3**2
STIFFNESS, CONDUCTANCE, SUPPLY = 2.57e13, 3.196e-9, 0.6e6
SMOOTH = {"tooth_ripple": 0.0, "laminar": 0.0}
FREE = SMOOTH | {"static": 0.0, "coulomb": 0.0, "viscous": 0.0}
BLOCKED = SMOOTH | {"static": 60.0}
PERIOD = ValveJoint.period


@pytest.fixture(scope="module")
def joint() -> Simulator:
    """The joint under given valve openings."""
    return Simulator(Composition(ValveJoint), free=True)


def run(
    joint: Simulator, seconds: float, openings: Any, values: Mapping[str, float], start: tuple[float, ...]
) -> dict[str, np.ndarray]:
    """Return the states of a run with four openings, constant (4,) or (n, 4)."""
    n = round(seconds / PERIOD) + 1
    inputs = np.tile(joint.inputs(), (n, 1))
    for k in range(4):
        inputs[:, joint.composition.inputs.index(f"valve{k + 1}")] = np.asarray(openings).T[k]
    begins = np.zeros(n, dtype=np.int64)
    begins[0] = 1
    given = Given(PERIOD, begins, np.arange(n) * PERIOD, inputs, np.array([start]))
    states = joint.run_free(joint.vector(values), given)[1]
    return dict(zip(joint.states, states.T, strict=True))


def test_a_blocked_piston_fills_by_the_square_root_law(joint: Simulator) -> None:
    """sqrt(ps - p) falls linearly by K C / 2; from half the supply to all of it in 13.3 ms."""
    found = run(joint, 0.012, (1, 0, 0, 0), BLOCKED, (0.3e6, 0.3e6, 0.0, 0.0))
    time = np.arange(len(found["pressure1"])) * PERIOD
    by_hand = SUPPLY - np.maximum(math.sqrt(0.3e6) - STIFFNESS * CONDUCTANCE * time / 2, 0.0) ** 2
    assert found["pressure1"] == pytest.approx(by_hand, rel=1e-4)
    assert 2 * math.sqrt(0.3e6) / (STIFFNESS * CONDUCTANCE) == pytest.approx(13.3e-3, rel=5e-3)
    assert run(joint, 0.02, (1, 0, 0, 0), BLOCKED, (0.3e6, 0.3e6, 0.0, 0.0))["pressure1"][-1] == pytest.approx(SUPPLY, rel=1e-3)


def test_shut_valves_are_a_spring(joint: Simulator) -> None:
    """2 K A2^2 = 8117 N/m: 117 Hz with 15 g, 0.184 N m/rad at the arm, so 20 mN m turn it by 6.2 deg."""
    spring = 2 * STIFFNESS * AREA**2
    assert spring == pytest.approx(8117, rel=1e-3)
    found = run(joint, 0.1, (0, 0, 0, 0), FREE, (0.31e6, 0.29e6, 0.0, 0.0))
    time = np.arange(len(found["rack_position"])) * PERIOD
    push = 0.02e6 * AREA
    by_hand = push / spring * (1 - np.cos(math.sqrt(spring / 0.015) * time))
    assert found["rack_position"] == pytest.approx(by_hand, abs=2e-3 * push / spring)
    assert math.sqrt(spring / 0.015) / (2 * math.pi) == pytest.approx(117, rel=5e-3)
    at_arm = spring * ValveJoint.parameters["pinion_radius"].default ** 2
    assert math.degrees(0.020 / at_arm) == pytest.approx(6.2, abs=0.05)


def test_full_flow_drives_the_racks_at_the_speed_where_forces_balance(joint: Simulator) -> None:
    """A2 v = C sqrt(ps - p1) = C sqrt(p2), (p1 - p2) A2 = Fc + Cv v: 94 mm/s, 1135 deg/s."""
    found = run(joint, 0.25, (1, 0, 0, 1), SMOOTH, (0.3e6, 0.3e6, 0.0, 0.0))
    speed = found["rack_velocity"][-1]
    drop = (AREA * speed / CONDUCTANCE) ** 2
    assert SUPPLY - found["pressure1"][-1] == pytest.approx(drop, rel=1e-3)
    assert found["pressure2"][-1] == pytest.approx(drop, rel=1e-3)
    assert (found["pressure1"][-1] - found["pressure2"][-1]) * AREA == pytest.approx(2.2 + 19.9 * speed, rel=1e-3)
    assert 1e3 * speed == pytest.approx(94, abs=0.5)
    assert math.degrees(speed / ValveJoint.parameters["pinion_radius"].default) == pytest.approx(1135, rel=5e-3)


def test_fast_pulses_act_as_their_mean(joint: Simulator) -> None:
    """The mean speed under pulses tends to that of constant openings as the period of the pulses falls to 0."""
    start = (0.3e6, 0.3e6, 0.0, 0.0)
    steady = run(joint, 0.4, (0.5, 0, 0, 0.5), SMOOTH, start)["rack_position"]
    away = []
    for carrier in (32, 8, 2):
        on = (np.arange(401) % carrier < carrier // 2)[:, None] * np.array([1.0, 0.0, 0.0, 1.0])
        moved = run(joint, 0.4, on, SMOOTH, start)["rack_position"]
        away.append(abs((moved[-1] - moved[144]) / (steady[-1] - steady[144]) - 1.0))
    assert away[0] > away[1] > away[2]
    assert away[2] < 0.01


def test_both_inlets_both_outlets_and_none(joint: Simulator) -> None:
    """Both inlets fill both chambers and nothing moves; both outlets empty them; shut valves leave the arm where it is."""
    start = (0.3e6, 0.3e6, 0.0, 0.0)
    full, empty, shut = (run(joint, 0.2, one, {"laminar": 2e3}, start) for one in ((1, 0, 1, 0), (0, 1, 0, 1), (0, 0, 0, 0)))
    assert full["pressure1"][-1] == pytest.approx(SUPPLY, rel=1e-3) == full["pressure2"][-1]
    assert abs(empty["pressure1"][-1]) < 100.0
    for found in (full, empty, shut):
        assert not np.any(found["rack_position"])


def opened(switches: np.ndarray, **times: float) -> np.ndarray:
    """Return the mean openings of valve 1, sample by sample, as Python."""
    from hjcamp.model.declare.law import law_function

    law = law_function(Valves, {})
    c, m = Valves.vector(times), Valves.fresh_memory()
    return np.array([law(float(one), 0.0, 1.0, PERIOD, c, m)[0] for one in switches])


def test_a_pulse_keeps_its_volume_and_loses_what_the_valve_is_late() -> None:
    """A pulse of w opens for w; later opening takes the difference away; one shorter than the travel tr gives w^2 / tr."""
    pulse = np.r_[np.ones(6), np.zeros(24)]
    equal = opened(pulse, opening_delay=2.5e-3, closing_delay=2.5e-3, valve_travel=1e-3)
    assert equal.sum() == pytest.approx(6.0)
    assert np.flatnonzero(equal)[0] == 2
    for open_s, close_s in ((3.3e-3, 2.5e-3), (2.0e-3, 3.7e-3)):
        found = opened(pulse, opening_delay=open_s, closing_delay=close_s, valve_travel=0.0)
        assert found.sum() * PERIOD == pytest.approx(6e-3 + close_s - open_s)
    short = opened(np.r_[1.0, np.zeros(20)], opening_delay=1.4e-3, closing_delay=1.4e-3, valve_travel=4e-3)
    assert short.sum() * PERIOD == pytest.approx((1e-3) ** 2 / 4e-3)


def test_the_mean_opening_of_a_sample_stands_for_the_trapezoid_within_it(joint: Simulator) -> None:
    """Pulses with a fraction of a sample as dead time and 1 ms of travel, against openings every 20 us: within 1 % of the travel."""
    pulses = np.tile(np.r_[np.ones(5), np.zeros(11)], 8)
    coarse = opened(pulses, opening_delay=2.4e-3, closing_delay=2.4e-3, valve_travel=1e-3)
    start = (0.3e6, 0.3e6, 0.0, 0.0)
    found = run(joint, (len(coarse) - 1) * PERIOD, coarse[:, None] * np.array([1.0, 0.0, 0.0, 1.0]), SMOOTH, start)
    fine = 2e-5
    time = np.arange(round((len(coarse) - 1) * PERIOD / fine) + 1) * fine + 0.5 * fine
    corners = [(16e-3 * k + 2.4e-3 + at, level) for k in range(8) for at, level in ((0, 0), (1e-3, 1), (5e-3, 1), (6e-3, 0))]
    profile = np.interp(time, *np.array(corners).T)
    assert np.sum(profile) * fine == pytest.approx(np.sum(coarse) * PERIOD, rel=1e-3)
    inputs = np.tile(joint.inputs(), (len(time), 1))
    for k in (1, 4):
        inputs[:, joint.composition.inputs.index(f"valve{k}")] = profile
    begins = np.zeros(len(time), dtype=np.int64)
    begins[0] = 1
    states = joint.run_free(joint.vector(SMOOTH), Given(fine, begins, time, inputs, np.array([start])))[1]
    exact = states[:: round(PERIOD / fine), joint.states.index("rack_position")]
    assert np.ptp(exact) > 1e-3
    assert np.max(np.abs(found["rack_position"] - exact)) < 0.01 * np.ptp(exact)


def test_a_large_supply_makes_position_control_a_first_order_lag(joint: Simulator) -> None:
    """With fast valves and no friction a duty Kp e gives a lag of 1 / (Kp x speed at full duty)."""
    values = FREE | {"supply": 5e6, "moving_mass": 1e-3, "line_stiffness": 1e15}
    start = (2.5e6, 2.5e6, 0.0, 0.0)
    full = run(joint, 0.05, (1, 0, 0, 1), values, start)["rack_velocity"][-1]
    p, z = joint.vector(values), joint.begin(dict(zip(ValveJoint.states, start, strict=True)), joint.vector(values))
    gain, target = 500.0, 1e-3  # duty for one metre; mean openings, so that no pulse is left
    rates = joint.kernel.rates
    u, f = joint.inputs(), np.zeros(4)
    place = [joint.composition.inputs.index(f"valve{k}") for k in (1, 4)]

    def motion(time: float, state: np.ndarray) -> np.ndarray:
        u[place] = min(gain * (target - state[2]), 1.0)
        rates(-1, time, 1.0, state, u, p, f)
        return f.copy()

    lag = 1.0 / (gain * full)
    times = np.linspace(0.5, 3.0, 6) * lag
    found = solve_ivp(motion, (0.0, times[-1]), z, method="LSODA", t_eval=times, rtol=1e-8, atol=1e-10)
    moved = found.y[2]
    assert moved == pytest.approx(target * (1 - np.exp(-times / lag)), rel=0.02)


def test_what_reaches_the_racks_is_the_pressure_difference_over_the_supply(joint: Simulator) -> None:
    """At 20 mm/s against 2.6 N the racks get 34 % of the supply's power, the valves the rest."""
    speed = 0.020
    opening = AREA * speed / (CONDUCTANCE * math.sqrt((SUPPLY - (2.6 / AREA)) / 2))
    values = SMOOTH | {"coulomb": 2.6, "static": 2.6, "viscous": 0.0}
    found = run(joint, 1.0, (opening, 0, 0, opening), values, (0.3e6, 0.3e6, 0.0, 0.0))
    steady = {name: float(np.mean(one[500:])) for name, one in found.items()}  # nothing but the valves damps the racks
    assert steady["rack_velocity"] == pytest.approx(speed, rel=2e-3)
    power_in = SUPPLY * AREA * speed
    racks = (steady["pressure1"] - steady["pressure2"]) * AREA * speed
    valves = AREA * speed * ((SUPPLY - steady["pressure1"]) + steady["pressure2"])
    assert racks / power_in == pytest.approx(0.34, abs=0.006)
    assert valves / power_in == pytest.approx(1 - racks / power_in, rel=1e-3)


def test_an_independent_integration_agrees(joint: Simulator) -> None:
    """LSODA on equations written anew: pulses within a test, friction that holds and slides."""
    values = {"tooth_ripple": 0.0, "static": 2.2}
    n = 120
    on = np.zeros((n, 4))
    on[10:50, [0, 3]] = 1.0
    on[70:100, [1, 2]] = 0.6
    found = run(joint, (n - 1) * PERIOD, on, values, (0.3e6, 0.3e6, 0.0, 0.0))

    def flow(opening: float, drop: float) -> float:
        return opening * CONDUCTANCE * drop / math.sqrt(abs(drop) + 2e3)

    def rates(time: float, z: np.ndarray, o: np.ndarray) -> list[float]:
        p1, p2, _, v = z
        push = (max(p1, 0.0) - max(p2, 0.0)) * AREA
        rub = min(max(push, -2.2), 2.2) if abs(v) < 1e-7 else math.copysign(2.2, v) + 19.9 * v
        # a steep line stands for the leap of friction
        rub = 2.2 * math.tanh(v / 2e-5) + 19.9 * v if abs(v) >= 1e-7 else rub
        return [
            STIFFNESS * (flow(o[0], SUPPLY - p1) - flow(o[1], p1) - AREA * v),
            STIFFNESS * (flow(o[2], SUPPLY - p2) - flow(o[3], p2) + AREA * v),
            v,
            (push - rub) / 0.015,
        ]

    z = np.array([0.3e6, 0.3e6, 0.0, 0.0])
    worst = 0.0
    for k in range(n - 1):
        z = solve_ivp(rates, (0.0, PERIOD), z, args=(on[k],), method="LSODA", rtol=1e-6, atol=1e-9, max_step=2e-4).y[:, -1]
        worst = max(worst, abs(z[2] - found["rack_position"][k + 1]))
    assert np.ptp(found["rack_position"]) > 1e-3
    assert worst < 5e-3 * np.ptp(found["rack_position"])
