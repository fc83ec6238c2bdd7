"""A late actuator."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State


class CommandDelay(Effect):
    r"""An actuator follows its command late.

    .. math:: u = \frac{1 - \beta\,T s}{1 + (1 - \beta)\,T s}\;u_c

    late by T for every slow command; a first-order lag at beta = 0, a dead time (its Pade approximant) at beta = 1/2.
    Seen as: an error in proportion to the rate of the command, whatever the motion is.
    Not for: a late sensor, which shows the motion itself late (see sensor_lag), or what is late behind a bend (see action_lag).
    Source: Pade approximants of a dead time, e.g. Franklin, Powell & Emami-Naeini (2010), Feedback Control of Dynamic
    Systems, section 5.6.3.
    """

    acts_on = "actuator"
    delay = Parameter("period", 5.0, (0.1, 200.0), "log-uniform", "time by which the command is late", off=0.0)
    dead_share = Parameter("1", 0.0, (0.0, 0.5), text="0: a first-order lag, 0.5: a dead time")
    followed = State("command", 1e-5, text="command that the actuator has caught up with")

    @staticmethod
    def start_followed(demand):
        """Start at rest with the command."""
        return demand

    @staticmethod
    def d_followed(demand, followed, delay, dead_share):
        """Rate of what is caught up with."""
        return (demand - followed) / (delay * (1.0 - dead_share))

    @staticmethod
    def command(followed, demand, dead_share):
        """What the command lacks."""
        return (followed - demand) / (1.0 - dead_share)
