"""The variables of a file of MATLAB 7.3 (HDF5) as those of older files are read: matrices, structures, cells."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from hjcamp.errors import UsageError
from hjcamp.records.elsewhere.reader import check_bytes

OWN = ("#refs#", "#subsystem#")
DEEPEST = 20
MOST_PARTS = 100_000  # of structures and cells


def variables_of(source: Path, wanted: list[str] | None) -> tuple[dict[str, Any], list[str]]:
    """Return the ``wanted`` variables of a file by name (None: all), and the names of all."""
    import h5py

    with h5py.File(source, "r", locking=False) as file:
        names = [name for name in file if name not in OWN and isinstance(file.get(name, getlink=True), h5py.HardLink)]
        parts = _Parts(file, source)
        return {name: parts.value(file[name], 0) for name in names if wanted is None or name in wanted}, names


class _Parts:
    """What an open file's groups, data sets and references stand for, counted so that damage ends."""

    def __init__(self, file: Any, source: Path) -> None:
        self.file, self.source, self.number = file, source, 0

    def value(self, item: Any, depth: int) -> np.ndarray:
        """Return a matrix (rows and columns as MATLAB has them), a structure of shape (1, 1), or an array of those or of cells."""
        import h5py

        self.number += 1
        if depth > DEEPEST or self.number > MOST_PARTS:
            raise UsageError(
                f"{self.source}: structures that are nested more than {DEEPEST} deep, or of more than {MOST_PARTS} parts"
            )
        if isinstance(item, h5py.Group):
            return self._structure({name: item[name] for name in item}, depth)
        if item.external or item.is_virtual:
            raise UsageError(f"{self.source}: what is kept in another file is not read")
        check_bytes(self.source, item.size * item.dtype.itemsize, f"'{item.name}'")
        kind = item.attrs.get("MATLAB_class", b"")
        if item.attrs.get("MATLAB_empty", 0):
            return np.zeros((0, 0))
        found = np.asarray(item[()])
        if found.dtype == object and h5py.check_ref_dtype(item.dtype) is not None:
            cells = np.empty(found.T.shape, dtype=object)
            for place, reference in np.ndenumerate(found.T):
                cells[place] = self.value(self.file[reference], depth + 1)
            return cells
        if kind == b"char":
            text = "".join(chr(one) for one in found.reshape(-1)) if found.dtype.kind in "ui" else ""
            return np.array([text])
        return found.T if found.ndim > 1 else found.reshape(-1)

    def _structure(self, fields: dict[str, Any], depth: int) -> np.ndarray:
        """Return a structure, or an array of structures, whose fields are data sets of references of one shape."""
        import h5py

        values = {name: self.value(one, depth + 1) for name, one in fields.items()}
        listed = [
            values[name].shape
            for name, one in fields.items()
            if isinstance(one, h5py.Dataset) and values[name].dtype == object and not one.attrs.get("MATLAB_class")
        ]
        several = len(listed) == len(fields) and len(set(listed)) == 1 and listed[0]
        kept = np.empty(listed[0] if several else (1, 1), dtype=[(name, object) for name in values] or [("", object)])
        for name, value in values.items():
            if several:
                kept[name] = value
            else:
                kept[name][0, 0] = value
        return kept
