"""PID plus a feedforward computed from a model along the reference."""

from __future__ import annotations

from hjcamp.plants.pump_joint.controllers.pid import Pid


class FfwdPid(Pid):
    r"""The PID law with a model-based feedforward added to its output.

    .. math:: \theta_{md} = u_{PID} + g\,\theta_f

    The feedforward and its gain are computed along the reference before the test (see ``feedforward.py``).
    Source: thesis 5.3.1, 5.3.3.
    """

    uses_feedforward = True
