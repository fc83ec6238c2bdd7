"""The tests of the joint on their coarser clock, prepared once."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

from hjcamp.analyses.data import Data, sound_logs

if TYPE_CHECKING:
    from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence
    from hjcamp.records.log import TestLog

_prepared: WeakKeyDictionary[Data, Evidence] = WeakKeyDictionary()


def evidence_in(data: Data) -> Evidence:
    """Return the evidence of loaded tests; it is prepared at the first call."""
    if data not in _prepared:
        _prepared[data] = evidence_of(data.paths, data.logs)
    return _prepared[data]


def evidence_of(paths: Sequence[Path], logs: Sequence[TestLog] | None = None) -> Evidence:
    """Return the evidence of the logs at ``paths``; refuse what cannot be, and say on stderr what is doubtful."""
    from hjcamp.plants.pump_joint.diagnosis.measured.evidence import prepare
    from hjcamp.records.find import read_logs, refuse_unanalysed

    logs = read_logs(list(paths)) if logs is None else logs
    refuse_unanalysed(logs, "the diagnosis")
    sound = sound_logs(logs)
    evidence = prepare(sound.logs, sound.odd)
    print(sound.doubtful, end="", file=sys.stderr)
    return evidence
