"""The base class of all controllers: one control law is one class in one file."""

from __future__ import annotations

from hjcamp.model.law import Law


class Controller(Law):
    """A law that commands the pump from the reference and the measured arm angle.

    Per sample it receives ``reference``, ``velocity`` and ``acceleration`` of the arm (rad, rad/s, rad/s^2), the
    measured ``arm`` angle (rad), the ``feedforward`` command (rad of the pump motor), the ``period`` (s) and the
    ``index`` of the sample. It returns the feedback and the feedforward part of the command, rad of the pump motor.

    ``uses_arm`` False says that the law does not look at the arm: nothing then makes the arm follow the reference.
    """

    samples = ("reference", "velocity", "acceleration", "arm", "feedforward", "period", "index")
    results = ("pid", "feedforward")
    uses_feedforward = False
    uses_arm = True
