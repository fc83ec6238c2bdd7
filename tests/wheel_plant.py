"""Plants whose contact has no dry friction, or that alone, and one with a winding; what is said of a log of one of them."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.decision.verdict import decided
from hjcamp.diagnosis.results.answer import answer
from hjcamp.effects import load_effects
from hjcamp.records.log import TestLog

WHEEL = '''"""A wheel on a motor, without any dry friction."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, contact, outside, sensor


class Wheel(Plant):
    """A motor turns a wheel against viscous friction."""

    speed = State("rad/s", typical=20.0)
    voltage = Input("V", typical=3.0)
    inertia = Parameter("kg*m^2", 1e-5)
    gain = Parameter("N*m/V", 1.5e-3, (1e-5, 1.0), "log-uniform", base=True)
    viscous = Parameter("N*m*s", 2e-4, (1e-7, 1e-1), "log-uniform", base=True)
    period = 2e-3
    speed_rpm = Measured("encoder", of="speed")

    @staticmethod
    def equations(state, parameter, drive, rate):
        torque = actuator(parameter.gain * drive.voltage)
        load = outside("N*m")
        rub = contact(state.speed, push=torque + load, viscous=parameter.viscous)
        rate.speed = body(torque + load - rub, mass=parameter.inertia, load=load)
        encoder = sensor(state.speed)
'''

DRY_WHEEL = (
    WHEEL.replace("class Wheel", "class DryWheel")
    .replace("viscous=parameter.viscous", "coulomb=parameter.dry")
    .replace('viscous = Parameter("N*m*s", 2e-4, (1e-7, 1e-1)', 'dry = Parameter("N*m", 1.2e-3, (1e-7, 1e-1)')
)

DRIVER = (
    WHEEL.replace("class Wheel", "class Driver")
    .replace("contact, outside, sensor", "contact, path, sensor")
    .replace(
        """        torque = actuator(parameter.gain * drive.voltage)
        load = outside("N*m")
        rub = contact(state.speed, push=torque + load, viscous=parameter.viscous)
        rate.speed = body(torque + load - rub, mass=parameter.inertia, load=load)
""",
        """        volts = actuator(drive.voltage)
        current = path((volts - parameter.constant * state.speed) / parameter.resistance)
        rub = contact(state.speed, viscous=parameter.viscous)
        rate.speed = body(parameter.constant * current - rub, mass=parameter.inertia)
""",
    )
    .replace(
        'gain = Parameter("N*m/V", 1.5e-3, (1e-5, 1.0), "log-uniform", base=True)',
        'resistance = Parameter("ohm", 2.0)\n    constant = Parameter("N*m/A", 4e-3, (1e-5, 1.0), "log-uniform", base=True)',
    )
)


def diagnosed(plant: str, log: TestLog, names: Iterable[str]) -> dict[str, Any]:
    """Return the answer to a log, its plant written into the working directory, with these effects considered."""
    Path("plants").mkdir()
    Path("plants", f"{log.metadata['plant']}.py").write_text(plant)
    measured = measured_tests([log])
    library = load_effects(plant=measured.plant)
    chosen = {name: library[name] for name in names}
    analysis = calibrated(measured, chosen)
    return answer(analysis, decided(analysis), 0.0)
