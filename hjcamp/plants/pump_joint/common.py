"""The pump joint in the common dialect: lines and joint behind the pump's measured travel, as a plant like any other."""

from __future__ import annotations

import math
from collections.abc import Mapping

from hjcamp.model.declare.marks import body, contact, limited, line, outside, sensor, signal, slot, store, transmission
from hjcamp.model.declare.parameter import Input, Measured, Parameter, State
from hjcamp.model.declare.plant import Plant
from hjcamp.plants.pump_joint.fields import LABELS
from hjcamp.plants.pump_joint.plant import PumpJoint

ONE = PumpJoint.parameters
TWO_WAYS = [f"{kind}_{side}" for kind in ("static", "coulomb", "viscous") for side in ("positive", "negative")]


class CommonJoint(Plant):
    r"""The lines and the joint of `PumpJoint`, driven by the pump's travel as it was measured, in elements.

    .. math:: \dot p_1 = K_1 (A_1 \dot x - A_2 v), \quad \dot p_2 = K_2 (A_2 v - A_1 \dot x), \quad
              m \dot v = (p_1 - p_2) A_2 - F_c\,\mathrm{sign}\,v - C_v v

    Nothing flows from the preload cylinders while a test is controlled. Sources: thesis 4.4 and 4.5.
    """

    name = "common_joint"
    subsystems, labels = ("pump", "lines", "joint", "sensors"), LABELS

    pressure1 = State("Pa", 5.0, 1e4, start=0.26e6, scatter=3e3, text="pressure of line 1 as if the water could not part")
    pressure2 = State("Pa", 5.0, 1e4, start=0.26e6, scatter=3e3, text="pressure of line 2 as if the water could not part")
    slider_position = State("m", 1e-9, 1e-3, text="travel of the sliders")
    slider_velocity = State("m/s", 2e-6, 0.01, text="speed of the sliders")

    pump = Input("rad", typical=10.0, hold="linear", field="pump_deg", text="angle of the pump motor as measured")
    pump_speed = Input("rad/s", typical=60.0, rate_of="pump", text="its rate")
    dither = Input("V", field="dither_v", required=False, text="dither added to the pump motor voltage")

    pump_lead, pump_area, joint_area = (ONE[name] for name in ("pump_lead", "pump_area", "joint_area"))
    line_stiffness, stiffness_asymmetry, vapour_pressure, pulley_radius, moving_mass = (
        ONE[name] for name in ("line_stiffness", "stiffness_asymmetry", "vapour_pressure", "pulley_radius", "moving_mass")
    )
    static_positive, static_negative, coulomb_positive, coulomb_negative, viscous_positive, viscous_negative = (
        ONE[name] for name in TWO_WAYS
    )
    arm_share = Parameter(
        "1", 5.3 / 18.5, (0.0, 0.97), text="share of the moving mass and of the load that is on the arm (4.5.2)"
    )
    # two tubes of one make differ by a percent, which the sum of both pressures shows
    base_parameters = (*PumpJoint.base_parameters, "stiffness_asymmetry")

    arm_deg = Measured("encoder", of="slider_position", counts=2 * math.pi / 1024, plausible=(-2 * math.pi, 2 * math.pi))
    pressure1_mpa = Measured("gauge1", of="pressure1", noise=700.0, plausible=(-0.12e6, 2e6))
    pressure2_mpa = Measured("gauge2", of="pressure2", noise=700.0, plausible=(-0.12e6, 2e6))

    @classmethod
    def told_by(cls, metadata: Mapping[str, str]) -> dict[str, float]:
        """Return what the hardware of a log is, SI, but for what is calibrated; a payload moves with the sliders."""
        from hjcamp.plants.pump_joint.diagnosis.measured.hardware import hardware_told

        hardware = hardware_told(metadata)
        found = {name: value for name, value in hardware.values.items() if name in cls.parameters}
        load = hardware.effects.get("payload_inertia", {})
        found["moving_mass"] += load.get("load_mass", 0.0) * (load.get("radius", 0.0) / found["pulley_radius"]) ** 2
        return {name: value for name, value in found.items() if name not in cls.base_parameters}

    @staticmethod
    def equations(state, parameter, drive, rate):  # type: ignore[no-untyped-def]
        """Give the rate of every state from states, parameters and inputs."""
        pistons = transmission(parameter.pump_lead * drive.pump_speed, subsystem="pump")
        pump_flow = signal(parameter.pump_area * pistons, "m^3/s", "flow from pump cylinder 1")
        slider_flow = signal(parameter.joint_area * state.slider_velocity, "m^3/s", "flow into joint cylinder 1")
        back_flow = signal(-slider_flow, "m^3/s", "flow into joint cylinder 2")
        pressure1 = slot(limited(state.pressure1, parameter.vapour_pressure, 1e9), "Pa", "pressure of line 1")
        pressure2 = slot(limited(state.pressure2, parameter.vapour_pressure, 1e9), "Pa", "pressure of line 2")
        rate.pressure1 = store(
            pump_flow - slider_flow, stiffness=parameter.line_stiffness * (1.0 + 0.5 * parameter.stiffness_asymmetry),
            name="line1", group="lines", subsystem="lines",
        )  # fmt: skip
        rate.pressure2 = store(
            slider_flow - pump_flow, stiffness=parameter.line_stiffness * (1.0 - 0.5 * parameter.stiffness_asymmetry),
            name="line2", group="lines", subsystem="lines",
        )  # fmt: skip
        end1 = line(pressure1, flow=slider_flow, group="ends", subsystem="lines")
        end2 = line(pressure2, flow=back_flow, group="ends", subsystem="lines")

        slider_angle = signal(state.slider_position / parameter.pulley_radius, "rad", "angle of the pulley")
        load_force = outside("N", "outside force on the sliders")
        pressures = signal(end1 + end2, "Pa", "what presses the seals on")
        push = signal((end1 - end2) * parameter.joint_area + load_force, "N", "force on the sliders before friction")
        friction = contact(
            state.slider_velocity,
            push=push,
            static=(parameter.static_positive, parameter.static_negative),
            coulomb=(parameter.coulomb_positive, parameter.coulomb_negative),
            viscous=(parameter.viscous_positive, parameter.viscous_negative),
            travel=state.slider_position, load=pressures, mass=parameter.moving_mass, dither=drive.dither, subsystem="joint",
        )  # fmt: skip
        rate.slider_position = state.slider_velocity
        rate.slider_velocity = body(
            push - friction, parameter.moving_mass, load=load_force, position=state.slider_position, angle=slider_angle,
            name="sliders", subsystem="joint",
        )  # fmt: skip
        pull = signal(
            parameter.arm_share * (parameter.moving_mass * rate.slider_velocity - load_force), "N", "force of the string"
        )
        arm_angle = transmission(slider_angle, torque=pull, subsystem="joint")

        encoder = sensor(arm_angle, subsystem="sensors")
        gauge1 = sensor(pressure1, group="gauges", subsystem="sensors")
        gauge2 = sensor(pressure2, group="gauges", subsystem="sensors")


PLANT = CommonJoint
