"""Stretch between slider and pulley."""

from __future__ import annotations

from math import sqrt

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State


class StringElasticity(Effect):
    r"""The arm hangs on the sliders by a string that stretches; it swings, and its own friction keeps it behind.

    .. math:: (1 - a)\,m\,\dot v = F - (1 - b) f + F_{st} - a F_l, \quad
              a\,m\,(\dot v + \ddot s) = a F_l - F_{st} - F_b, \quad F_{st} = s / c + d\,\dot s,

    .. math:: F_b = k_b\, q + d_b\,\dot q, \quad \dot q = v_a - |v_a|\,\frac{k_b\, q}{b F_c}, \quad
              k_b = b \bar F_c / q_0, \quad v_a = v + \dot s

    with s the lead of the arm over the sliders, a the share of mass and load on the arm (published: 5.3 of 18.5 g), b that
    of the dry friction on the arm's side; d gives the arm without payload a damping ratio of 0.1. The arm's friction is
    that of the direction in which the arm itself moves, and builds up over q0, one count of the encoder.
    Seen as: the arm stays behind after each reversal, and rings after a breakaway, while the pressures show little of it.
    Not for: slow elasticity of the lines (line_stiffness, tubing_creep). A payload makes it far easier to see.
    Source: two masses on a spring, e.g. Den Hartog (1956), Mechanical Vibrations, section 3.1; thesis 3.6 and 4.5; Dahl
    (1968), doi:10.21236/ADA041920.
    """

    plant = "pump_joint"
    subsystem = "joint"
    compliance = Parameter("m/N", 4e-4, (1e-6, 3e-3), "log-uniform", "stretch for each newton in the string", off=0.0)
    arm_share = Parameter("1", 0.29, (0.1, 0.97), text="share of the moving mass and of the load that is on the arm")
    friction_share = Parameter("1", 0.2, (0.0, 0.9), text="share of the dry friction on the arm's side")
    stretch = State("m", 5e-8, 1e-5, text="lead of the arm over the sliders")
    stretch_velocity = State("m/s", 1e-4, 1e-2, text="its rate")
    grip = State("m", 2e-7, 1e-5, text="deflection of what holds the arm")

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
    def d_grip(
        grip,
        slider_velocity,
        stretch_velocity,
        coulomb_positive,
        coulomb_negative,
        friction_scatter,
        pulley_radius,
        encoder_count,
    ):
        """Rate of the deflection of what holds the arm, m/s."""
        arm = slider_velocity + stretch_velocity
        level = friction_scatter * (coulomb_positive if arm > 0.0 else coulomb_negative)
        most = level / (0.5 * (coulomb_positive + coulomb_negative)) * pulley_radius * encoder_count
        return arm - abs(arm) * grip / most

    @staticmethod
    def d_stretch_velocity(
        stretch,
        stretch_velocity,
        grip,
        load_force,
        mass,
        slider_velocity,
        slider_acceleration,
        coulomb_positive,
        coulomb_negative,
        friction_scatter,
        moving_mass,
        pulley_radius,
        encoder_count,
        compliance,
        arm_share,
        friction_share,
    ):
        """Acceleration of the arm relative to the sliders, m/s^2."""
        string = stretch / compliance + 0.2 * sqrt(arm_share * moving_mass / compliance) * stretch_velocity
        arm_mass = mass * arm_share / (1.0 - arm_share)
        arm_load = (load_force - string) * arm_share / (1.0 - arm_share)
        stiffness = friction_share * 0.5 * (coulomb_positive + coulomb_negative) / (pulley_radius * encoder_count)
        arm = slider_velocity + stretch_velocity
        level = friction_scatter * (coulomb_positive if arm > 0.0 else coulomb_negative)
        most = level / (0.5 * (coulomb_positive + coulomb_negative)) * pulley_radius * encoder_count
        held = stiffness * grip + 0.6 * sqrt(stiffness * arm_mass) * (arm - abs(arm) * grip / most)
        return (arm_load - string - held) / arm_mass - slider_acceleration

    @staticmethod
    def load_force(load_force, stretch, stretch_velocity, moving_mass, compliance, arm_share):
        """Force of string and load on the sliders, N."""
        string = stretch / compliance + 0.2 * sqrt(arm_share * moving_mass / compliance) * stretch_velocity
        return load_force * (1.0 - arm_share) + string

    @staticmethod
    def friction_static(friction_static, friction_share):
        """Static friction of the sliders, N."""
        return friction_static * (1.0 - friction_share)

    @staticmethod
    def friction_coulomb(friction_coulomb, friction_share):
        """Coulomb friction of the sliders, N."""
        return friction_coulomb * (1.0 - friction_share)

    @staticmethod
    def mass(mass, arm_share):
        """Mass that moves rigidly with the sliders, kg."""
        return mass * (1.0 - arm_share)

    @staticmethod
    def arm_angle(stretch, pulley_radius):
        """Angle by which the arm leads the pulley, rad."""
        return stretch / pulley_radius
