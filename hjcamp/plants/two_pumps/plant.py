"""The joint with a pump for each line and no preload mechanism (6.4)."""

from __future__ import annotations

import math

from hjcamp.model.declare.field import PHASE, TIME, Field
from hjcamp.model.declare.marks import body, contact, limited, outside, part, sensor, signal, slot, store, transmission
from hjcamp.model.declare.parameter import Input, Measured, Parameter, State
from hjcamp.model.declare.plant import Plant
from hjcamp.model.declare.scatter import FrictionScatter
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.two_pumps.delays import TwoDelays

ONE = PumpJoint.parameters
TRAVEL = (-80 * math.pi, 80 * math.pi)


def motor_pump(command, position, velocity, acceleration, parameter, rate):  # type: ignore[no-untyped-def]
    """Return the speed of a pump's nut (4.3): x / theta = gain / (s^3 + a2 s^2 + a1 s + a0)."""
    speed = signal(limited(velocity, -parameter.pump_speed_limit, parameter.pump_speed_limit), "m/s", "speed of the nut")
    rate[position] = speed
    rate[velocity] = acceleration
    rate[acceleration] = (
        parameter.pump_gain * command
        - parameter.pump_a2 * acceleration
        - parameter.pump_a1 * velocity
        - parameter.pump_a0 * position
    )
    return speed


