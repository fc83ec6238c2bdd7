"""Two tanks, the upper one runs out into the lower one; a pump fills it (Schoukens & Noel 2017)."""

from __future__ import annotations

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, path, sensor, sqrt, store


class CascadedTanks(Plant):
    r"""Levels in V of the gauge; what runs out goes with the root of the level.

    .. math:: \dot x_1 = k_4 u - k_1 \sqrt{x_1}, \quad \dot x_2 = k_1 \sqrt{x_1} - k_3 \sqrt{x_2}
    """

    upper = State("V", typical=5.0, low=0.0, start="unknown")
    lower = State("V", typical=5.0, low=0.0)
    pump = Input("V", text="voltage of the pump", typical=3.0)
    k1 = Parameter("V**0.5/s", 0.05, (1e-4, 1.0), "log-uniform", base=True, text="outlet of the upper tank")
    k3 = Parameter("V**0.5/s", 0.05, (1e-4, 1.0), "log-uniform", base=True, text="outlet of the lower tank")
    k4 = Parameter("1/s", 0.05, (1e-4, 1.0), "log-uniform", base=True, text="the pump's flow for one volt")
    level_v = Measured("gauge", of="lower")
    period = 4.0

    @staticmethod
    def equations(state, parameter, drive, rate):
        inflow = actuator(parameter.k4 * drive.pump)
        between = path(parameter.k1 * sqrt(state.upper), upstream=state.upper, downstream=state.lower)
        outflow = path(parameter.k3 * sqrt(state.lower), upstream=state.lower)
        rate.upper = store(inflow - between)
        rate.lower = store(between - outflow)
        gauge = sensor(state.lower)
