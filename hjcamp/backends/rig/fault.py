"""What a stopped test leaves: a rig that is safe and may be looked at again, or one that a person must see first; and no rig at all."""

from __future__ import annotations

from typing import Any

from hjcamp.errors import HjcampError, RigStopped


class RigFault(RigStopped):
    """The rig was made safe because of a limit or a fault; nobody asked for it, and the outputs obeyed.

    Only after this, and only where the user said ``--keep-going``, may a run look at the rig again and go on; ``left`` is
    what the rig must know to do so.
    """

    def __init__(self, message: str, left: Any) -> None:
        super().__init__(message)
        self.left = left


class RigUnavailable(HjcampError):  # noqa: N818 - it is a state of the rig
    """There is no rig to work with; no test of this run can be made."""

    stops = 1
