"""The template of a user's own plant: a carriage on a guide, to be changed."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from hjcamp.model.files.template_file import class_name, write_user_file

TEMPLATE = '''"""A carriage that a motor pushes along its guide. (Say here what your machine is.)"""

from __future__ import annotations

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, contact, outside, sensor


class {title}(Plant):
    r"""A motor pushes a carriage along its guide.

    .. math:: M \\dot v = g\\,u - F_c\\,\\mathrm{{sign}}\\,v - F_v\\,v
    """

    position = State("m", typical=0.1)
    velocity = State("m/s", typical=0.05)

    # The logs hold it as voltage_v; hold="linear" where the input runs on between two samples, not held by a converter
    voltage = Input("V", text="drive voltage")

    # Unit, value, (lowest, highest). base=True: differs from machine to machine, and is fitted before anything is called missing
    gain = Parameter("N/V", 35.0, text="force for one volt")
    mass = Parameter("kg", 95.0, (1.0, 1e3), base=True, text="moving mass")
    coulomb = Parameter("N", 20.0, (0.1, 200.0), base=True, text="Coulomb friction")
    viscous = Parameter("N*s/m", 200.0, (0.0, 2e3), base=True, text="viscous friction")

    # The name is the field of the logs, quantity_unit; "encoder" is the line of the sensor below
    position_m = Measured("encoder", of="position")
    period = 0.001  # s between two samples of its tests
    # loop = "foreign"   where a controller that is not in the equations holds the position: tests are then judged in short
    #                    windows alone, and `hjcamp next` proposes motions instead of inputs

    @staticmethod
    def equations(state, parameter, drive, rate):
        """Give the rate of every state; each element (actuator, contact, body, ...) is a place where effects may act."""
        # The push of a contact is what would hold it; left out of every contact, it is found from the rates.
        # Lines that occur twice are written once, as a function above: NAME = part(FUNCTION, state.x, parameter, rate)
        force = actuator(parameter.gain * drive.voltage)
        load = outside("N")
        friction = contact(
            state.velocity,
            push=force + load,
            coulomb=parameter.coulomb,
            viscous=parameter.viscous,
            travel=state.position,
        )
        rate.position = state.velocity
        rate.velocity = body(force + load - friction, mass=parameter.mass, load=load, position=state.position)
        encoder = sensor(state.position)
'''


def write_template(name: str, folder: Path, taken: Iterable[str]) -> Path:
    """Write the template as ``folder``/``name``.py and return its path; refuse a bad or taken name."""
    return write_user_file("plant", name, folder, TEMPLATE.format(title=class_name(name)), taken, "linear_axis")
