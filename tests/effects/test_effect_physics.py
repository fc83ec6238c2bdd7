"""Each new effect against what its equation says, on one kernel that holds them all."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm
from scipy.signal import lfilter, lsim

from hjcamp.model.declare.course import Course, Followed
from hjcamp.model.run.inputs_along import inputs_along
from hjcamp.model.run.simulator import Simulator
from hjcamp.plants.pump_joint import PumpJoint

AREA = PumpJoint.parameters["joint_area"].default
PUMP_AREA = PumpJoint.parameters["pump_area"].default
STIFFNESS = PumpJoint.parameters["line_stiffness"].default
ARM, P1, P2 = 0, 1, 2


def motion(times: list[float], pump: list[float], pressures: tuple[float, float] = (0.5e6, 0.5e6)) -> Course:
    """Return a course of piecewise linear pump motion, 1 ms samples, without dither."""
    time = np.arange(round(times[-1] * 1000)) * 1e-3
    model = PumpJoint.courses()["sine"]
    n = len(time)
    position = np.interp(time, times, pump)
    observed = np.zeros((n, 4))
    observed[:, 0], observed[:, 1], observed[:, 2] = position, *pressures
    restart = np.zeros(n, dtype=np.int64)
    restart[0] = 2
    zeros = np.zeros(n)
    return Course(model.period, restart, time, position[:, None], observed, zeros[:, None], inputs_along(PumpJoint, len(time)))


def run(simulator: Simulator, course: Course, **values: float) -> Followed:
    """Follow ``course``; ``leakage__conductance`` opens the gate of leakage and sets its conductance."""
    full: dict[str, float] = {}
    for name, value in values.items():
        effect, _, parameter = name.partition("__")
        full.update({f"{effect}.{parameter}": value, f"gate.{effect}": 1.0} if parameter else {name: value})
    return simulator.follow(simulator.vector(full), course)


def force(followed: Followed) -> NDArray[np.float64]:
    """Return (p1 - p2) A2, N."""
    return (followed.readings[:, P1] - followed.readings[:, P2]) * AREA


def sliding(followed: Followed) -> float:
    """Return the friction without its viscous part over the last 100 ms of a positive slide, N."""
    speed = (followed.ideal[-1, 3] - followed.ideal[-100, 3]) / 0.099
    return float(np.mean(force(followed)[-100:])) - PumpJoint.parameters["viscous_positive"].default * speed


RISE = motion([0.1, 1.1], [0.0, 4e-3])


def test_presliding_breaks_away_at_static_and_slides_at_coulomb_friction(simulator: Simulator) -> None:
    slow = motion([0.1, 1.6, 2.1], [0.0, 5e-4, 4.5e-3])
    stiff = {"presliding__compliance": 2e-6, "presliding__fall_velocity": 1e-3}
    followed = run(simulator, slow, **stiff, presliding__lateness=40.0)
    assert np.max(force(followed)) == pytest.approx(7.20, rel=0.03)
    assert sliding(followed) == pytest.approx(5.27, rel=0.01)


def test_presliding_keeps_its_peak_however_fast_the_bristles_are_bent(simulator: Simulator) -> None:
    fast = motion([0.1, 0.4], [0.0, 4e-3])
    soft = {"presliding__compliance": 1e-5, "presliding__fall_velocity": 5e-4}
    peak = np.max(force(run(simulator, fast, **soft)))
    assert 0.9 * 7.20 < peak < 7.20
    # LuGre's friction falls with the speed of that bending
    assert np.max(force(run(simulator, fast, **soft, presliding__lateness=0.0))) < 0.85 * 7.20


def test_presliding_gives_way_before_breakaway_and_comes_back(simulator: Simulator) -> None:
    push = motion([0.1, 0.6, 0.8, 1.3, 1.5], [0.0, 2e-4, 2e-4, 0.0, 0.0])
    loose = run(simulator, push, presliding__compliance=1e-5).ideal[:, 3]
    assert np.all(run(simulator, push).ideal[:, 3] == 0.0)
    assert 2e-5 < np.max(loose) < 6e-5
    assert abs(loose[-1]) < 0.6 * np.max(loose)


def test_presliding_bristles_yield_one_after_the_other_and_unload_as_springs(simulator: Simulator) -> None:
    compliance, strength = 1e-5, 7.20
    push = motion([0.1, 1.1, 1.6, 1.9], [0.0, 3.2e-4, 3.2e-4, 2.6e-4])
    followed = run(simulator, push, presliding__compliance=compliance, presliding__lateness=40.0)
    travel, held = followed.ideal[:, 3], force(followed)
    each = compliance * np.array([0.2, 1.0, 1.8])
    rise = slice(300, 1100)
    expected = strength / 3.0 * np.tanh(travel[rise, None] / (each * strength)).sum(axis=1)
    assert np.max(expected) > 0.6 * strength
    assert held[rise] == pytest.approx(expected, abs=0.02 * strength)
    back = (held[1580] - held[1880]) / (travel[1580] - travel[1880])
    assert back == pytest.approx(np.sum(1.0 / (3.0 * each)), rel=0.03)


def test_line_resistance_drops_along_the_tube_and_a_steady_flow_drops_all_of_it(simulator: Simulator) -> None:
    resistance = 3e10
    course = PumpJoint.courses()["sine"]
    seen = run(simulator, course, line_resistance__resistance=resistance)
    from_pump = PUMP_AREA * np.append(np.diff(course.driven[:, 0]), 0.0) / course.period
    to_joint = AREA * np.gradient(seen.ideal[:, 3], course.period)
    lifted = seen.readings[:, P1] - seen.ideal[:, 1]
    left = (seen.ideal[:, 1] - seen.ideal[:, 2]) * AREA - seen.forces[:, 0]
    steady = np.abs(np.gradient(to_joint, course.period)) < 2e-5
    steady[-3:] = False
    lag = 0.25 * resistance / STIFFNESS
    flow = from_pump + to_joint
    expected = 0.25 * resistance * (flow - lag * np.gradient(flow, course.period))
    assert np.max(np.abs(lifted - expected)[steady]) < 200.0
    assert np.max(np.abs(left - 2 * AREA * expected)[steady]) < 0.01
    whole = lifted + left / (2 * AREA)
    assert np.max(np.abs(whole - 2.0 * expected)[steady]) < 500.0
    assert np.max(np.abs(lifted)) > 5e3


@pytest.mark.parametrize("share", [0.3, 0.5, 0.8])
def test_a_resistance_between_two_compliances_lets_the_far_one_lag(simulator: Simulator, share: float) -> None:
    resistance = 2e11
    held = {"static_positive": 60.0, "static_negative": 60.0}
    course = motion([0.05, 0.06, 0.1], [0.0, 2e-4, 2e-4])
    law = {"line_resistance__resistance": resistance, "line_resistance__far_share": share}
    seen = run(simulator, course, **law, **held).readings
    # two vessels of compliance (1 - f) / K and f / K: rates of their pressures, from both pressures and the pump's flow
    near, far = STIFFNESS / (1.0 - share), STIFFNESS / share
    rates = np.array([[-near, near], [far, -far]]) / resistance
    time = np.arange(0.0, 0.1, 1e-5)
    flow = np.where((time >= 0.05) & (time < 0.06), PUMP_AREA * 2e-4 / 0.01, 0.0)
    _, pressures, _ = lsim((rates, [[near], [0.0]], np.eye(2), np.zeros((2, 1))), flow, time)
    expected = 0.5e6 + pressures[::100, 0]
    height = np.ptp(expected)
    assert height > 4e4
    assert np.max(np.abs(seen[:, P1] - expected)) < 0.04 * height
    assert np.max(np.abs(seen[:, P2] - (1e6 - expected))) < 0.04 * height


def test_a_fitting_drops_the_square_of_the_flow(simulator: Simulator) -> None:
    k, speed = 4e17, 2e-3
    course = motion([0.1, 2.1], [0.0, 2.0 * speed])
    seen = run(simulator, course, line_resistance__resistance=0.0, line_resistance__turbulent=k)
    plain = run(simulator, course, line_resistance__resistance=0.0, line_resistance__turbulent=0.0)
    # sliding steadily: as much flows to the joint as from the pump
    flow = PUMP_AREA * speed
    lifted = (seen.readings[:, P1] - seen.ideal[:, 1])[-400:]
    assert float(np.mean(lifted)) == pytest.approx(0.5 * k * flow**2, rel=0.02)
    assert np.max(np.abs(plain.readings[:, P1] - plain.ideal[:, 1])) < 1e-6


def test_inertance_lifts_the_sensor_by_what_both_ends_accelerate(simulator: Simulator) -> None:
    course = PumpJoint.courses()["sine"]
    half = {"line_inertance__inertance": 4e8, "line_inertance__far_share": 0.5}
    seen = run(simulator, course, **half)
    flow = PUMP_AREA * np.gradient(course.driven[:, 0], course.period) + AREA * np.gradient(seen.ideal[:, 3], course.period)
    # the rate is taken over the time constant of the pump
    rate = PumpJoint.parameters["pump_a2"].default
    kept = np.exp(-rate * course.period)
    late = lfilter([1.0 - kept], [1.0, -kept], flow)
    expected = 4e8 * 0.25 * (flow - late) * rate
    lifted = seen.readings[:, P1] - seen.ideal[:, 1]
    assert np.dot(lifted, expected) / np.dot(expected, expected) == pytest.approx(1.0, abs=0.1)
    # slips change the flow within a sample or two, where differences of samples are no rate
    assert np.corrcoef(lifted, expected)[0, 1] > 0.9
    assert seen.readings[:, P2] - seen.ideal[:, 2] == pytest.approx(-lifted, abs=1e-6)


def test_backlash_is_the_play_operator(simulator: Simulator) -> None:
    held = {"static_positive": 60.0, "static_negative": 60.0}
    play = 4e-5
    time = np.arange(1500) * 1e-3
    pump = 3e-4 * np.sin(2 * np.pi * 2 * time) * np.exp(-time)
    course = motion([1.5], [0.0])
    course = replace(course, driven=pump[:, None])
    pistons = np.zeros(len(pump))
    for k in range(1, len(pump)):
        pistons[k] = np.clip(pistons[k - 1], pump[k] - play / 2, pump[k] + play / 2)
    seen = run(simulator, course, pump_backlash__play=play, **held).readings
    assert seen[:, P1] - 0.5e6 == pytest.approx(STIFFNESS * PUMP_AREA * pistons, abs=60.0)


def test_a_worn_screw_has_its_play_in_the_middle(simulator: Simulator) -> None:
    held = {"static_positive": 60.0, "static_negative": 60.0}
    play, worn = 4e-5, 2e6
    time = np.arange(1500) * 1e-3
    pump = 2e-4 * np.sin(2 * np.pi * 2 * time) + 4e-4 * time
    course = replace(motion([1.5], [0.0]), driven=pump[:, None])
    pistons = np.zeros(len(pump))
    for k in range(1, len(pump)):
        half = 0.5 * play * np.exp(-worn * pump[k - 1] ** 2)
        pistons[k] = np.clip(pistons[k - 1], pump[k] - half, pump[k] + half)
    seen = run(simulator, course, pump_backlash__play=play, pump_backlash__worn=worn, **held).readings[:, P1] - 0.5e6
    assert seen == pytest.approx(STIFFNESS * PUMP_AREA * pistons, abs=100.0)
    even = run(simulator, course, pump_backlash__play=play, **held).readings[:, P1] - 0.5e6
    assert np.max(np.abs(seen - even)) > 2e3


def test_cross_leakage_lets_the_difference_decay_and_keeps_the_sum(simulator: Simulator) -> None:
    rest = motion([1.0], [0.0], (0.5e6, 0.3e6))
    seen = run(simulator, rest, cross_leakage__conductance=1e-14).readings
    assert seen[:, P1] + seen[:, P2] == pytest.approx(0.8e6, abs=20.0)
    decay = np.exp(-2 * STIFFNESS * 1e-14 * np.arange(len(seen)) * 1e-3)
    assert seen[:, P1] - seen[:, P2] == pytest.approx(0.2e6 * decay, rel=1e-3)


def test_creep_makes_the_line_softer_for_slow_motion(simulator: Simulator) -> None:
    held = {"static_positive": 60.0, "static_negative": 60.0}
    course = motion([0.1, 0.11, 3.0], [0.0, 1e-4, 1e-4])
    seen = run(simulator, course, tubing_creep__share=0.25, tubing_creep__delay=0.2, **held).readings[:, P1] - 0.5e6
    step = STIFFNESS * PUMP_AREA * 1e-4
    assert np.max(seen) == pytest.approx(step, rel=0.03)
    assert seen[-1] == pytest.approx(step / 1.25, rel=0.01)


def test_a_part_of_the_creep_is_a_decade_faster(simulator: Simulator) -> None:
    share, delay, fast = 0.6, 0.8, 0.3
    held = {"static_positive": 60.0, "static_negative": 60.0}
    course = motion([0.1, 0.11, 2.0], [0.0, 1e-4, 1e-4])
    creep = {"tubing_creep__share": share, "tubing_creep__delay": delay, "tubing_creep__fast_share": fast}
    seen = run(simulator, course, **creep, **held).readings[:, P1] - 0.5e6
    # both elements hang on one pressure p = K (V - V_s - V_f), V constant after a step in the middle of the ramp
    parts, times = np.array([1.0 - fast, fast]), np.array([delay, delay / 10.0])
    rates = -(share * np.outer(parts, [1.0, 1.0]) + np.eye(2)) / times[:, None]
    settled = -np.linalg.solve(rates, share * parts / times)
    later = np.arange(0.02, 1.8, 0.2)
    volumes = np.array([settled - expm(rates * t) @ settled for t in later])
    places = 105 + np.round(later * 1e3).astype(int)
    expected = STIFFNESS * PUMP_AREA * 1e-4 * (1.0 - volumes.sum(axis=1))
    assert seen[places] == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize(("rest", "share"), [(0.3, 0.5), (2.7, 0.9)])
def test_static_friction_grows_with_the_rest(simulator: Simulator, rest: float, share: float) -> None:
    begin = 0.8 + rest
    course = motion([0.1, 0.5, 0.8, begin, begin + 0.6], [0.0, 2e-3, 2e-3, 2e-3, 4e-3])
    followed = run(
        simulator,
        course,
        static_friction_ageing__growth=0.5,
        static_friction_ageing__half_time=0.3,
        static_friction_ageing__rest_before=0.01,
    )
    moved = np.flatnonzero(np.diff(followed.ideal[:, 3]) > 1e-7)
    stopped = moved[moved < 700][-1]
    again = moved[moved > begin * 1000][0]
    rested = (again - stopped) * 1e-3
    assert rested / (rested + 0.3) > share
    assert force(followed)[again] == pytest.approx(7.20 * (1 + 0.5 * rested / (rested + 0.3)), rel=0.01)


def test_pressure_friction_adds_to_static_friction_with_both_pressures(simulator: Simulator) -> None:
    course = motion([0.1, 1.1], [0.0, 4e-3], (0.7e6, 0.7e6))
    followed = run(simulator, course, pressure_friction__coefficient=2e-6)
    assert np.max(force(followed)) == pytest.approx(7.20 + 2e-6 * (1.4e6 - 0.52e6), rel=0.01)


def test_friction_drift_and_position_friction_change_the_sliding_force(simulator: Simulator) -> None:
    drift = run(simulator, RISE, friction_drift__drift=0.1, friction_drift__settling_time=100.0)
    assert sliding(drift) == pytest.approx(5.27 * 1.1, rel=0.01)
    uneven = run(simulator, RISE, position_friction__amplitude=0.2, position_friction__period=6.0)
    angle = uneven.ideal[-100:, 3] / PumpJoint.parameters["pulley_radius"].default
    assert sliding(uneven) == pytest.approx(5.27 * np.mean(1 + 0.2 * np.sin(2 * np.pi * angle / 6.0)), rel=0.01)


def test_dither_relief_needs_dither_and_never_lifts_coulomb_above_static_friction(simulator: Simulator) -> None:
    wave = np.where(np.arange(len(RISE.time)) // 2 % 2 == 0, 1.0, -1.0)
    shaken = replace(RISE, given=inputs_along(PumpJoint, len(wave), dither=wave))
    values = {"dither_relief__static_relief": 0.5, "dither_relief__coulomb_relief": 0.1}
    assert np.array_equal(run(simulator, RISE, **values).readings, run(simulator, RISE).readings)
    relieved = run(simulator, shaken, **values)
    assert sliding(relieved) == pytest.approx(3.60, rel=0.02)
    assert relieved.steps < 20 * len(RISE.time)


def test_the_string_stretches_by_compliance_times_force(simulator: Simulator) -> None:
    held = {"static_positive": 60.0, "static_negative": 60.0}
    rest = motion([0.5], [0.0])
    weight = {"gravity_load__load_mass": 8.5e-3, "gravity_load__radius": 0.02, "gravity_load__rest_angle": -1.5}
    seen = run(simulator, rest, string_elasticity__compliance=1e-3, string_elasticity__arm_share=0.5, **held, **weight)
    load = -8.5e-3 * 9.81 * 0.02 / 3.41e-3 * np.sin(seen.readings[-1, ARM] + 1.5)
    assert seen.readings[-1, ARM] * 3.41e-3 == pytest.approx(1e-3 * 0.5 * load, rel=0.01)


@pytest.mark.parametrize("dead_share", [0.0, 0.5])
def test_the_encoder_is_late_as_its_transfer_function_says(simulator: Simulator, dead_share: float) -> None:
    course, lag = PumpJoint.courses()["sine"], 8e-3
    seen = run(simulator, course, encoder_lag__lag=lag, encoder_lag__dead_share=dead_share)
    angle, time = seen.ideal[:, 3] / 3.41e-3, np.arange(len(course.time)) * course.period
    _, expected, _ = lsim((np.trim_zeros([-dead_share * lag, 1.0]), [(1.0 - dead_share) * lag, 1.0]), angle, time)
    assert np.max(np.abs(angle - expected)) > 0.05
    assert seen.readings[:, ARM] == pytest.approx(expected, abs=2e-3)
    late = np.interp(time - lag, time, angle)
    assert np.std(expected - late) < (0.02 if dead_share == 0.0 else 0.005)


def test_the_arms_own_friction_keeps_it_behind_the_sliders(simulator: Simulator) -> None:
    there_and_back = motion([0.1, 1.1, 1.3, 2.3], [0.0, 2e-3, 2e-3, 0.0])
    seen = run(
        simulator,
        there_and_back,
        string_elasticity__compliance=1e-4,
        string_elasticity__arm_share=0.3,
        string_elasticity__friction_share=0.4,
    )
    lead = seen.readings[:, ARM] * 3.41e-3 - seen.ideal[:, 3]
    assert np.mean(lead[900:1090]) == pytest.approx(-1e-4 * 0.4 * 5.27, rel=0.03)
    assert np.mean(lead[2100:2290]) == pytest.approx(1e-4 * 0.4 * 2.97, rel=0.03)


def test_the_arm_is_held_while_the_push_on_the_sliders_changes_its_sign(simulator: Simulator) -> None:
    there_and_back = motion([0.1, 1.1, 1.3, 2.3], [0.0, 2e-3, 2e-3, 0.0])
    values = {"string_elasticity__compliance": 1e-4, "string_elasticity__friction_share": 0.4}
    seen = run(simulator, there_and_back, **values)
    # the string pulls the sliders back by 0.4 * 5.27 N; they yield to 0.6 * 4.03 N more
    push = force(seen) - 0.4 * 5.27
    before = slice(1300, 1300 + int(np.argmax(push[1300:] < -2.0)))
    assert push[before].max() > 0.5
    assert np.ptp(seen.ideal[before, 3]) < 1e-8
    assert np.ptp(seen.readings[before, ARM]) < 0.3 * 2.0 * np.pi / 1024


def test_presliding_starts_a_window_at_rest_with_bristles_that_carry_the_push(simulator: Simulator) -> None:
    rest = motion([0.4], [0.0], (0.5e6 + 3.0 / AREA, 0.5e6))
    windows = replace(rest, restart=np.where(np.arange(len(rest.time)) % 100 == 0, 1, 0))
    windows.restart[0] = 2
    seen = run(simulator, windows, presliding__compliance=1e-5)
    assert np.max(np.abs(seen.ideal[:, 3])) < 1e-7
    # with free bristles it would give way by 1e-5 m/N times 3 N, as far as the lines follow
    assert 100 * np.max(np.abs(seen.ideal[:, 3])) < 1e-5 * 3.0


def test_sensor_effects_leave_the_motion_alone(simulator: Simulator) -> None:
    course = PumpJoint.courses()["sine"]
    plain = run(simulator, course)
    seen = run(
        simulator,
        course,
        encoder_eccentricity__amplitude=0.05,
        encoder_eccentricity__phase=1.0,
        encoder_bias__bias=0.1,
        pressure_offset__offset1=1e4,
        pressure_gain__error2=0.1,
        pressure_gain__error1=0.0,
    )
    assert np.array_equal(seen.ideal, plain.ideal)
    angle = plain.readings[:, ARM]
    assert seen.readings[:, ARM] - angle == pytest.approx(0.1 + 0.05 * (np.sin(angle + 1.0) - np.sin(1.0)), abs=1e-9)
    assert seen.readings[0, ARM] == pytest.approx(0.1)
    assert seen.readings[:, P1] - plain.readings[:, P1] == pytest.approx(1e4, abs=1e-6)
    assert seen.readings[:, P2] == pytest.approx(1.1 * plain.readings[:, P2] - 1e4, abs=1e-6)


def test_a_sensor_s_zero_drifts_and_its_scale_bends(simulator: Simulator) -> None:
    course = PumpJoint.courses()["sine"]
    plain = run(simulator, course)
    zeros = {"pressure_offset__offset1": 0.0, "pressure_offset__offset2": 0.0, "pressure_gain__error1": 0.0}
    drifted = run(simulator, course, **zeros, pressure_offset__drift2=-3e3, pressure_gain__error2=0.0)
    assert np.array_equal(drifted.ideal, plain.ideal) and drifted.readings[:, P1] == pytest.approx(plain.readings[:, P1])
    assert drifted.readings[:, P2] - plain.readings[:, P2] == pytest.approx(-3e3 * course.time, abs=1e-6)
    # a scale error of 10 % at zero that has doubled at half a megapascal
    bent = run(simulator, course, **zeros, pressure_gain__error2=0.1, pressure_gain__bend=2e-6)
    pressure = plain.readings[:, P2]
    assert bent.readings[:, P2] == pytest.approx(pressure + 0.1 * pressure * (1.0 + pressure / 5e5), abs=1e-6)
