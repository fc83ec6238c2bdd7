"""EMPS: a prismatic axis that a motor drives, in a closed loop of its own (Janot, Gautier & Brunot 2019)."""

from __future__ import annotations

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, contact, outside, sensor


class Emps(Plant):
    r"""A mass with dry and viscous friction and a constant force.

    .. math:: M \dot v = g\,u - F_c\,\mathrm{sign}\,v - F_v\,v - F_0
    """

    position = State("m", typical=0.1)
    velocity = State("m/s", typical=0.1)
    voltage = Input("V", text="drive command", typical=3.0)
    gain = Parameter("N/V", 35.15065, text="force for one volt, as the authors give it")
    mass = Parameter("kg", 90.0, (1.0, 1e3), base=True, text="moving mass")
    coulomb = Parameter("N", 15.0, (0.1, 200.0), base=True, text="Coulomb friction")
    viscous = Parameter("N*s/m", 150.0, (0.0, 2e3), base=True, text="viscous friction")
    offset = Parameter("N", 0.0, (-50.0, 50.0), base=True, text="constant force")
    position_m = Measured("encoder", of="position")
    period = 0.001
    loop = "foreign"

    @staticmethod
    def equations(state, parameter, drive, rate):
        force = actuator(parameter.gain * drive.voltage - parameter.offset)
        load = outside("N")
        friction = contact(
            state.velocity, push=force + load, coulomb=parameter.coulomb, viscous=parameter.viscous, travel=state.position
        )
        rate.position = state.velocity
        rate.velocity = body(force + load - friction, mass=parameter.mass, load=load, position=state.position)
        encoder = sensor(state.position)
