"""Words of a call that are effects first, then paths."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hjcamp.errors import UsageError, nearest, unknown
from hjcamp.known_plants import DEFAULT


def split(words: list[str], library: Any, plant: Any = DEFAULT) -> tuple[list[str], list[Path]]:
    """Return effects and paths; the first word that is no effect, nor nearly the name of one, begins the paths.

    An effect that does not fit the ``plant`` is refused with its reason.
    """
    from hjcamp.effects import library_of

    names: list[str] = []
    for index, word in enumerate(words):
        if word in library:
            names.append(word)
        elif names and (Path(word).exists() or "/" in word or nearest(word, library) is None):
            return names, [Path(one) for one in words[index:]]
        elif "/" in word and not Path(word).exists():
            raise UsageError(f"{word}: does not exist; give EFFECT... PATH..., or the folder of a table's diagnosis")
        else:
            library_of(plant).find(word)
            raise unknown("effect", word, library)
    raise UsageError("no logs were named: after the effects give a run folder, a folder of logs, or log files")
