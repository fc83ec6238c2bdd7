"""Static friction that grows with time at rest."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State


class StaticFrictionAgeing(Effect):
    r"""While a contact rests, it comes closer and sticks better.

    .. math:: F_s \leftarrow F_s\,\Bigl(1 + a\,\frac{t_r}{t_r + \gamma}\Bigr)

    with t_r the time at rest. ``rest_before`` is the rest before the log began, the same in all tests.
    Seen as: a higher breakaway after a longer rest; the first breakaway of a test stands out.
    Not for: friction that changes while sliding (see friction_drift). Static friction is that of a fresh stop here.
    Source: Armstrong-Helouvry, Dupont & Canudas de Wit (1994), Automatica 30(7), 1083-1138,
    doi:10.1016/0005-1098(94)90209-7 (rising static friction of the seven-parameter model).
    """

    acts_on = "contact"
    works_on = "static"
    growth = Parameter("1", 0.4, (0.0, 4.0), text="growth of static friction after a long rest", off=0.0)
    half_time = Parameter("period", 300.0, (5.0, 3e4), "log-uniform", "rest after which half of it has come", shape=True)
    rest_before = Parameter("period", 2e3, (10.0, 1e6), "log-uniform", "rest before the log began", shape=True)
    rest_began = State("s", 1e-6, 1.0, text="time at which the contact came to rest")

    @staticmethod
    def start_rest_began(time, rest_before):
        """Start at rest."""
        return time - rest_before

    @staticmethod
    def next_rest_began(rest_began, speed, time):
        """Keep the time while the contact rests, else take this one."""
        return rest_began if speed < 1e-5 else time

    @staticmethod
    def static(static, time, rest_began, growth, half_time):
        """Static friction after this rest."""
        rest = max(time - rest_began, 0.0)
        return static * (1.0 + growth * rest / (rest + half_time))
