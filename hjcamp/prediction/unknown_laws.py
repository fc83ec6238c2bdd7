"""Unknowns: laws without a form, hats over what may drive them. They compete with the named effects and are never named.

Each gives a place what no law says: a force over position, friction over speed, a loss over level
(Kennedy & O'Hagan 2001, doi:10.1111/1467-9868.00294, with a piecewise linear basis instead of a Gaussian process).
"""

from __future__ import annotations

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter

BIG = (-1e9, 1e9)


class ForceOverPosition(Effect):
    r"""A force on a body that depends on its position, alike in both directions.

    .. math:: F \mathrel{+}= h(x)

    piecewise linear through twelve knots from ``low`` to ``high``.
    """

    acts_on = "body"
    low = Parameter("position", -1.0, BIG)
    high = Parameter("position", 1.0, (-9e8, 1.1e9))
    a0 = Parameter("force", 0.0, BIG, off=0.0)
    a1 = Parameter("force", 0.0, BIG, off=0.0)
    a2 = Parameter("force", 0.0, BIG, off=0.0)
    a3 = Parameter("force", 0.0, BIG, off=0.0)
    a4 = Parameter("force", 0.0, BIG, off=0.0)
    a5 = Parameter("force", 0.0, BIG, off=0.0)
    a6 = Parameter("force", 0.0, BIG, off=0.0)
    a7 = Parameter("force", 0.0, BIG, off=0.0)
    a8 = Parameter("force", 0.0, BIG, off=0.0)
    a9 = Parameter("force", 0.0, BIG, off=0.0)
    a10 = Parameter("force", 0.0, BIG, off=0.0)
    a11 = Parameter("force", 0.0, BIG, off=0.0)

    @staticmethod
    def force(position, low, high, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11):
        """Value at this position."""
        w = 11.0 * min(max((position - low) / (high - low), 0.0), 1.0)
        return (
            a0 * max(0.0, 1.0 - abs(w))
            + a1 * max(0.0, 1.0 - abs(w - 1.0))
            + a2 * max(0.0, 1.0 - abs(w - 2.0))
            + a3 * max(0.0, 1.0 - abs(w - 3.0))
            + a4 * max(0.0, 1.0 - abs(w - 4.0))
            + a5 * max(0.0, 1.0 - abs(w - 5.0))
            + a6 * max(0.0, 1.0 - abs(w - 6.0))
            + a7 * max(0.0, 1.0 - abs(w - 7.0))
            + a8 * max(0.0, 1.0 - abs(w - 8.0))
            + a9 * max(0.0, 1.0 - abs(w - 9.0))
            + a10 * max(0.0, 1.0 - abs(w - 10.0))
            + a11 * max(0.0, 1.0 - abs(w - 11.0))
        )


class ForceOverVelocity(Effect):
    r"""A force on a body that depends on its velocity.

    .. math:: F \mathrel{+}= h(v)

    piecewise linear through six knots from ``low`` to ``high``.
    """

    acts_on = "body"
    low = Parameter("velocity", -1.0, BIG)
    high = Parameter("velocity", 1.0, (-9e8, 1.1e9))
    a0 = Parameter("force", 0.0, BIG, off=0.0)
    a1 = Parameter("force", 0.0, BIG, off=0.0)
    a2 = Parameter("force", 0.0, BIG, off=0.0)
    a3 = Parameter("force", 0.0, BIG, off=0.0)
    a4 = Parameter("force", 0.0, BIG, off=0.0)
    a5 = Parameter("force", 0.0, BIG, off=0.0)

    @staticmethod
    def force(velocity, low, high, a0, a1, a2, a3, a4, a5):
        """Value at this velocity."""
        w = 5.0 * min(max((velocity - low) / (high - low), 0.0), 1.0)
        return (
            a0 * max(0.0, 1.0 - abs(w))
            + a1 * max(0.0, 1.0 - abs(w - 1.0))
            + a2 * max(0.0, 1.0 - abs(w - 2.0))
            + a3 * max(0.0, 1.0 - abs(w - 3.0))
            + a4 * max(0.0, 1.0 - abs(w - 4.0))
            + a5 * max(0.0, 1.0 - abs(w - 5.0))
        )


