"""Friction that changes during a test."""

from __future__ import annotations

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter


class FrictionDrift(Effect):
    r"""Static and Coulomb friction change steadily during a test, by warming or wear.

    .. math:: F \leftarrow F\,(1 + d\,t)

    with t = 0 at the start of the command, where the base friction applies; the next test starts anew.
    Seen as: the same motion needs another force late in a test than early in it.
    Not for: change from test to test (scatter), or with rest (see static_friction_ageing).
    Source: first term of a series in time; Armstrong-Helouvry (1991), Control of Machines with Friction, chapter 4.
    """

    subsystem = "joint"
    drift = Parameter("1/s", 0.05, (-0.2, 0.5), text="share of friction gained in each second", off=0.0)

    @staticmethod
    def friction_static(friction_static, time, drift):
        """Static friction at this time, N."""
        return friction_static * max(0.05, 1.0 + drift * time)

    @staticmethod
    def friction_coulomb(friction_coulomb, time, drift):
        """Coulomb friction at this time, N."""
        return friction_coulomb * max(0.05, 1.0 + drift * time)
