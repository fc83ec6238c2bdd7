"""The motor-cylinder pump: a sampled position servo with an amplifier lag, and the carriage that drives the pistons."""

from numba import njit

from truth.compiled import within
from truth.pump_joint.plant import PUMP_AREA, Plant

FULL_SCALE_VOLT = 10.0
TOP_SPEED = 0.060


@njit
def servo_step(
    position: float, speed: float, drive: float, command: float, dither: float, plant: Plant, step: float
) -> tuple[float, float, float]:
    """Advance the pump servo by one step; return position (m), speed (m/s), amplifier output (V).

    A direct-current motor with an amplifier lag under position and speed feedback, saturated at 10 V and 60 mm/s:
    u = kp (x_c - x) - kv v;  f' = w (u - f);  v' = k f - b v. Linear, it has about the poles of thesis 4.3.4.
    Source: a cascade servo from any drives textbook (e.g. Leonhard, Control of Electrical Drives, ch. 7).
    """
    volt = plant.position_gain * (command - position) - plant.speed_gain * speed + dither
    volt = min(max(volt, -FULL_SCALE_VOLT), FULL_SCALE_VOLT)
    drive += step * plant.amplifier_rate * (volt - drive)
    speed = (speed + step * plant.motor_gain * drive) / (1 + step * plant.motor_drag)
    speed = min(max(speed, -TOP_SPEED), TOP_SPEED)
    return position + step * speed, speed, drive


@within
def carriage_step(
    carriage: float, nut: float, nut_change: float, pressure_difference: float, plant: Plant, step: float
) -> float:
    """Move the piston carriage (m) by the nut, through the play and with the direction-dependent gain error.

    Contact mechanics: inside the play only the hydraulic load (p1 - p2) A1 beyond the seal friction moves the
    carriage, overdamped at 400 N s/m; at its ends the nut takes it along rigidly. In the other form the play
    is that of a worn thread. Load balance, no source needed.
    """
    half = 0.5 * plant.backlash
    if plant.backlash_form != 0.0:
        # a worn thread has most play where it is used most, in the middle
        half *= 1.3 / (1 + (nut / 0.6e-3) ** 2)
    if plant.forward_gain_error != 0.0:
        carriage += abs(nut_change) * plant.forward_gain_error
    if half == 0.0:
        return carriage + nut_change
    gap_load = -pressure_difference * PUMP_AREA
    if abs(gap_load) > plant.carriage_friction:
        excess = abs(gap_load) - plant.carriage_friction
        carriage += step * (excess if gap_load > 0 else -excess) / 400.0
    return min(max(carriage, nut - half), nut + half)
