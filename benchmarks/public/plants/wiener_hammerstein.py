"""Wiener-Hammerstein circuit: a filter, a diode, a filter (Schoukens, Suykens & Ljung 2009)."""

from __future__ import annotations

from hjcamp.plant import Input, Measured, Parameter, Plant, State, exp, log, sensor


class WienerHammerstein(Plant):
    r"""A low pass of third order, a voltage that a diode limits on one side, a low pass of third order with a zero of transmission.

    .. math:: f(w) = w - b\,c\,\ln(1 + e^{(w - t)/c})

    The circuit as its authors describe it: Chebyshev, 0.5 dB, 4.4 kHz; inverse Chebyshev, 40 dB from 5 kHz. Declared values are those
    of such filters.
    """

    first = State("V", typical=1.0)
    inner = State("V", typical=1.0)
    inner_slope = State("V/s", typical=2e4)
    second = State("V", typical=0.5)
    outer = State("V", typical=0.5)
    outer_slope = State("V/s", typical=1e4)
    drive_voltage = Input("V", text="input", typical=1.0, hold="linear")
    pole_1 = Parameter("1/s", 1.73e4, (2e3, 2e5), "log-uniform", base=True, text="real pole of the first filter")
    frequency_1 = Parameter("1/s", 2.95e4, (5e3, 2e5), "log-uniform", base=True, text="frequency of its pair of poles")
    damping_1 = Parameter("1", 0.29, (0.02, 2.0), base=True, text="damping of that pair")
    slope = Parameter("1", 0.7, (0.0, 1.0), base=True, text="by how much the diode lowers the slope")
    threshold = Parameter("V", 0.3, (-2.0, 2.0), base=True, text="voltage at which the diode conducts")
    bend = Parameter("V", 0.1, (0.02, 1.0), "log-uniform", base=True, text="width of the bend")
    pole_2 = Parameter("1/s", 1.11e4, (2e3, 2e5), "log-uniform", base=True, text="real pole of the second filter")
    frequency_2 = Parameter("1/s", 1.06e4, (5e3, 2e5), "log-uniform", base=True, text="frequency of its pair of poles")
    damping_2 = Parameter("1", 0.48, (0.02, 2.0), base=True, text="damping of that pair")
    zero_2 = Parameter("1/s", 3.6e4, (1e4, 2e5), "log-uniform", base=True, text="frequency of its zero")
    gain = Parameter("1", 1.0, (-10.0, 10.0), base=True, text="gain from end to end")
    output_v = Measured("probe", noise=2e-4)
    period = 1.0 / 51200.0

    @staticmethod
    def equations(state, parameter, drive, rate):
        rate.first = parameter.pole_1 * (drive.drive_voltage - state.first)
        rate.inner = state.inner_slope
        pull = parameter.frequency_1 * (state.first - state.inner) - 2.0 * parameter.damping_1 * state.inner_slope
        rate.inner_slope = parameter.frequency_1 * pull
        limited_by = parameter.bend * log(1.0 + exp((state.inner - parameter.threshold) / parameter.bend))
        rate.second = parameter.pole_2 * (state.inner - parameter.slope * limited_by - state.second)
        rate.outer = state.outer_slope
        held = parameter.frequency_2 * (state.second - state.outer) - 2.0 * parameter.damping_2 * state.outer_slope
        bent = parameter.frequency_2 * held
        rate.outer_slope = bent
        probe = sensor(parameter.gain * (state.outer + bent / (parameter.zero_2 * parameter.zero_2)))