class TwoPumps(Plant):
    r"""Each line has a motor-cylinder pump of its own; lines, joint and sensors are those of the pump joint.

    .. math:: \dot p_1 = K_1 (A_1 \dot x_1 - A_2 v), \quad \dot p_2 = K_2 ((1 + \epsilon) A_1 \dot x_2 + A_2 v)

    A pump's travel is positive where it pushes water into its line; the one-pump joint is the case x2 = -x1. ``mismatch`` is
    the relative gain of pump 2. The thesis gives a layout and no law (6.4, Figure 6.4.1); all numbers are the pump joint's.
    """

    controlled = "arm_deg"
    choices = {"controller": "opposite", "procedure": "two_pumps", "trajectory": "ramp_pos"}  # noqa: RUF012
    actuation = TwoDelays
    friction_varies = FrictionScatter(0.03, 0.03, 0.2)
    subsystems = ("pump", "lines", "joint", "sensors")
    fields = (
        TIME,
        PHASE,
        Field("reference_deg", "deg", False, "desired arm angle"),
        Field("arm_deg", "deg", True, "arm encoder"),
        Field("pressure1_mpa", "MPa", True, "pressure of line 1, gauge"),
        Field("pressure2_mpa", "MPa", True, "pressure of line 2, gauge"),
        Field("pump1_deg", "deg", False, "encoder of pump motor 1; 360 deg = 1 mm of piston travel"),
        Field("pump2_deg", "deg", False, "encoder of pump motor 2"),
        Field("command1_deg", "deg", False, "command to pump 1's own position loop"),
        Field("command2_deg", "deg", False, "command to pump 2's own position loop"),
        Field("pid_deg", "deg", False, "feedback part of the command"),
        Field("feedforward_deg", "deg", False, "feedforward part of the command"),
    )

    pump1_position = State("m", 1e-9, 1e-3, text="travel of nut 1, positive into line 1")
    pump1_velocity = State("m/s", 1e-6, 0.01, text="speed of nut 1")
    pump1_acceleration = State("m/s^2", 1e-4, 1.0, text="acceleration of nut 1")
    pump2_position = State("m", 1e-9, 1e-3, text="travel of nut 2, positive into line 2")
    pump2_velocity = State("m/s", 1e-6, 0.01, text="speed of nut 2")
    pump2_acceleration = State("m/s^2", 1e-4, 1.0, text="acceleration of nut 2")
    pressure1 = State("Pa", 5.0, 1e4, start=0.26e6, scatter=3e3, text="pressure of line 1 as if the water could not part")
    pressure2 = State("Pa", 5.0, 1e4, start=0.26e6, scatter=3e3, text="pressure of line 2 as if the water could not part")
    slider_position = State("m", 1e-9, 1e-3, text="travel of the sliders")
    slider_velocity = State("m/s", 2e-6, 0.01, text="speed of the sliders")

    command1 = Input("rad", typical=10.0, field="command1_deg", text="command to pump 1, after the delay")
    command2 = Input("rad", typical=10.0, field="command2_deg", text="command to pump 2, after the delay")

    pump_delay = TwoDelays.pump_delay
    pump_gain, pump_a2, pump_a1, pump_a0 = (ONE[name] for name in ("pump_gain", "pump_a2", "pump_a1", "pump_a0"))
    pump_speed_limit, pump_lead, pump_area = (ONE[name] for name in ("pump_speed_limit", "pump_lead", "pump_area"))
    joint_area, line_stiffness, stiffness_asymmetry, vapour_pressure = (
        ONE[name] for name in ("joint_area", "line_stiffness", "stiffness_asymmetry", "vapour_pressure")
    )
    mismatch = Parameter("1", 0.0, (-0.5, 0.5), text="relative gain of pump 2 over pump 1")
    loss1 = Parameter("m^3/(s*Pa)", 0.0, (0.0, 1e-9), text="conductance of a leak of line 1")
    loss2 = Parameter("m^3/(s*Pa)", 0.0, (0.0, 1e-9), text="conductance of a leak of line 2")
    pulley_radius, moving_mass = ONE["pulley_radius"], ONE["moving_mass"]
    static_positive, coulomb_positive, viscous_positive = (ONE[f"{kind}_positive"] for kind in ("static", "coulomb", "viscous"))
    static_negative, coulomb_negative, viscous_negative = (ONE[f"{kind}_negative"] for kind in ("static", "coulomb", "viscous"))
    base_parameters = PumpJoint.base_parameters

    arm_deg = Measured("encoder", of="slider_position", counts=2 * math.pi / 1024, plausible=(-2 * math.pi, 2 * math.pi))
    pressure1_mpa = Measured("gauge1", of="pressure1", noise=700.0, plausible=(-0.12e6, 2e6))
    pressure2_mpa = Measured("gauge2", of="pressure2", noise=700.0, plausible=(-0.12e6, 2e6))
    pump1_deg = Measured("motor1", of="pump1_position", counts=2 * math.pi / 4096, required=False, plausible=TRAVEL)
    pump2_deg = Measured("motor2", of="pump2_position", counts=2 * math.pi / 4096, required=False, plausible=TRAVEL)

    @staticmethod
    def equations(state, parameter, drive, rate):  # type: ignore[no-untyped-def]
        """Give the rate of every state from states, parameters and inputs."""
        # --- Two motor-cylinder pumps (4.3)
        nut1 = part(
            motor_pump, drive.command1, state.pump1_position, state.pump1_velocity, state.pump1_acceleration, parameter, rate
        )
        nut2 = part(
            motor_pump, drive.command2, state.pump2_position, state.pump2_velocity, state.pump2_acceleration, parameter, rate
        )
        pistons1 = transmission(nut1, subsystem="pump")
        pistons2 = transmission(nut2, subsystem="pump")

        # --- Lines (4.4.3.16), each with its own pump
        pressure1 = slot(limited(state.pressure1, parameter.vapour_pressure, 1e9), "Pa", "pressure of line 1")
        pressure2 = slot(limited(state.pressure2, parameter.vapour_pressure, 1e9), "Pa", "pressure of line 2")
        slider_flow = signal(parameter.joint_area * state.slider_velocity, "m^3/s", "flow into joint cylinder 1")
        rate.pressure1 = store(
            parameter.pump_area * pistons1 - slider_flow - parameter.loss1 * pressure1,
            stiffness=parameter.line_stiffness * (1.0 + 0.5 * parameter.stiffness_asymmetry),
            name="line1",
            group="lines",
            subsystem="lines",
        )
        rate.pressure2 = store(
            (1.0 + parameter.mismatch) * parameter.pump_area * pistons2 + slider_flow - parameter.loss2 * pressure2,
            stiffness=parameter.line_stiffness * (1.0 - 0.5 * parameter.stiffness_asymmetry),
            name="line2",
            group="lines",
            subsystem="lines",
        )

        # --- Joint (4.5)
        load_force = outside("N", "outside force on the sliders")
        push = signal((pressure1 - pressure2) * parameter.joint_area, "N", "force of the water on the sliders")
        friction = contact(
            state.slider_velocity,
            push=push + load_force,
            coulomb=(parameter.coulomb_positive, parameter.coulomb_negative),
            static=(parameter.static_positive, parameter.static_negative),
            viscous=(parameter.viscous_positive, parameter.viscous_negative),
            travel=state.slider_position,
            load=pressure1 + pressure2,
            subsystem="joint",
        )
        rate.slider_position = state.slider_velocity
        rate.slider_velocity = body(
            push + load_force - friction,
            mass=parameter.moving_mass,
            load=load_force,
            position=state.slider_position,
            subsystem="joint",
        )
        arm_angle = transmission(state.slider_position / parameter.pulley_radius, subsystem="joint")

        # --- Sensors
        encoder = sensor(arm_angle, subsystem="sensors")
        gauge1 = sensor(pressure1, group="gauges", subsystem="sensors")
        gauge2 = sensor(pressure2, group="gauges", subsystem="sensors")
        motor1 = sensor(state.pump1_position / parameter.pump_lead, subsystem="sensors")
        motor2 = sensor(state.pump2_position / parameter.pump_lead, subsystem="sensors")