class ForceOverTime(Effect):
    r"""A force on a body that changes during a test.

    .. math:: F \mathrel{+}= h(t)

    piecewise linear through six knots from ``low`` to ``high``.
    """

    acts_on = "body"
    low = Parameter("s", -1.0, BIG)
    high = Parameter("s", 1.0, (-9e8, 1.1e9))
    a0 = Parameter("force", 0.0, BIG, off=0.0)
    a1 = Parameter("force", 0.0, BIG, off=0.0)
    a2 = Parameter("force", 0.0, BIG, off=0.0)
    a3 = Parameter("force", 0.0, BIG, off=0.0)
    a4 = Parameter("force", 0.0, BIG, off=0.0)
    a5 = Parameter("force", 0.0, BIG, off=0.0)

    @staticmethod
    def force(time, low, high, a0, a1, a2, a3, a4, a5):
        """Value at this time."""
        w = 5.0 * min(max((time - low) / (high - low), 0.0), 1.0)
        return (
            a0 * max(0.0, 1.0 - abs(w))
            + a1 * max(0.0, 1.0 - abs(w - 1.0))
            + a2 * max(0.0, 1.0 - abs(w - 2.0))
            + a3 * max(0.0, 1.0 - abs(w - 3.0))
            + a4 * max(0.0, 1.0 - abs(w - 4.0))
            + a5 * max(0.0, 1.0 - abs(w - 5.0))
        )


class FrictionOverTravel(Effect):
    r"""Dry friction of a contact that depends on where it is, against the motion.

    .. math:: F_s, F_c \mathrel{+}= h(x)

    piecewise linear through twelve knots from ``low`` to ``high``.
    """

    acts_on = "contact"
    low = Parameter("travel", -1.0, BIG)
    high = Parameter("travel", 1.0, (-9e8, 1.1e9))
    a0 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a1 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a2 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a3 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a4 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a5 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a6 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a7 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a8 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a9 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a10 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a11 = Parameter("coulomb", 0.0, BIG, off=0.0)

    @staticmethod
    def static(travel, low, high, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11):
        """Value at this travel."""
        w = 11.0 * min(max((travel - low) / (high - low), 0.0), 1.0)
        return (
            a0 * max(0.0, 1.0 - abs(w))
            + a1 * max(0.0, 1.0 - abs(w - 1.0))
            + a2 * max(0.0, 1.0 - abs(w - 2.0))
            + a3 * max(0.0, 1.0 - abs(w - 3.0))
            + a4 * max(0.0, 1.0 - abs(w - 4.0))
            + a5 * max(0.0, 1.0 - abs(w - 5.0))
            + a6 * max(0.0, 1.0 - abs(w - 6.0))
            + a7 * max(0.0, 1.0 - abs(w - 7.0))
            + a8 * max(0.0, 1.0 - abs(w - 8.0))
            + a9 * max(0.0, 1.0 - abs(w - 9.0))
            + a10 * max(0.0, 1.0 - abs(w - 10.0))
            + a11 * max(0.0, 1.0 - abs(w - 11.0))
        )

    @staticmethod
    def coulomb(travel, low, high, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11):
        """Value at this travel."""
        w = 11.0 * min(max((travel - low) / (high - low), 0.0), 1.0)
        return (
            a0 * max(0.0, 1.0 - abs(w))
            + a1 * max(0.0, 1.0 - abs(w - 1.0))
            + a2 * max(0.0, 1.0 - abs(w - 2.0))
            + a3 * max(0.0, 1.0 - abs(w - 3.0))
            + a4 * max(0.0, 1.0 - abs(w - 4.0))
            + a5 * max(0.0, 1.0 - abs(w - 5.0))
            + a6 * max(0.0, 1.0 - abs(w - 6.0))
            + a7 * max(0.0, 1.0 - abs(w - 7.0))
            + a8 * max(0.0, 1.0 - abs(w - 8.0))
            + a9 * max(0.0, 1.0 - abs(w - 9.0))
            + a10 * max(0.0, 1.0 - abs(w - 10.0))
            + a11 * max(0.0, 1.0 - abs(w - 11.0))
        )


