"""Measured tests as the analyses take them: found, read once, refused where they cannot be."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, cast

from hjcamp.errors import counted

if TYPE_CHECKING:
    from hjcamp.diagnosis.data.tests import Measured
    from hjcamp.model.declare.plant import Plant
    from hjcamp.records.log import TestLog

Report = Callable[[str, float], None]


def silent(text: str, share: float) -> None:
    """Report nothing: how far an analysis is, for those who do not ask."""


class Data:
    """The tests at some paths: run folders, folders of logs, log files. The first log is looked at now, all when needed.

    With ``common`` a plant that has a diagnosis of its own is taken as that of any plant takes it (its room ``common``).
    Raises ``UsageError`` where there is no log; a property raises it for logs that the analysis cannot read.
    """

    def __init__(self, paths: Sequence[str | Path], common: bool = False) -> None:
        from hjcamp.known_plants import DEFAULT
        from hjcamp.records.find import find_logs
        from hjcamp.records.of_plant import PLANT_KEY
        from hjcamp.records.read import read_metadata

        self.paths, self.common = [Path(path) for path in paths], common
        self.plant_name = read_metadata(find_logs(self.paths)[0]).get(PLANT_KEY) or DEFAULT

    @cached_property
    def logs(self) -> list[TestLog]:
        """The logs, those of a run folder that belong to its plan."""
        from hjcamp.records.find import read_logs

        return read_logs(self.paths)

    @property
    def plant(self) -> type[Plant]:
        """The plant of these tests."""
        from hjcamp.known_plants import plant_called

        found = plant_called(self.plant_name, str(self.paths[0]))
        room = found.room_of("common") if self.common else None
        return found if room is None else cast("type[Plant]", room.PLANT)

    @cached_property
    def measured(self) -> Measured:
        """The tests as the analyses of any plant take them; what is doubtful is said on stderr."""
        from hjcamp.diagnosis.data.tests import measured_tests
        from hjcamp.model.checks.plant_checks import check_users_plant, other_period

        check_users_plant(self.plant)
        sound = sound_logs(self.logs)
        found = measured_tests(sound.logs, sound.copies, sound.odd, sound.missing, self.plant)
        print(sound.doubtful, end="", file=sys.stderr)
        if note := other_period(self.plant, found.period):
            print(note, file=sys.stderr)
        return found


@dataclass(frozen=True)
class Sound:
    """The ``logs`` that count, a line for each field that is ``doubtful``, the ``copies`` that were left out with their originals,
    logs that differ from their repetitions, which make any conclusion ``odd``, and those left out for a field that is ``missing``.
    """

    logs: list[TestLog]
    doubtful: str
    copies: tuple[tuple[str, str], ...]
    odd: tuple[str, ...]
    missing: tuple[tuple[str, str], ...]


def sound_logs(logs: Sequence[TestLog]) -> Sound:
    """Return the logs without copies, and what is doubtful in them, each and as a set; refuse what cannot be."""
    from hjcamp.records.sets.look import lines_of, refuse_odd

    lines = _doubtful_lines(logs)
    found = refuse_odd(logs)
    left_out = {id(one.log) for one in found if one.original is not None or one.left_out}
    copies = tuple((str(one.log.path), str(one.original.path)) for one in found if one.original is not None)
    odd = tuple(f"{one.log.path}: {one.finding.text}" for one in found if one.odd)
    missing = tuple((str(one.log.path), one.finding.field) for one in found if one.left_out)
    lines += "".join(f"{line}\n" for line in lines_of(found))
    return Sound([log for log in logs if id(log) not in left_out], lines, copies, odd, missing)


def _doubtful_lines(logs: Sequence[TestLog]) -> str:
    """Return a line for each field that is doubtful in some log; refuse what cannot be."""
    from hjcamp.records.plausible import refuse_implausible, without_small_tests

    doubtful: dict[str, list[str]] = {}
    for log, found in zip(logs, without_small_tests([refuse_implausible(log, str(log.path)) for log in logs]), strict=True):
        for one in found:
            doubtful.setdefault(one.field, []).append(f"{log.path}: {one.line}")
    more = {
        field: f" (and so in {counted(len(lines) - 1, 'more log')})" if len(lines) > 1 else ""
        for field, lines in doubtful.items()
    }
    return "".join(f"{lines[0]}{more[field]}\n" for field, lines in doubtful.items())


def joined(paths: Sequence[Path]) -> str:
    """Return the paths as they would be typed."""
    import shlex

    return shlex.join(str(path) for path in paths)


def free_model_name(stem: str) -> str:
    """Return a name that no model has yet: ``stem``, else ``stem_2`` and so on."""
    from hjcamp.configuration.composer import Composer
    from hjcamp.configuration.saved_model import FOLDER

    taken = set(Composer().options("model")) | {path.stem for path in FOLDER.glob("*.yaml")}
    number, name = 1, stem
    while name in taken:
        number += 1
        name = f"{stem}_{number}"
    return name
