"""Silverbox: an electronic oscillator with a stiffness that hardens (Wigren & Schoukens 2013)."""

from __future__ import annotations

from hjcamp.plant import Input, Measured, Parameter, Plant, State, sensor


class Silverbox(Plant):
    r"""Duffing's equation in the scale of the output.

    .. math:: \ddot y + d\,\dot y + a\,y + b\,y^3 = g\,u
    """

    output = State("V", typical=0.05)
    slope = State("V/s", typical=20.0)
    drive_voltage = Input("V", text="input", typical=0.05, hold="linear")
    damping = Parameter("1/s", 20.0, (0.1, 500.0), base=True, text="damping")
    stiffness = Parameter("1/s^2", 1.8e5, (1e4, 1e6), base=True, text="square of the natural frequency")
    cubic = Parameter("1/(V^2*s^2)", 1e6, (0.0, 1e9), base=True, text="hardening")
    gain = Parameter("1/s^2", 9e4, (1e3, 1e6), base=True, text="gain of the input")
    output_v = Measured("probe", of="output")
    period = 1.0 / 610.35

    @staticmethod
    def equations(state, parameter, drive, rate):
        rate.output = state.slope
        rate.slope = (
            parameter.gain * drive.drive_voltage
            - parameter.damping * state.slope
            - parameter.stiffness * state.output
            - parameter.cubic * state.output * state.output * state.output
        )
        probe = sensor(state.output)
