"""Both lines together: volumes in, pressures out, at the pump end and at the joint end."""

import numpy as np

from truth.compiled import within
from truth.pump_joint.lines import creep_step, cross_leak, line_pressure, line_volume, outside_leak, tube_flow
from truth.pump_joint.plant import Plant

# Share of a line's compliance at the joint end, and the loss time of its wall, which damps the water column.
JOINT_END_SHARE = 0.5
WALL_TIME = 1.1e-4
# Rows of the state: volume at the pump end, at the joint end, flow between, slow and fast creep, pressures a and b.
PUMP_VOLUME, JOINT_VOLUME, FLOW, SLOW_CREEP, FAST_CREEP, PUMP_PRESSURE, JOINT_PRESSURE = 0, 1, 2, 3, 4, 5, 6


@within
def has_tube(plant: Plant) -> bool:
    """Say whether the two ends of a line are kept apart (pi section); otherwise the line is one volume."""
    return (plant.tube_resistance + plant.tube_turbulence + plant.tube_inertance + plant.kink_resistance) > 0.0


@within
def fill_lines(state: np.ndarray, pressures: np.ndarray, stiffness: np.ndarray, plant: Plant) -> None:
    """Set the volumes of both lines so that they hold the given gauge pressures (Pa) with the creep they have."""
    share = JOINT_END_SHARE if has_tube(plant) else 0.0
    for line in range(2):
        volume = line_volume(pressures[line], stiffness[line], plant.air_volume, plant.air_exponent)
        volume += state[SLOW_CREEP, line] + state[FAST_CREEP, line]
        state[PUMP_VOLUME, line] = (1 - share) * volume
        state[JOINT_VOLUME, line] = share * volume
        state[FLOW, line] = 0.0


@within
def lines_step(
    state: np.ndarray, pump_in: float, joint_in: float, stiffness: np.ndarray, angle: float, plant: Plant, step: float
) -> None:
    """Advance both lines: `pump_in` and `joint_in` (m^3) enter line 1 (pump) and leave it (joint); line 2 mirrors.

    Conservation of volume; with the pi section on, the sensor is at the pump end and the joint feels the other end.
    """
    tube = has_tube(plant)
    crossing = 0.0
    if plant.cross_conductance > 0.0:
        crossing = cross_leak(state[PUMP_PRESSURE, 0] - state[PUMP_PRESSURE, 1], plant) * step
    for line in range(2):
        sign = 1.0 if line == 0 else -1.0
        entering = sign * (pump_in - crossing)
        if plant.leak_conductance > 0.0:
            entering -= outside_leak(state[PUMP_PRESSURE, line], plant) * step
        creep = state[SLOW_CREEP, line] + state[FAST_CREEP, line]
        if not tube:
            state[PUMP_VOLUME, line] += entering - sign * joint_in
            pressure = line_pressure(state[PUMP_VOLUME, line] - creep, stiffness[line], plant.air_volume, plant.air_exponent)
            state[PUMP_PRESSURE, line] = pressure
            state[JOINT_PRESSURE, line] = pressure
            continue
        near, far = 1 - JOINT_END_SHARE, JOINT_END_SHARE
        resistance = plant.tube_resistance
        if plant.kink_resistance > 0.0 and line == 0:
            bend = max(angle - plant.kink_angle, 0.0)
            resistance += plant.kink_resistance * bend * bend
        drop = state[PUMP_PRESSURE, line] - state[JOINT_PRESSURE, line]
        series = stiffness[line] * (1 / near + 1 / far)
        flow = tube_flow(state[FLOW, line], drop, resistance, series, plant, step)
        state[FLOW, line] = flow
        state[PUMP_VOLUME, line] += entering - flow * step
        state[JOINT_VOLUME, line] += flow * step - sign * joint_in
        near_volume = state[PUMP_VOLUME, line] - near * creep
        far_volume = state[JOINT_VOLUME, line] - far * creep
        state[PUMP_PRESSURE, line] = line_pressure(
            near_volume, stiffness[line] / near, near * plant.air_volume, plant.air_exponent
        )
        far_pressure = line_pressure(far_volume, stiffness[line] / far, far * plant.air_volume, plant.air_exponent)
        if plant.tube_inertance > 0.0:
            far_pressure += WALL_TIME * stiffness[line] / far * (flow - sign * joint_in / step)
        state[JOINT_PRESSURE, line] = far_pressure


@within
def wall_creep(state: np.ndarray, stiffness: np.ndarray, plant: Plant, span: float) -> None:
    """Let the wall creep for `span` seconds: a slow and a fast Kelvin-Voigt element in series with the elastic wall."""
    if plant.creep_share == 0.0:
        return
    for line in range(2):
        target = plant.creep_share * state[PUMP_PRESSURE, line] / stiffness[line]
        slow, fast = 1 - plant.creep_fast_share, plant.creep_fast_share
        slow_span = min(span, plant.creep_time)
        fast_span = min(span, plant.creep_time / plant.creep_fast_ratio)
        state[SLOW_CREEP, line] = creep_step(state[SLOW_CREEP, line], slow * target, plant.creep_time, slow_span)
        fast_time = plant.creep_time / plant.creep_fast_ratio
        state[FAST_CREEP, line] = creep_step(state[FAST_CREEP, line], fast * target, fast_time, fast_span)
