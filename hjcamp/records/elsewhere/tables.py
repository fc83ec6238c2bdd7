"""Read the columns that an import needs from the file of another program, whatever kind it is."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from hjcamp.errors import UsageError
from hjcamp.records.elsewhere.import_map import ImportMap
from hjcamp.records.elsewhere.reader import Table
from hjcamp.records.elsewhere.readers import reader_of


def read_table(source: Path, rules: ImportMap) -> Table:
    """Return the columns of a file that the map names; the end of its name says what it is.

    Raises UsageError for a file that cannot be read, a column that is not there, and a value that is no number.
    """
    names = list(dict.fromkeys(rule.key for rule in rules.rules.values()))
    check_file(source)
    try:
        found = reader_of(source).read(source, names, rules)
    except OSError as error:
        raise UsageError(f"{source}: cannot be read: {error.strerror or error}") from error
    lengths = {name: len(values) for name, values in found.columns.items()}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{name} {length}" for name, length in lengths.items())
        raise UsageError(f"{source}: the columns are not equally long: {listed}")
    if found.times is not None and len(found.times) != len(next(iter(found.columns.values()))):
        raise UsageError(f"{source}: it has {len(found.times)} times for columns of {next(iter(lengths.values()))} rows")
    if numbers := [one for one in rules.missing if not isinstance(one, str)]:
        for name, values in found.columns.items():
            found.columns[name] = np.where(np.isin(values, numbers), np.nan, values)
    return found


def check_file(source: Path) -> None:
    """Raise UsageError where there is no file of this name."""
    if not source.is_file():
        raise UsageError(f"{source}: cannot be read: {'it is a folder' if source.is_dir() else 'No such file'}")
