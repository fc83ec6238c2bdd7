"""Play between the pump motor and its pistons."""

from __future__ import annotations

from math import exp

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State


class PumpBacklash(Effect):
    r"""The pistons stand still while the nut of the pump motor crosses the play.

    .. math:: g^+ = \operatorname{clip}(g + \dot x\,\Delta t,\ -b/2,\ b/2), \quad \dot x_p = \dot x - (g^+ - g)/\Delta t, \quad
              b = b_0\,e^{-w x^2}

    with g the travel of the nut ahead of the pistons; seal friction holds the pistons (play operator). At the start
    the line pressures press the pistons against one flank. A worn screw has most play in the middle, where it is used most: w > 0.
    Seen as: pressures that lag the pump by a fixed travel after each reversal, 16 kPa for each 20 um.
    Not for: lag that depends on speed. Alike where the arm reverses too: encoder_lag.
    Source: Nordin & Gutman (2002), Automatica 38(10), 1633-1649, doi:10.1016/S0005-1098(02)00047-X; thesis 3.8.
    """

    plant = "pump_joint"
    subsystem = "pump"
    play = Parameter("m", 2e-5, (2e-6, 5e-4), "log-uniform", "whole travel of the nut between both flanks", shape=True, off=0.0)
    worn = Parameter("1/m^2", 0.0, (0.0, 1e7), text="how fast the play falls away from the middle of the travel")
    gap = State("m", 1e-9, 1e-5, text="travel of the nut ahead of the pistons")
    closing_speed = State("m/s", 1e-6, 0.01, text="speed of the nut relative to the pistons in this sample")
    sampled_time = State("s", 1e-6, 1.0, text="time of the sample before")

    @staticmethod
    def start_gap(play, pressure1, pressure2, pressure_noise):
        """Start on the flank that the pressure difference asks for, m."""
        return 0.5 * play * max(-1.0, min(1.0, (pressure1 - pressure2) / (10.0 * pressure_noise)))

    @staticmethod
    def start_sampled_time(time):
        """Start the clock, s."""
        return time

    @staticmethod
    def next_sampled_time(time):
        """Time of this sample, s."""
        return time

    @staticmethod
    def next_closing_speed(gap, motor_velocity, pump_position, play, worn, time, sampled_time):
        """Speed that takes the gap to the end of this sample or to the flank, m/s."""
        # The first sample of a log and the phases before the command have no sample before: 1 ms.
        period = max(time - sampled_time, 1e-3)
        half = 0.5 * play * exp(-worn * pump_position * pump_position)
        return (max(-half, min(half, gap + motor_velocity * period)) - gap) / period

    @staticmethod
    def d_gap(closing_speed):
        """Rate of the gap, m/s."""
        return closing_speed

    @staticmethod
    def piston_velocity(closing_speed):
        """Speed that the pistons lack, m/s."""
        return -closing_speed
