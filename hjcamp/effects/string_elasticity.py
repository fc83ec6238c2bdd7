"""Stretch between slider and pulley."""

from __future__ import annotations

from math import sqrt

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter, State


class StringElasticity(Effect):
    r"""The arm hangs on the sliders by a string that stretches; it swings ahead of them and behind.

    .. math:: (1 - a)\,m\,\dot v = F - f + F_{st} - a F_l, \quad
              a\,m\,(\dot v + \ddot s) = a F_l - F_{st}, \quad F_{st} = s / c + d\,\dot s

    with s the lead of the arm over the sliders and a the share of mass and load on the arm (published: 5.3 of 18.5 g);
    d gives the arm without payload a damping ratio of 0.1.
    Seen as: the arm rings after each breakaway and gives way under a load, while the pressures show little of it.
    Not for: slow elasticity of the lines (line_stiffness, tubing_creep). A payload makes it far easier to see.
    Source: two masses on a spring, e.g. Den Hartog (1956), Mechanical Vibrations, section 3.1; thesis 3.6 and 4.5.
    """

    subsystem = "joint"
    compliance = Parameter("m/N", 4e-4, (1e-6, 3e-3), "log-uniform", "stretch for each newton in the string", off=0.0)
    arm_share = Parameter(
        "1", 0.29, (0.1, 0.97), text="share of the moving mass and of the load that is on the arm", shape=True
    )
    stretch = State("m", 1e-8, 1e-5, text="lead of the arm over the sliders")
    stretch_velocity = State("m/s", 1e-5, 1e-2, text="its rate")

    @staticmethod
    def start_stretch(stretch, stretch_velocity, load_force, moving_mass, compliance, arm_share):
        """Start stretched by the load alone, m."""
        string = stretch / compliance + 0.2 * sqrt(arm_share * moving_mass / compliance) * stretch_velocity
        return compliance * arm_share / (1.0 - arm_share) * (load_force - string)

    @staticmethod
    def d_stretch(stretch_velocity):
        """Rate of the stretch, m/s."""
        return stretch_velocity

    @staticmethod
    def d_stretch_velocity(
        stretch, stretch_velocity, load_force, mass, slider_acceleration, moving_mass, compliance, arm_share
    ):
        """Acceleration of the arm relative to the sliders, m/s^2."""
        string = stretch / compliance + 0.2 * sqrt(arm_share * moving_mass / compliance) * stretch_velocity
        arm_mass = mass * arm_share / (1.0 - arm_share)
        arm_load = (load_force - string) * arm_share / (1.0 - arm_share)
        return (arm_load - string) / arm_mass - slider_acceleration

    @staticmethod
    def load_force(load_force, stretch, stretch_velocity, moving_mass, compliance, arm_share):
        """Force of string and load on the sliders, N."""
        string = stretch / compliance + 0.2 * sqrt(arm_share * moving_mass / compliance) * stretch_velocity
        return load_force * (1.0 - arm_share) + string

    @staticmethod
    def mass(mass, arm_share):
        """Mass that moves rigidly with the sliders, kg."""
        return mass * (1.0 - arm_share)

    @staticmethod
    def arm_angle(stretch, pulley_radius):
        """Angle by which the arm leads the pulley, rad."""
        return stretch / pulley_radius
