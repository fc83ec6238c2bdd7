"""MATLAB files, of version 7.3 (HDF5) as well."""

from __future__ import annotations

import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from hjcamp.errors import UsageError
from hjcamp.records.elsewhere.import_map import ImportMap
from hjcamp.records.elsewhere.mat_names import column_named, names_within
from hjcamp.records.elsewhere.reader import Column, Reader, Table, damage_as_refusal, first_line, need

HDF5_AT, HDF5 = 512, b"\x89HDF\r\n\x1a\n"


class Matlab(Reader):
    endings = (".mat",)
    says = "a MATLAB file"

    def read(self, source: Path, names: list[str], rules: ImportMap) -> Table:
        """Return the named columns: ``q``, ``data.q``, ``q(:,2)``, ``rec.Y(2).Data``."""
        content, variables = _content(source, sorted({re.split(r"[.({]", name)[0] for name in names}))
        return Table({name: column_named(source, name, content, variables) for name in names})

    def columns(self, source: Path, rules: ImportMap) -> list[Column]:
        """Return all columns of numbers, with the units that an export of ours has written."""
        content, _ = _content(source, None)
        units = content.get("units")
        said: dict[str, str] = {}
        if units is not None and units.dtype.names and units.size == 1:
            row = units.reshape(-1)[0]
            said = {name: str(np.asarray(row[name]).reshape(-1)[0]) for name in units.dtype.names if np.asarray(row[name]).size}
        return [Column(name, said.get(name, "")) for name in names_within(content)]


def _content(source: Path, wanted: list[str] | None) -> tuple[dict[str, Any], list[str]]:
    """Return the ``wanted`` variables of a file (None: all), and the names of all."""
    from scipy.io import loadmat, whosmat

    with source.open("rb") as stream:
        begin = stream.read(HDF5_AT + len(HDF5))
    if HDF5 in (begin[: len(HDF5)], begin[HDF5_AT:]):
        from hjcamp.records.elsewhere.matlab_73 import variables_of

        need("hdf5", ("h5py",), f"{source}: a file of MATLAB 7.3")
        with damage_as_refusal(source, "a file of MATLAB 7.3"):
            return variables_of(source, wanted)
    try:
        with warnings.catch_warnings(action="ignore"):
            variables = [name for name, _, _ in whosmat(source)]
            content = loadmat(source, squeeze_me=False, variable_names=wanted)
    except OSError:
        raise
    except Exception as error:  # scipy raises many kinds for bytes that are no such file
        raise UsageError(f"{source}: cannot be read as a MATLAB file: {first_line(error)}") from error
    return {name: value for name, value in content.items() if not name.startswith("__")}, variables
