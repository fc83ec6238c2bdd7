"""Play in a transmission."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State


class Backlash(Effect):
    r"""What is driven stands still while its drive crosses the play, and follows half of the play behind.

    .. math:: y^+ = \min\bigl(\max(y,\ x - b/2),\ x + b/2\bigr)

    for motions that are passed on as positions. Where the plant has the motion of what is driven, y is that (a dead zone of the
    twist of a spring behind the play); elsewhere friction holds it where it was left (play operator).
    Seen as: an error of fixed size that changes its sign at each reversal, whatever the speed.
    Not for: a lag that grows with speed (see command_delay, sensor_lag).
    Source: Nordin & Gutman (2002), Automatica 38(10), 1633-1649, doi:10.1016/S0005-1098(02)00047-X.
    """

    acts_on = "transmission"
    only_in = {"output": ("m", "rad")}  # noqa: RUF012
    instead = {"driven": "held"}  # noqa: RUF012
    play = Parameter("input", 0.05, (0.0, 1.0), text="whole travel of the drive between both flanks", off=0.0)
    held = State("input", 1e-5, text="where what is driven stands")

    @staticmethod
    def start_held(input):
        """Start in the middle of the play."""
        return input

    @staticmethod
    def next_held(driven, input, play):
        """Follow where a flank pushes."""
        return max(input - 0.5 * play, min(input + 0.5 * play, driven))

    @staticmethod
    def output(output, input, driven, play):
        """Motion that is passed on."""
        return output - input + max(input - 0.5 * play, min(input + 0.5 * play, driven))
