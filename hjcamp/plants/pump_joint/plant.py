"""The pump-driven joint of chapter 4: motor-cylinder pump, two lines, slider-pulley joint, sensors."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from hjcamp.model.declare.marks import limited, signal, slot
from hjcamp.model.declare.parameter import Channel, Cut, Input, Parameter, State
from hjcamp.model.declare.plant import Plant
from hjcamp.model.declare.port import Port
from hjcamp.plants.pump_joint.effects import COVERS, INSTANCES
from hjcamp.plants.pump_joint.fields import FIELDS, LABELS, ONE_OF
from hjcamp.plants.pump_joint.rooms import ROOMS

if TYPE_CHECKING:
    from hjcamp.model.declare.course import Course
    from hjcamp.schema import Group

INFINITE = float("inf")


class PumpJoint(Plant):
    """Two pump cylinders push water through flexible lines into two cylinders that turn an arm by string and pulley.

    States are gauge pressures, displacements and velocities in SI units. Within one friction regime (held, moving in
    the positive or in the negative direction) the published equations are linear. Sources: thesis 4.3 - 4.5.
    """

    name = "pump_joint"
    subsystems = ("pump", "lines", "joint", "sensors")
    fields = FIELDS
    one_of = ONE_OF
    rig = ("pump", "amplifier", "tubing")
    setups = ("payload", "orientation")
    labels = LABELS
    rooms = ROOMS

    pump_position = State("m", 1e-9, 1e-3, text="travel of the pump motor's nut")
    pump_velocity = State("m/s", 1e-6, 0.01, text="speed of the pump motor's nut")
    pump_acceleration = State("m/s^2", 1e-4, 1.0, text="acceleration of the pump motor's nut")
    pressure1 = State("Pa", 5.0, 1e4, text="pressure of line 1 as if the water could not part")
    pressure2 = State("Pa", 5.0, 1e4, text="pressure of line 2 as if the water could not part")
    slider_position = State("m", 1e-9, 1e-3, text="travel of the sliders")
    slider_velocity = State("m/s", 2e-6, 0.01, text="speed of the sliders")

    command = Input("rad", text="command to the pump's position loop, after the delay")
    dither = Input("V", text="dither added to the pump motor voltage", field="dither_v", plausible=(-24.0, 24.0))
    preload_flow = Input("m^3/s", text="flow from the preload cylinders into each line")
    friction_scatter = Input("1", 1.0, text="factor on static and Coulomb friction at this instant")
    direction = Input("1", text="friction regime: 0 held, +1 and -1 moving")
    time = Input("s", text="time since the start of the command phase")

    pump_gain = Parameter("m/(rad*s^3)", 350.9, (1e-6, 1e12), text="numerator of the pump's transfer function (4.3.4)")
    pump_a2 = Parameter("1/s", 245.0, (1e-3, 1e6), text="its coefficient of s^2 (4.3.4)")
    pump_a1 = Parameter("1/s^2", 35700.0, (1e-3, 1e9), text="its coefficient of s (4.3.4)")
    pump_a0 = Parameter("1/s^3", 2205000.0, (1e-3, 1e12), text="its constant coefficient (4.3.4)")
    pump_delay = Parameter("s", 0.002, (0.0, 0.1), text="delay of its command (4.3.4)")
    pump_speed_limit = Parameter("m/s", 0.060, (1e-4, 10.0), text="largest speed of the pistons (4.3.5)")
    pump_acceleration_limit = Parameter("m/s^2", INFINITE, (1e-3, INFINITE), text="largest acceleration of the pistons")
    dither_gain = Parameter("rad/V", 0.628, (0.0, 1e3), text="pump command equivalent to one volt at the motor")
    pump_lead = Parameter(
        "m/rad", 1e-3 / (2 * math.pi), (1e-6, 0.1), text="travel of the pistons for one radian of the motor (3.8)"
    )
    pump_area = Parameter("m^2", math.pi / 4 * 6.35e-3**2, (1e-9, 1e-2), text="bore area of a pump cylinder (4.4.1)")
    joint_area = Parameter("m^2", math.pi / 4 * 4.0e-3**2, (1e-9, 1e-2), text="bore area of a joint cylinder (4.4.1)")
    line_stiffness = Parameter("Pa/m^3", 2.57e13, (1e11, 1e16), "log-uniform", "dp/dV of one line (4.4.3)")
    stiffness_asymmetry = Parameter("1", 0.0, (-0.3, 0.3), text="difference of dp/dV of the two lines over their mean")
    vapour_pressure = Parameter("Pa", -99e3, (-2e5, 0.0), text="gauge pressure below which the water parts")
    pulley_radius = Parameter("m", 3.41e-3, (1e-5, 1.0), text="pitch radius of the pulley (3.6)")
    travel_stop = Parameter("m", INFINITE, (1e-5, INFINITE), text="travel of the sliders at which they meet a stop (E2: none)")
    stop_stiffness = Parameter("N/m", 1e5, (1e3, 1e8), text="stiffness of that stop")
    moving_mass = Parameter("kg", 0.0185, (1e-3, 10.0), "log-uniform", "effective mass at the sliders (4.5.2)")
    static_positive = Parameter("N", 7.20, (0.05, 60.0), text="static friction, positive direction (4.5.1.4)")
    coulomb_positive = Parameter("N", 5.27, (0.05, 60.0), text="Coulomb friction, positive direction")
    viscous_positive = Parameter("N*s/m", 23.5, (0.0, 1000.0), text="viscous friction, positive direction")
    static_negative = Parameter("N", 4.03, (0.05, 60.0), text="static friction, negative direction (4.5.1.3)")
    coulomb_negative = Parameter("N", 2.97, (0.05, 60.0), text="Coulomb friction, negative direction")
    viscous_negative = Parameter("N*s/m", 17.2, (0.0, 1000.0), text="viscous friction, negative direction")
    encoder_count = Parameter("rad", 2 * math.pi / 1024, (1e-7, 2.0), text="one count of the arm encoder (3.7)")
    pump_count = Parameter("rad", 2 * math.pi / 4096, (1e-7, 2.0), text="one count of the pump motor encoder")
    pressure_noise = Parameter("Pa", 700.0, (0.0, 1e6), text="standard deviation of a pressure sample")

    motor = Port("actuator", subsystem="pump", command="pump_command", demand="command")
    pistons = Port("transmission", subsystem="pump", output="piston_velocity", input="motor_velocity")
    line1 = Port(
        "store", group="lines", subsystem="lines", like={"loss": "pump_flow"},
        loss="leak1", stiffness="stiffness1", level="pressure1",
    )  # fmt: skip
    line2 = Port(
        "store", group="lines", subsystem="lines", like={"loss": "pump_flow"},
        loss="leak2", stiffness="stiffness2", level="pressure2",
    )  # fmt: skip
    crossing = Port(
        "path",
        subsystem="lines",
        like={"flow": "pump_flow"},
        flow="cross_flow",
        upstream="pressure1",
        downstream="pressure2",
    )
    seal = Port(
        "contact", subsystem="joint", velocity="slider_velocity", speed="speed", push="push", direction="direction",
        travel="slider_position", mass="moving_mass", static="friction_static", breakaway="friction_static",
        coulomb="friction_coulomb", viscous="friction_viscous", locks="friction_locks", friction="friction", dither="dither",
    )  # fmt: skip
    sliders = Port(
        "body", subsystem="joint", like={"force": "friction"}, position="slider_position", velocity="slider_velocity",
        acceleration="slider_acceleration", push="push", force="load_force", mass="mass",
    )  # fmt: skip
    encoder = Port("sensor", subsystem="sensors", reading="arm_reading", true="arm_angle")
    gauge1 = Port("sensor", group="gauges", subsystem="sensors", reading="pressure1_reading", true="pressure1")
    gauge2 = Port("sensor", group="gauges", subsystem="sensors", reading="pressure2_reading", true="pressure2")
    instances = INSTANCES
    covers = COVERS

    # No arm turns beyond a turn (3.6.4). Water parts at -0.1 MPa; the sensors end at 0.69 (3.9), and a simulated arm
    # in the vertical reaches 1.0. Twice the joint's stroke of 20 mm is more than the pump ever moves.
    channels = (
        Channel(
            "arm_deg", "arm_reading", "joint", 180 / math.pi, counts="encoder_count",
            plausible=(-2 * math.pi, 2 * math.pi), along=("reference_deg",),
        ),
        Channel(
            "pressure1_mpa", "pressure1_reading", "lines", 1e-6, noise="pressure_noise", plausible=(-0.12e6, 2e6)
        ),
        Channel(
            "pressure2_mpa", "pressure2_reading", "lines", 1e-6, noise="pressure_noise", plausible=(-0.12e6, 2e6)
        ),
        Channel(
            "pump_deg", "pump_reading", "pump", 180 / math.pi, counts="pump_count", required=False,
            plausible=(-80 * math.pi, 80 * math.pi), along=("command_deg", "pid_deg", "feedforward_deg"),
        ),
    )  # fmt: skip
    geared = {  # noqa: RUF012
        "arm_deg": (
            "pump_deg",
            pump_lead.default * pump_area.default / (joint_area.default * pulley_radius.default),
        )
    }
    balance = ("push", "friction", "friction_static", "mass")
    observed = {  # noqa: RUF012 - read only, like every declaration here
        "pump_position": ("pump_deg", "pump_lead"),
        "pressure1": ("pressure1_mpa", None),
        "pressure2": ("pressure2_mpa", None),
        "slider_position": ("arm_deg", "pulley_radius"),
    }
    base_parameters = (
        "static_positive",
        "coulomb_positive",
        "viscous_positive",
        "static_negative",
        "coulomb_negative",
        "viscous_negative",
        "line_stiffness",
    )
    # 4.5.2 computes the mass from drawings (E13), to about a seventh; two tubes of one make differ by a percent.
    uncertain = {"moving_mass": 0.15, "stiffness_asymmetry": 0.01}  # noqa: RUF012
    cuts = (
        Cut("whole"),
        Cut(
            "pump",
            driven={"pump_position": "pump_deg"},
            slopes={"pump_velocity": "pump_position"},
            frozen=("pump_acceleration",),
        ),
        Cut(
            "lines",
            driven={"pump_position": "pump_deg", "slider_position": "arm_deg"},
            slopes={"pump_velocity": "pump_position", "slider_velocity": "slider_position"},
            frozen=("pump_acceleration",),
        ),
        Cut(
            "inverse",
            driven={
                "pump_position": "pump_deg",
                "pressure1": "pressure1_mpa",
                "pressure2": "pressure2_mpa",
                "slider_position": "arm_deg",
            },
            slopes={"pump_velocity": "pump_position", "slider_velocity": "slider_position"},
            frozen=("pump_acceleration",),
        ),
    )

    # What follows takes longer to import than the equations, or imports them.
    @classmethod
    def settings(cls) -> Mapping[str, type[Group]]:
        """Return the groups pump, amplifier, tubing, joint, friction, payload, orientation and procedure."""
        from hjcamp.plants.pump_joint.schema import GROUPS

        return GROUPS

    @classmethod
    def check_settings(cls, config: Mapping[str, Any]) -> None:
        """Raise ``UsageError`` for a value of the hardware or the procedure that this joint cannot have."""
        from hjcamp.plants.pump_joint.schema import check_hardware

        check_hardware(config)

    @classmethod
    def configured(cls, config: Mapping[str, Any]) -> dict[str, float]:
        """Return the parameters of the configured hardware, SI."""
        from hjcamp.plants.pump_joint.hardware import plant_parameters

        return plant_parameters(config)

    @classmethod
    def blocked(cls, config: Mapping[str, Any]) -> bool:
        """Return whether the configured joint is the blocked one of 4.4."""
        joint = config.get("joint")
        return isinstance(joint, Mapping) and joint.get("name") == "blocked"

    @classmethod
    def courses(cls) -> Mapping[str, Course]:
        """Return the motions of the pump on which an effect is tried out."""
        from hjcamp.plants.pump_joint.menu import pump_courses

        return pump_courses(cls)

    @staticmethod
    def equations(state, parameter, drive, rate):  # type: ignore[no-untyped-def]
        """Give the rate of every state from states, parameters and inputs."""
        # --- Motor-cylinder pump (4.3): x / theta = gain / (s^3 + a2 s^2 + a1 s + a0)
        pump_command = slot(drive.command + parameter.dither_gain * drive.dither, "rad", "command of the pump motor")
        motor_velocity = signal(
            limited(state.pump_velocity, -parameter.pump_speed_limit, parameter.pump_speed_limit),
            "m/s",
            "speed of the pump motor's nut",
        )
        rate.pump_position = motor_velocity
        rate.pump_velocity = limited(
            state.pump_acceleration, -parameter.pump_acceleration_limit, parameter.pump_acceleration_limit
        )
        rate.pump_acceleration = (
            parameter.pump_gain * pump_command
            - parameter.pump_a2 * state.pump_acceleration
            - parameter.pump_a1 * state.pump_velocity
            - parameter.pump_a0 * state.pump_position
        )
        piston_velocity = slot(motor_velocity, "m/s", "speed of the pump pistons")

        # --- Lines (4.4.3.15, 4.4.3.16): dp = dp/dV (A1 dx - A2 dy); water parts at the vapour pressure
        pressure1 = slot(limited(state.pressure1, parameter.vapour_pressure, 1e9), "Pa", "pressure of line 1")
        pressure2 = slot(limited(state.pressure2, parameter.vapour_pressure, 1e9), "Pa", "pressure of line 2")
        stiffness1 = slot(parameter.line_stiffness * (1.0 + 0.5 * parameter.stiffness_asymmetry), "Pa/m^3", "dp/dV of line 1")
        stiffness2 = slot(parameter.line_stiffness * (1.0 - 0.5 * parameter.stiffness_asymmetry), "Pa/m^3", "dp/dV of line 2")
        leak1 = slot(0.0, "m^3/s", "flow lost from line 1")
        leak2 = slot(0.0, "m^3/s", "flow lost from line 2")
        cross_flow = slot(0.0, "m^3/s", "flow from line 1 to line 2")
        slider_flow = signal(parameter.joint_area * state.slider_velocity, "m^3/s", "flow into joint cylinder 1")
        pump_flow = signal(parameter.pump_area * piston_velocity, "m^3/s", "flow from pump cylinder 1")
        rate.pressure1 = stiffness1 * (pump_flow - slider_flow + drive.preload_flow - leak1 - cross_flow)
        rate.pressure2 = stiffness2 * (slider_flow - pump_flow + drive.preload_flow - leak2 + cross_flow)
        joint_pressure1 = slot(pressure1, "Pa", "pressure in joint cylinder 1")
        joint_pressure2 = slot(pressure2, "Pa", "pressure in joint cylinder 2")

        # --- Joint (4.5): m dv/dt = (p1 - p2) A2 + load - friction, held while |push| <= static friction
        slider_angle = signal(state.slider_position / parameter.pulley_radius, "rad", "angle of the pulley (3.6.4)")
        arm_angle = slot(slider_angle, "rad", "angle of the arm")
        load_force = slot(0.0, "N", "outside force on the sliders, positive in the positive direction")
        beyond = signal(
            limited(state.slider_position, -parameter.travel_stop, parameter.travel_stop) - state.slider_position,
            "m",
            "travel back to the stop, 0 within it",
        )
        push = signal(
            (joint_pressure1 - joint_pressure2) * parameter.joint_area + load_force + parameter.stop_stiffness * beyond,
            "N",
            "force on the sliders before friction (4.4.3.16)",
        )
        forward = signal(
            1.0 if drive.direction > 0.0 or (drive.direction == 0.0 and push > 0.0) else 0.0,
            "1",
            "1 where the friction of the positive direction applies",
        )
        speed = signal(abs(state.slider_velocity), "m/s", "speed of the sliders without sign")
        friction_static = slot(
            drive.friction_scatter * (parameter.static_positive if forward > 0.0 else parameter.static_negative),
            "N",
            "static friction",
        )
        friction_coulomb = slot(
            drive.friction_scatter * (parameter.coulomb_positive if forward > 0.0 else parameter.coulomb_negative),
            "N",
            "Coulomb friction",
        )
        friction_viscous = slot(
            parameter.viscous_positive if forward > 0.0 else parameter.viscous_negative, "N*s/m", "viscous friction"
        )
        friction_locks = slot(1.0, "1", "0 where friction passes rest without a leap, and holds nothing")
        friction = slot(
            drive.direction * friction_coulomb + friction_viscous * state.slider_velocity,
            "N",
            "friction on the moving sliders (4.5.1.2)",
        )
        mass = slot(parameter.moving_mass, "kg", "effective mass at the sliders")
        slider_acceleration = signal(
            (push - friction) / mass if drive.direction != 0.0 else 0.0, "m/s^2", "acceleration (4.5.2.3)"
        )
        rate.slider_position = state.slider_velocity
        rate.slider_velocity = slider_acceleration

        # --- Sensors (3.7, 3.9)
        arm_reading = slot(arm_angle, "rad", "angle seen by the arm encoder")
        pressure1_reading = slot(pressure1, "Pa", "pressure seen by sensor 1")
        pressure2_reading = slot(pressure2, "Pa", "pressure seen by sensor 2")
        pump_reading = slot(state.pump_position / parameter.pump_lead, "rad", "angle seen by the pump motor encoder")
        return arm_reading, pressure1_reading, pressure2_reading, pump_reading
