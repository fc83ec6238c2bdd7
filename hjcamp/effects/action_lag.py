"""An actuator whose action builds up late."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State


class ActionLag(Effect):
    r"""What an actuator delivers builds up late, behind what bends or limits its command.

    .. math:: u = \frac{1 - \beta\,T s}{1 + (1 - \beta)\,T s}\;f(u_c)

    with the dead band, the limit or whatever else f makes of the command: a winding behind its amplifier, a heater that
    warms up behind its switch. A first-order lag at beta = 0, a dead time (its Pade approximant) at beta = 1/2.
    Seen as: an error in proportion to the rate of what is delivered, which stands still where the command is within a dead band.
    Not for: an actuator that nothing else bends, or a lag before what does (see command_delay).
    Source: the Hammerstein model, e.g. Eskinat, Johnson & Luyben (1991), AIChE Journal 37(2), 255-268,
    doi:10.1002/aic.690370211.
    """

    acts_on = "actuator"
    behind = "command"
    lag = Parameter("period", 5.0, (0.1, 200.0), "log-uniform", "time by which the action is late", off=0.0)
    dead_share = Parameter("1", 0.0, (0.0, 0.5), text="0: a first-order lag, 0.5: a dead time")
    built = State("command", 1e-5, text="action that has built up")

    @staticmethod
    def start_built(command):
        """Start at rest with the command."""
        return command

    @staticmethod
    def d_built(command, built, lag, dead_share):
        """Rate of what builds up."""
        return (command - built) / (lag * (1.0 - dead_share))

    @staticmethod
    def command(command, built, dead_share):
        """What is delivered."""
        return command + (built - command) / (1.0 - dead_share)
