"""The earlier valve-driven joint: water under constant pressure, four on/off valves, two racks on one pinion (2.4, 3.2, 6.3)."""

from __future__ import annotations

import math
from math import sin, sqrt

from hjcamp.model.declare.field import PHASE, TIME, Field
from hjcamp.model.declare.marks import body, contact, limited, outside, path, sensor, signal, slot, store, transmission
from hjcamp.model.declare.parameter import Input, Measured, Parameter, State
from hjcamp.model.declare.plant import Plant
from hjcamp.model.declare.scatter import FrictionScatter
from hjcamp.plants.valve_joint.valves import Valves

DEGREE = math.pi / 180.0
PINION_M = 9.525e-3 / 2.0  # 18 teeth of 48 diametral pitch: 12.03 deg/mm; printed errors give 12.0 (2.4 against 6.3)


class ValveJoint(Plant):
    r"""Two single-acting cylinders push racks against one pinion; an inlet and an outlet valve feed each.

    .. math:: \dot p_1 = K (Q_1 - Q_2 - A_2 v), \quad \dot p_2 = K (Q_3 - Q_4 + A_2 v), \quad
              Q_i = o_i C \frac{\Delta p}{\sqrt{|\Delta p| + \Delta p_{lam}}}, \quad
              m \dot v = A_2 (p_1^+ - p_2^+) - \rho(y) F_c\,\mathrm{sign}\,v - C_v v

    Pressures are gauge, the return is open. Chambers begin at half the supply. Geometry and bore: thesis 2.4, 3.2; the
    pinion from four ratios of printed numbers. The text gives no valve, friction, mass or gain: those are assumed.
    """

    controlled = "arm_deg"
    choices = {"controller": "pva", "procedure": "valve", "trajectory": "ramp_pos"}  # noqa: RUF012
    actuation = Valves
    friction_varies = FrictionScatter(0.03, 0.03, 0.2)  # as the pump joint's rig
    drawn = ("tooth_phase",)
    subsystems = ("valves", "lines", "joint", "sensors")
    fields = (
        TIME,
        PHASE,
        Field("reference_deg", "deg", False, "desired arm angle"),
        Field("arm_deg", "deg", True, "arm angle by the hall sensor at a rack"),
        Field("pressure1_mpa", "MPa", True, "pressure of cylinder 1, gauge"),
        Field("pressure2_mpa", "MPa", True, "pressure of cylinder 2, gauge"),
        Field("valve1_ratio", "1", False, "mean opening of valve 1, into cylinder 1"),
        Field("valve2_ratio", "1", False, "mean opening of valve 2, out of cylinder 1"),
        Field("valve3_ratio", "1", False, "mean opening of valve 3, into cylinder 2"),
        Field("valve4_ratio", "1", False, "mean opening of valve 4, out of cylinder 2"),
        Field("duty1_ratio", "1", False, "duty of cylinder 1: valve 1 above 0, valve 2 below"),
        Field("duty2_ratio", "1", False, "duty of cylinder 2: valve 4 above 0, valve 3 below"),
    )

    pressure1 = State("Pa", 5.0, 1e5, start=0.3e6, scatter=3e3, text="pressure of cylinder 1 as if the water could not part")
    pressure2 = State("Pa", 5.0, 1e5, start=0.3e6, scatter=3e3, text="pressure of cylinder 2 as if the water could not part")
    rack_position = State("m", 1e-8, 1e-3, text="travel of the racks")
    rack_velocity = State("m/s", 2e-6, 0.01, text="speed of the racks")

    valve1 = Input("1", typical=0.5, field="valve1_ratio", text="opening of valve 1, into cylinder 1")
    valve2 = Input("1", typical=0.5, field="valve2_ratio", text="opening of valve 2, out of cylinder 1")
    valve3 = Input("1", typical=0.5, field="valve3_ratio", text="opening of valve 3, into cylinder 2")
    valve4 = Input("1", typical=0.5, field="valve4_ratio", text="opening of valve 4, out of cylinder 2")

    opening_delay, closing_delay, valve_travel = Valves.opening_delay, Valves.closing_delay, Valves.valve_travel
    supply = Parameter("Pa", 0.60e6, (0.05e6, 100e6), text="supply pressure: usual shop air (assumed)")
    return_pressure = Parameter("Pa", 0.0, (-0.1e6, 1e6), text="pressure of the open tank")
    conductance = Parameter(
        "m^3/(s*Pa**0.5)", 3.196e-9, (1e-11, 1e-6), text="open valve of 4750 Lohm, a 0.32 mm orifice (assumed)"
    )
    laminar = Parameter("Pa", 2e3, (0.0, 1e5), text="pressure below which the flow of a valve is laminar (assumed)")
    joint_area = Parameter("m^2", math.pi / 4 * 4.0e-3**2, (1e-9, 1e-2), text="bore area of a cylinder (2.4, 3.2)")
    line_stiffness = Parameter(
        "Pa/m^3", 2.57e13, (1e11, 1e16), "log-uniform", base=True, text="dp/dV of a chamber: the same tube (4.4.3)"
    )
    vapour_pressure = Parameter("Pa", -99e3, (-2e5, 0.0), text="gauge pressure below which the water parts")
    pinion_radius = Parameter("m", PINION_M, (1e-4, 1.0), text="pitch radius of the pinion")
    moving_mass = Parameter("kg", 0.015, (1e-3, 10.0), text="pistons, water, racks, pinion and arm (assumed)")
    static = Parameter("N", 3.0, (0.0, 60.0), base=True, text="static friction at the racks (assumed)")
    coulomb = Parameter("N", 2.2, (0.0, 60.0), base=True, text="Coulomb friction at the racks (assumed)")
    viscous = Parameter("N*s/m", 19.9, (0.0, 1e3), base=True, text="viscous friction at the racks (4.5.1)")
    tooth_ripple = Parameter("1", 0.3, (0.0, 0.9), text="share by which friction changes over a tooth (3.2 gives no size)")
    tooth_phase = Parameter("rad", 0.0, (-math.pi, math.pi), text="where in a tooth the racks begin; drawn for each test")
    teeth = Parameter("1", 18.0, (1.0, 200.0), text="teeth of the pinion")

    arm_deg = Measured(
        "hall",
        of="rack_position",
        counts=20e-3 / 4096 / PINION_M,
        noise=0.05 * DEGREE,
        plausible=(-2 * math.pi, 2 * math.pi),
    )
    pressure1_mpa = Measured("gauge1", of="pressure1", noise=700.0, plausible=(-0.12e6, 2e6))
    pressure2_mpa = Measured("gauge2", of="pressure2", noise=700.0, plausible=(-0.12e6, 2e6))

    @staticmethod
    def equations(state, parameter, drive, rate):  # type: ignore[no-untyped-def]
        """Give the rate of every state from states, parameters and inputs."""
        # --- Valves: a square root with a laminar core
        pressure1 = slot(limited(state.pressure1, parameter.vapour_pressure, 1e9), "Pa", "pressure of cylinder 1")
        pressure2 = slot(limited(state.pressure2, parameter.vapour_pressure, 1e9), "Pa", "pressure of cylinder 2")
        drop1 = signal(parameter.supply - pressure1, "Pa", "drop over valve 1")
        drop2 = signal(pressure1 - parameter.return_pressure, "Pa", "drop over valve 2")
        drop3 = signal(parameter.supply - pressure2, "Pa", "drop over valve 3")
        drop4 = signal(pressure2 - parameter.return_pressure, "Pa", "drop over valve 4")
        flow1 = path(
            drive.valve1 * parameter.conductance * drop1 / sqrt(abs(drop1) + parameter.laminar),
            downstream=pressure1,
            subsystem="valves",
        )
        flow2 = path(
            drive.valve2 * parameter.conductance * drop2 / sqrt(abs(drop2) + parameter.laminar),
            upstream=pressure1,
            subsystem="valves",
        )
        flow3 = path(
            drive.valve3 * parameter.conductance * drop3 / sqrt(abs(drop3) + parameter.laminar),
            downstream=pressure2,
            subsystem="valves",
        )
        flow4 = path(
            drive.valve4 * parameter.conductance * drop4 / sqrt(abs(drop4) + parameter.laminar),
            upstream=pressure2,
            subsystem="valves",
        )

        # --- Chambers
        rack_flow = signal(parameter.joint_area * state.rack_velocity, "m^3/s", "flow into cylinder 1 by the rack's motion")
        rate.pressure1 = store(
            flow1 - flow2 - rack_flow,
            stiffness=parameter.line_stiffness,
            name="line1",
            group="lines",
            subsystem="lines",
        )
        rate.pressure2 = store(
            flow3 - flow4 + rack_flow,
            stiffness=parameter.line_stiffness,
            name="line2",
            group="lines",
            subsystem="lines",
        )

        # --- Racks and pinion: a piston that is free cannot pull; friction changes over a tooth
        ripple = signal(
            1.0
            + parameter.tooth_ripple
            * sin(parameter.teeth * state.rack_position / parameter.pinion_radius + parameter.tooth_phase),
            "1",
            "friction here over its mean",
        )
        load_force = outside("N", "outside force on the racks")
        push = signal(
            (max(pressure1, 0.0) - max(pressure2, 0.0)) * parameter.joint_area, "N", "force of the water on the racks"
        )
        friction = contact(
            state.rack_velocity,
            push=push + load_force,
            coulomb=parameter.coulomb * ripple,
            static=parameter.static * ripple,
            viscous=parameter.viscous,
            travel=state.rack_position,
            load=pressure1 + pressure2,
            subsystem="joint",
        )
        rate.rack_position = state.rack_velocity
        rate.rack_velocity = body(
            push + load_force - friction,
            mass=parameter.moving_mass,
            load=load_force,
            position=state.rack_position,
            subsystem="joint",
        )
        arm_angle = transmission(state.rack_position / parameter.pinion_radius, subsystem="joint")

        # --- Sensors
        hall = sensor(arm_angle, subsystem="sensors")
        gauge1 = sensor(pressure1, group="gauges", subsystem="sensors")
        gauge2 = sensor(pressure2, group="gauges", subsystem="sensors")
