"""Arrays of NumPy: an archive of several."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from hjcamp.records.elsewhere.array_names import column_of, columns_within
from hjcamp.records.elsewhere.import_map import ImportMap
from hjcamp.records.elsewhere.reader import Column, Reader, Table, check_archive, damage_as_refusal


class NumpyArchive(Reader):
    endings = (".npz",)
    says = "an archive of NumPy"

    def read(self, source: Path, names: list[str], rules: ImportMap) -> Table:
        """Return the named columns: ``q``, ``q[:,1]``, a field of records ``q.x``."""
        with self._opened(source) as arrays:
            return Table({name: column_of(source, name, arrays) for name in names})

    def columns(self, source: Path, rules: ImportMap) -> list[Column]:
        """Return the columns of all arrays, with the units that an export of ours has written."""
        with self._opened(source) as arrays:
            text = arrays.get("units")
            units = json.loads(str(text)) if text is not None and text.dtype.kind == "U" and text.size == 1 else {}
            return [Column(name, str(units.get(name, ""))) for name in columns_within(arrays)]

    @contextmanager
    def _opened(self, source: Path) -> Iterator[np.lib.npyio.NpzFile]:
        check_archive(source, self.says)
        with damage_as_refusal(source, self.says), np.load(source, allow_pickle=False) as arrays:
            yield arrays
