"""Dither that lowers the effective friction of a contact."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class DitherRelief(Effect):
    r"""Dither keeps a contact trembling, so it breaks away earlier and slides more easily.

    .. math:: F_s \leftarrow F_s\,\max(1 - r_s |u_d|,\ 0.05), \quad F_c \leftarrow \min(F_c\,\max(1 - r_c |u_d|,\ 0.05),\ F_s)

    with u_d the dither of the sample; a square wave, so that its size is constant.
    Seen as: less friction in tests with dither than in tests without, most of all at breakaway.
    Not for: tests that all have the same dither (static and Coulomb friction take it up).
    Source: Armstrong-Helouvry, Dupont & Canudas de Wit (1994), Automatica 30(7), 1083-1138,
    doi:10.1016/0005-1098(94)90209-7 (dither).
    """

    acts_on = "contact"
    static_relief = Parameter("1/dither", 0.2, (0.0, 1.0), text="share of static friction taken away by each unit", off=0.0)
    coulomb_relief = Parameter("1/dither", 0.1, (0.0, 1.0), text="share of Coulomb friction taken away by each unit", off=0.0)

    @staticmethod
    def static(static, dither, static_relief):
        """Static friction under dither."""
        return static * max(1.0 - static_relief * abs(dither), 0.05)

    @staticmethod
    def coulomb(coulomb, static, dither, coulomb_relief):
        """Coulomb friction under dither, never above static friction."""
        return min(coulomb * max(1.0 - coulomb_relief * abs(dither), 0.05), static)
