"""A slide on an air bearing with a spring that its plant lacks, solved exactly from sample to sample without the program."""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm

from hjcamp.records.log import TestLog

PERIOD, NOISE = 5e-3, 2e-5
GAIN, MASS, DRAG, STIFFNESS, REST = 35.0, 80.0, 260.0, 900.0, 0.02
PLANT = '''"""A slide on an air bearing."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, sensor


class Slide(Plant):
    """A motor pushes a slide that air carries."""

    period = 0.005
    position = State("m", typical=0.1)
    velocity = State("m/s", typical=0.05)
    voltage = Input("V")
    gain = Parameter("N/V", 35.0)
    mass = Parameter("kg", 95.0, (1.0, 1e3), base=True)
    viscous = Parameter("N*s/m", 200.0, (1.0, 2e3), base=True)
    position_m = Measured("encoder", of="position")

    @staticmethod
    def equations(state, parameter, drive, rate):
        force = actuator(parameter.gain * drive.voltage)
        rate.position = state.velocity
        rate.velocity = body(force - parameter.viscous * state.velocity, mass=parameter.mass, position=state.position)
        encoder = sensor(state.position)
'''
# the same machine: states and parameters in another order and by other names, position read in mm, voltage in mV
OTHER = '''"""A slide on an air bearing."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, sensor


class Slide(Plant):
    """A motor pushes a slide that air carries."""

    period = 0.005
    b_speed = State("m/s", typical=0.05)
    a_travel = State("m", typical=0.1)
    supply = Input("V", field="supply_mv")
    zeta = Parameter("N*s/m", 200.0, (1.0, 2e3), base=True)
    alpha = Parameter("kg", 95.0, (1.0, 1e3), base=True)
    push = Parameter("N/V", 35.0)
    a_travel_mm = Measured("scale", of="a_travel")

    @staticmethod
    def equations(state, parameter, drive, rate):
        driving = actuator(parameter.push * drive.supply)
        rate.b_speed = body(driving - parameter.zeta * state.b_speed, mass=parameter.alpha, position=state.a_travel)
        rate.a_travel = state.b_speed
        scale = sensor(state.a_travel)
'''
NAMES = {"position_m": ("a_travel_mm", 1e3), "voltage_v": ("supply_mv", 1e3)}


def measured_log(seed: int, seconds: float = 2.0) -> TestLog:
    """Return a log of position (in counts of 1 um) and voltage, which is held from sample to sample."""
    chance = np.random.default_rng(seed)
    samples = round(seconds / PERIOD)
    volts = np.round(np.repeat(chance.uniform(-3.0, 3.0, samples // 50 + 1), 50)[:samples], 3)
    rates = np.array([[0.0, 1.0, 0.0], [-STIFFNESS / MASS, -DRAG / MASS, 1.0 / MASS], [0.0, 0.0, 0.0]])
    step, now, places = expm(rates * PERIOD), np.zeros(3), np.empty(samples)
    for k in range(samples):
        places[k] = now[0]
        now[2] = GAIN * volts[k] + STIFFNESS * REST
        now = step @ now
    shown = np.round(places + NOISE * chance.standard_normal(samples), 6)
    metadata = {"plant": "slide", "period_s": str(PERIOD), "condition": f"steps {seed}"}
    return TestLog({"time_s": np.arange(samples) * PERIOD, "position_m": shown, "voltage_v": volts}, metadata)
