"""After a failed test: does the run go on with the next one?"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from hjcamp.campaign.execution.outcome import Outcome
from hjcamp.errors import HjcampError, UsageError


@dataclass(frozen=True)
class StopRule:
    """What the user said about failures.

    By default a test that fails by itself (an error in a simulation) is noted and the run goes on; a rig that was made
    safe, a full disk and a rig that is not there end it. ``fail_fast``: every failure ends it. ``keep_going``: after a
    limit or a fault the rig is looked at again, and the run goes on where that passes.
    """

    fail_fast: bool = False
    keep_going: bool = False

    def __post_init__(self) -> None:
        if self.fail_fast and self.keep_going:
            raise UsageError("--fail-fast and --keep-going say the opposite; give one of them")

    def stopper(self, outcome: Outcome, config: Mapping[str, Any], say: Callable[[str], None]) -> Outcome | None:
        """Return what ends the run after this failure, None where it goes on; ``say`` hears what was done."""
        if outcome.stops is None:
            return outcome if self.fail_fast else None
        if not self.keep_going or outcome.left is None:
            return outcome
        from hjcamp import backends

        try:
            found = backends.look_again(config, outcome.left)
        except HjcampError as error:
            return replace(outcome, message=f"{outcome.message}\nlooked at again, not fit to go on: {error}")
        say(f"{outcome.test}: {outcome.message}\n  looked at again ({found}); going on")
        return None