class FrictionOverSpeed(Effect):
    r"""Friction of a sliding contact that depends on its speed, alike in both directions.

    .. math:: F_c \mathrel{+}= h(|v|)

    piecewise linear through six knots from ``low`` to ``high``.
    """

    acts_on = "contact"
    low = Parameter("speed", -1.0, BIG)
    high = Parameter("speed", 1.0, (-9e8, 1.1e9))
    a0 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a1 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a2 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a3 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a4 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a5 = Parameter("coulomb", 0.0, BIG, off=0.0)

    @staticmethod
    def coulomb(speed, low, high, a0, a1, a2, a3, a4, a5):
        """Value at this speed."""
        w = 5.0 * min(max((speed - low) / (high - low), 0.0), 1.0)
        return (
            a0 * max(0.0, 1.0 - abs(w))
            + a1 * max(0.0, 1.0 - abs(w - 1.0))
            + a2 * max(0.0, 1.0 - abs(w - 2.0))
            + a3 * max(0.0, 1.0 - abs(w - 3.0))
            + a4 * max(0.0, 1.0 - abs(w - 4.0))
            + a5 * max(0.0, 1.0 - abs(w - 5.0))
        )


class FrictionOverTime(Effect):
    r"""Dry friction of a contact that changes during a test.

    .. math:: F_s, F_c \mathrel{+}= h(t)

    piecewise linear through six knots from ``low`` to ``high``.
    """

    acts_on = "contact"
    low = Parameter("s", -1.0, BIG)
    high = Parameter("s", 1.0, (-9e8, 1.1e9))
    a0 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a1 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a2 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a3 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a4 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a5 = Parameter("coulomb", 0.0, BIG, off=0.0)

    @staticmethod
    def static(time, low, high, a0, a1, a2, a3, a4, a5):
        """Value at this time."""
        w = 5.0 * min(max((time - low) / (high - low), 0.0), 1.0)
        return (
            a0 * max(0.0, 1.0 - abs(w))
            + a1 * max(0.0, 1.0 - abs(w - 1.0))
            + a2 * max(0.0, 1.0 - abs(w - 2.0))
            + a3 * max(0.0, 1.0 - abs(w - 3.0))
            + a4 * max(0.0, 1.0 - abs(w - 4.0))
            + a5 * max(0.0, 1.0 - abs(w - 5.0))
        )

    @staticmethod
    def coulomb(time, low, high, a0, a1, a2, a3, a4, a5):
        """Value at this time."""
        w = 5.0 * min(max((time - low) / (high - low), 0.0), 1.0)
        return (
            a0 * max(0.0, 1.0 - abs(w))
            + a1 * max(0.0, 1.0 - abs(w - 1.0))
            + a2 * max(0.0, 1.0 - abs(w - 2.0))
            + a3 * max(0.0, 1.0 - abs(w - 3.0))
            + a4 * max(0.0, 1.0 - abs(w - 4.0))
            + a5 * max(0.0, 1.0 - abs(w - 5.0))
        )


class FrictionOverLoad(Effect):
    r"""Dry friction of a contact that depends on its load.

    .. math:: F_s, F_c \mathrel{+}= h(N)

    piecewise linear through six knots from ``low`` to ``high``.
    """

    acts_on = "contact"
    low = Parameter("load", -1.0, BIG)
    high = Parameter("load", 1.0, (-9e8, 1.1e9))
    a0 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a1 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a2 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a3 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a4 = Parameter("coulomb", 0.0, BIG, off=0.0)
    a5 = Parameter("coulomb", 0.0, BIG, off=0.0)

    @staticmethod
    def static(load, low, high, a0, a1, a2, a3, a4, a5):
        """Value at this load."""
        w = 5.0 * min(max((load - low) / (high - low), 0.0), 1.0)
        return (
            a0 * max(0.0, 1.0 - abs(w))
            + a1 * max(0.0, 1.0 - abs(w - 1.0))
            + a2 * max(0.0, 1.0 - abs(w - 2.0))
            + a3 * max(0.0, 1.0 - abs(w - 3.0))
            + a4 * max(0.0, 1.0 - abs(w - 4.0))
            + a5 * max(0.0, 1.0 - abs(w - 5.0))
        )

    @staticmethod
    def coulomb(load, low, high, a0, a1, a2, a3, a4, a5):
        """Value at this load."""
        w = 5.0 * min(max((load - low) / (high - low), 0.0), 1.0)
        return (
            a0 * max(0.0, 1.0 - abs(w))
            + a1 * max(0.0, 1.0 - abs(w - 1.0))
            + a2 * max(0.0, 1.0 - abs(w - 2.0))
            + a3 * max(0.0, 1.0 - abs(w - 3.0))
            + a4 * max(0.0, 1.0 - abs(w - 4.0))
            + a5 * max(0.0, 1.0 - abs(w - 5.0))
        )


