"""The plant files that users of the servo and of the two joints would write; guesses are filled in."""

SERVO = '''"""A motor that swings a load about its axis."""

from __future__ import annotations

from hjcamp.plant import (
    Input, Measured, Parameter, Plant, State, actuator, body, contact, outside, sensor, sin{more}
)  # fmt: skip


class Servo(Plant):
    r"""A motor turns an arm with a weight, against friction.

    .. math:: J \\ddot\\theta = \\tau - w \\sin\\theta - F_c\\,\\mathrm{{sign}}\\,\\dot\\theta - F_v\\,\\dot\\theta
    """

    angle = State("rad", typical=0.5)
    speed = State("rad/s", typical=1.0)

    torque = Input("N*m", typical={weight:g}, text="torque of the motor as commanded")

    inertia = Parameter("kg*m^2", {inertia:g}, ({inertia_low:g}, {inertia_high:g}), base=True, text="moment of inertia")
    weight = Parameter("N*m", {weight:g}, (0.0, {weight_high:g}), base=True, text="weight times its distance from the axis")
    coulomb = Parameter("N*m", {coulomb:g}, ({coulomb_low:g}, {coulomb_high:g}), base=True, text="Coulomb friction")
    viscous = Parameter("N*m*s", {viscous:g}, (0.0, {viscous_high:g}), base=True, text="viscous friction")

    angle_deg = Measured("encoder", of="angle")

    @staticmethod
    def equations(state, parameter, drive, rate):
        """The motor's torque against weight, friction and inertia."""
        motor = actuator(drive.torque)
        load = outside("N*m")
        push = motor + load - parameter.weight * sin(state.angle)
        friction = contact(
            state.speed, push=push, coulomb=parameter.coulomb, viscous=parameter.viscous, travel=state.angle
        )
        rate.angle = state.speed
        rate.speed = body(push - friction, mass=parameter.inertia, load=load, position=state.angle)
        {sensor}
'''
ROPE = '''"""A motor joint that moves an arm over a rope; both joints have friction and an encoder."""

from __future__ import annotations

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, contact, outside, sensor, sin


class Pendulum(Plant):
    r"""A motor turns a pulley, and a rope turns an arm with a weight.

    .. math:: J_m \\ddot\\theta_m = \\tau - \\tau_r - f_m, \\quad J_a \\ddot\\theta_a = \\tau_r - w \\sin\\theta_a - f_a
    """

    motor_angle = State("rad", typical=0.5)
    motor_speed = State("rad/s", typical=1.0)
    arm_angle = State("rad", typical=0.5)
    arm_speed = State("rad/s", typical=1.0)

    torque = Input("N*m", typical={weight:g}, text="torque of the motor as commanded")

    motor_inertia = Parameter("kg*m^2", {motor_inertia:g}, ({motor_low:g}, {motor_high:g}), base=True)
    arm_inertia = Parameter("kg*m^2", {inertia:g}, ({inertia_low:g}, {inertia_high:g}), base=True)
    weight = Parameter("N*m", {weight:g}, (0.0, {weight_high:g}), base=True, text="weight times its distance from the axis")
    rope = Parameter("N*m", {rope:g}, ({rope_low:g}, {rope_high:g}), "log-uniform", base=True, text="stiffness for each radian")
    rope_damping = Parameter("N*m*s", {damping:g}, (0.0, {damping_high:g}), base=True)
    motor_coulomb = Parameter("N*m", {motor_coulomb:g}, ({coulomb_low:g}, {coulomb_high:g}), base=True)
    arm_coulomb = Parameter("N*m", {coulomb:g}, ({coulomb_low:g}, {coulomb_high:g}), base=True)
    motor_viscous = Parameter("N*m*s", {viscous:g}, (0.0, {viscous_high:g}), base=True)
    arm_viscous = Parameter("N*m*s", {viscous:g}, (0.0, {viscous_high:g}), base=True)

    motor_deg = Measured("motor_encoder", of="motor_angle")
    arm_deg = Measured("arm_encoder", of="arm_angle")

    @staticmethod
    def equations(state, parameter, drive, rate):
        """Two bodies with friction, and the rope between them."""
        motor = actuator(drive.torque)
        motor_load = outside("N*m")
        arm_load = outside("N*m")
        stretched = parameter.rope * (state.motor_angle - state.arm_angle)
        passed = stretched + parameter.rope_damping * (state.motor_speed - state.arm_speed)
        motor_push = motor + motor_load - passed
        arm_push = passed + arm_load - parameter.weight * sin(state.arm_angle)
        motor_rub = contact(
            state.motor_speed, push=motor_push, coulomb=parameter.motor_coulomb, viscous=parameter.motor_viscous,
            travel=state.motor_angle,
        )
        arm_rub = contact(
            state.arm_speed, push=arm_push, coulomb=parameter.arm_coulomb, viscous=parameter.arm_viscous,
            travel=state.arm_angle,
        )
        rate.motor_angle = state.motor_speed
        rate.motor_speed = body(
            motor_push - motor_rub, mass=parameter.motor_inertia, load=motor_load, position=state.motor_angle
        )
        rate.arm_angle = state.arm_speed
        rate.arm_speed = body(arm_push - arm_rub, mass=parameter.arm_inertia, load=arm_load, position=state.arm_angle)
        motor_encoder = sensor(state.motor_angle)
        arm_encoder = sensor(state.arm_angle)
'''
