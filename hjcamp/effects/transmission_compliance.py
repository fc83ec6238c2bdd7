"""A transmission that gives way under what it carries."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class TransmissionCompliance(Effect):
    r"""A shaft, a belt or a string gives way under what it carries: what is driven stays behind by as much.

    .. math:: y = x - c\,T

    with T what the transmission carries from its drive to what is driven, as the plant's ``torque`` says it; for motion well below
    the resonance of what is driven on this spring.
    Seen as: what is driven stays behind its drive with the load, in both directions, and comes back with it.
    Not for: play, which has no force (see backlash); a plant that has the motion of what is driven as a state has this spring itself.
    Source: the twist of a shaft, e.g. Den Hartog (1956), Mechanical Vibrations, section 2.3.
    """

    acts_on = "transmission"
    only_in = {"output": ("m", "rad")}  # noqa: RUF012
    compliance = Parameter("output/torque", 0.05, (0.0, 10.0), text="what is lost for each unit that it carries", off=0.0)

    @staticmethod
    def output(torque, compliance):
        """By how much what is driven is behind."""
        return -compliance * torque
