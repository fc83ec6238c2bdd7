"""HDF5 files: a column is a data set, named by its path, or a column of one."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from hjcamp.errors import UsageError, unknown
from hjcamp.records.elsewhere.array_names import column_of, columns_within
from hjcamp.records.elsewhere.import_map import ImportMap
from hjcamp.records.elsewhere.reader import Column, Reader, Table, damage_as_refusal

MOST_NAMES = 20_000
UNITS = ("unit", "units", "Unit", "Units")


class Hdf5(Reader):
    endings = (".h5", ".hdf5", ".hdf")
    says = "HDF5"
    extra = "hdf5"
    packages = ("h5py",)

    def read(self, source: Path, names: list[str], rules: ImportMap) -> Table:
        """Return the named columns: ``run1/q``, ``q[:,1]``, a field of records ``log.q``; below the map's ``group``."""
        with self._opened(source, rules.group) as sets:
            return Table({name: column_of(source, name, sets) for name in names})

    def columns(self, source: Path, rules: ImportMap) -> list[Column]:
        """Return the columns of all data sets, with the units of their attributes."""
        with self._opened(source, rules.group) as sets:
            return [Column(name, _unit_of(sets, name)) for name in columns_within(sets)]

    @contextmanager
    def _opened(self, source: Path, group: str) -> Iterator[dict[str, Any]]:
        import h5py

        with damage_as_refusal(source, self.says), h5py.File(source, "r", locking=False) as file:
            sets = data_sets(file, source)
            below = group.strip("/")
            if below:
                found = {name[len(below) + 1 :]: one for name, one in sets.items() if name.startswith(f"{below}/")}
                if not found:
                    raise unknown("group", group, {name.rpartition("/")[0] for name in sets} - {""}, str(source))
                sets = found
            yield sets


def data_sets(group: Any, source: Path) -> dict[str, Any]:
    """Return the data sets below a group by their paths; what a file has linked from another one is no part of it."""
    import h5py

    found: dict[str, Any] = {}
    todo = [(group, "")]
    seen = {group.id.__hash__()}
    while todo:
        here, path = todo.pop(0)
        for name in here:
            if not isinstance(here.get(name, getlink=True), h5py.HardLink):
                continue
            one = here[name]
            if isinstance(one, h5py.Dataset):
                if not (one.external or one.is_virtual):
                    found[f"{path}{name}"] = one
            elif isinstance(one, h5py.Group) and hash(one.id) not in seen:
                seen.add(hash(one.id))
                todo.append((one, f"{path}{name}/"))
            if len(found) > MOST_NAMES:
                raise UsageError(f"{source}: more than {MOST_NAMES} data sets are no test")
    return found


def _unit_of(sets: dict[str, Any], name: str) -> str:
    attributes = sets[name].attrs if name in sets else {}
    found = next((attributes[key] for key in UNITS if key in attributes), "")
    return found.decode("utf-8", "replace") if isinstance(found, bytes) else str(found)