class LossOverLevel(Effect):
    r"""A loss of a store that depends on its level.

    .. math:: q \mathrel{+}= h(p)

    piecewise linear through six knots from ``low`` to ``high``.
    """

    acts_on = "store"
    low = Parameter("level", -1.0, BIG)
    high = Parameter("level", 1.0, (-9e8, 1.1e9))
    a0 = Parameter("loss", 0.0, BIG, off=0.0)
    a1 = Parameter("loss", 0.0, BIG, off=0.0)
    a2 = Parameter("loss", 0.0, BIG, off=0.0)
    a3 = Parameter("loss", 0.0, BIG, off=0.0)
    a4 = Parameter("loss", 0.0, BIG, off=0.0)
    a5 = Parameter("loss", 0.0, BIG, off=0.0)

    @staticmethod
    def loss(level, low, high, a0, a1, a2, a3, a4, a5):
        """Value at this level."""
        w = 5.0 * min(max((level - low) / (high - low), 0.0), 1.0)
        return (
            a0 * max(0.0, 1.0 - abs(w))
            + a1 * max(0.0, 1.0 - abs(w - 1.0))
            + a2 * max(0.0, 1.0 - abs(w - 2.0))
            + a3 * max(0.0, 1.0 - abs(w - 3.0))
            + a4 * max(0.0, 1.0 - abs(w - 4.0))
            + a5 * max(0.0, 1.0 - abs(w - 5.0))
        )


class FlowOverUpstream(Effect):
    r"""A flow of a path that depends on what is upstream of it.

    .. math:: q \mathrel{+}= h(p)

    piecewise linear through six knots from ``low`` to ``high``.
    """

    acts_on = "path"
    low = Parameter("upstream", -1.0, BIG)
    high = Parameter("upstream", 1.0, (-9e8, 1.1e9))
    a0 = Parameter("flow", 0.0, BIG, off=0.0)
    a1 = Parameter("flow", 0.0, BIG, off=0.0)
    a2 = Parameter("flow", 0.0, BIG, off=0.0)
    a3 = Parameter("flow", 0.0, BIG, off=0.0)
    a4 = Parameter("flow", 0.0, BIG, off=0.0)
    a5 = Parameter("flow", 0.0, BIG, off=0.0)

    @staticmethod
    def flow(flow, upstream, low, high, a0, a1, a2, a3, a4, a5):
        """Value at this upstream."""
        w = 5.0 * min(max((upstream - low) / (high - low), 0.0), 1.0)
        return (
            flow
            + a0 * max(0.0, 1.0 - abs(w))
            + a1 * max(0.0, 1.0 - abs(w - 1.0))
            + a2 * max(0.0, 1.0 - abs(w - 2.0))
            + a3 * max(0.0, 1.0 - abs(w - 3.0))
            + a4 * max(0.0, 1.0 - abs(w - 4.0))
            + a5 * max(0.0, 1.0 - abs(w - 5.0))
        )


