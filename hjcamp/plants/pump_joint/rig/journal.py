"""The journal of a test of this joint: the fields of its log, at 1 kHz."""

from __future__ import annotations

from hjcamp.backends.recording import Recording
from hjcamp.backends.rig import journal
from hjcamp.backends.rig.journal import keep_stopped
from hjcamp.model.run.simulator import PERIOD
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.loop import RECORDED
from hjcamp.plants.pump_joint.simulation import LOG_NAMES

__all__ = ["SCALES", "Journal", "keep_stopped"]
SCALES = {LOG_NAMES[name][0]: LOG_NAMES[name][1] for name in RECORDED} | {
    channel.field: channel.log_scale for channel in PumpJoint.channels
}


class Journal(journal.Journal):
    """The rows of one test, SI in the order of ``SCALES``."""

    def __init__(self, recording: Recording | None, longest: int) -> None:
        super().__init__(recording, longest, SCALES, PERIOD)
