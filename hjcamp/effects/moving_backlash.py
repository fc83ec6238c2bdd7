"""Play in a transmission whose motion is given as a velocity."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State


class MovingBacklash(Effect):
    r"""What is driven stands still while its drive crosses the play, and then moves as fast as that.

    .. math:: g^+ = \min\bigl(\max(g + v\,\Delta t,\ -b/2),\ b/2\bigr), \quad w = v - (g^+ - g)/\Delta t

    for motions that are passed on as velocities: with g by how much the drive is ahead, v its velocity and w that of what is driven,
    which friction holds where nothing pushes it (play operator). A test begins in the middle of the play.
    Seen as: after each reversal the drive moves a fixed travel before anything follows, whatever its speed.
    Not for: motions that are passed on as positions (see backlash), or a lag that grows with speed (see sensor_lag).
    Source: Nordin & Gutman (2002), Automatica 38(10), 1633-1649, doi:10.1016/S0005-1098(02)00047-X.
    """

    acts_on = "transmission"
    only_in = {"output": ("m/s", "rad/s")}  # noqa: RUF012
    play = Parameter(
        "input*period", 2.0, (0.02, 500.0), "log-uniform", "whole travel of the drive between both flanks", shape=True, off=0.0
    )
    gap = State("input*period", 1e-5, text="travel of the drive ahead of what is driven")
    closing = State("input", 1e-5, text="velocity of the drive relative to what is driven in this sample")
    sampled = State("period", 1e-5, text="time of the sample before")

    @staticmethod
    def start_sampled(time):
        """Start the clock."""
        return time

    @staticmethod
    def next_sampled(time):
        """Time of this sample."""
        return time

    @staticmethod
    def next_closing(gap, input, play, time, sampled):
        """Velocity that takes the gap to the end of this sample or to the flank; none in the first one, which nothing times."""
        period = time - sampled
        moved = max(-0.5 * play, min(0.5 * play, gap + input * period)) - gap
        return moved / period if period > 0.0 else 0.0

    @staticmethod
    def d_gap(closing):
        """Rate of the gap."""
        return closing

    @staticmethod
    def output(closing):
        """Velocity that what is driven lacks."""
        return -closing