class CommandOverDemand(Effect):
    r"""A drive that delivers another amount than its demand, depending on the demand.

    .. math:: u \mathrel{+}= h(u)

    piecewise linear through six knots from ``low`` to ``high``.
    """

    acts_on = "actuator"
    low = Parameter("demand", -1.0, BIG)
    high = Parameter("demand", 1.0, (-9e8, 1.1e9))
    a0 = Parameter("command", 0.0, BIG, off=0.0)
    a1 = Parameter("command", 0.0, BIG, off=0.0)
    a2 = Parameter("command", 0.0, BIG, off=0.0)
    a3 = Parameter("command", 0.0, BIG, off=0.0)
    a4 = Parameter("command", 0.0, BIG, off=0.0)
    a5 = Parameter("command", 0.0, BIG, off=0.0)

    @staticmethod
    def command(command, demand, low, high, a0, a1, a2, a3, a4, a5):
        """Value at this demand."""
        w = 5.0 * min(max((demand - low) / (high - low), 0.0), 1.0)
        return (
            command
            + a0 * max(0.0, 1.0 - abs(w))
            + a1 * max(0.0, 1.0 - abs(w - 1.0))
            + a2 * max(0.0, 1.0 - abs(w - 2.0))
            + a3 * max(0.0, 1.0 - abs(w - 3.0))
            + a4 * max(0.0, 1.0 - abs(w - 4.0))
            + a5 * max(0.0, 1.0 - abs(w - 5.0))
        )


class ReadingOverTrue(Effect):
    r"""A sensor whose error depends on the value.

    .. math:: y \mathrel{+}= h(x)

    piecewise linear through twelve knots from ``low`` to ``high``.
    """

    acts_on = "sensor"
    low = Parameter("true", -1.0, BIG)
    high = Parameter("true", 1.0, (-9e8, 1.1e9))
    a0 = Parameter("reading", 0.0, BIG, off=0.0)
    a1 = Parameter("reading", 0.0, BIG, off=0.0)
    a2 = Parameter("reading", 0.0, BIG, off=0.0)
    a3 = Parameter("reading", 0.0, BIG, off=0.0)
    a4 = Parameter("reading", 0.0, BIG, off=0.0)
    a5 = Parameter("reading", 0.0, BIG, off=0.0)
    a6 = Parameter("reading", 0.0, BIG, off=0.0)
    a7 = Parameter("reading", 0.0, BIG, off=0.0)
    a8 = Parameter("reading", 0.0, BIG, off=0.0)
    a9 = Parameter("reading", 0.0, BIG, off=0.0)
    a10 = Parameter("reading", 0.0, BIG, off=0.0)
    a11 = Parameter("reading", 0.0, BIG, off=0.0)

    @staticmethod
    def reading(reading, true, low, high, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11):
        """Value at this true."""
        w = 11.0 * min(max((true - low) / (high - low), 0.0), 1.0)
        return (
            reading
            + a0 * max(0.0, 1.0 - abs(w))
            + a1 * max(0.0, 1.0 - abs(w - 1.0))
            + a2 * max(0.0, 1.0 - abs(w - 2.0))
            + a3 * max(0.0, 1.0 - abs(w - 3.0))
            + a4 * max(0.0, 1.0 - abs(w - 4.0))
            + a5 * max(0.0, 1.0 - abs(w - 5.0))
            + a6 * max(0.0, 1.0 - abs(w - 6.0))
            + a7 * max(0.0, 1.0 - abs(w - 7.0))
            + a8 * max(0.0, 1.0 - abs(w - 8.0))
            + a9 * max(0.0, 1.0 - abs(w - 9.0))
            + a10 * max(0.0, 1.0 - abs(w - 10.0))
            + a11 * max(0.0, 1.0 - abs(w - 11.0))
        )


LAWS: tuple[type[Effect], ...] = (
    ForceOverPosition, ForceOverVelocity, ForceOverTime, FrictionOverTravel, FrictionOverSpeed, FrictionOverTime,
    FrictionOverLoad, LossOverLevel, FlowOverUpstream, CommandOverDemand, ReadingOverTrue,
)  # fmt: skip


def amplitudes_of_law(law: type[Effect]) -> tuple[str, ...]:
    """Return the names of the values at a law's knots, in order."""
    return tuple(name for name in law.parameters if name[1:].isdigit())
