"""TDMS files, as LabVIEW, FlexLogger and DIAdem write them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from hjcamp.errors import UsageError, unknown
from hjcamp.records.elsewhere.import_map import ImportMap
from hjcamp.records.elsewhere.reader import Column, Reader, Table, check_bytes, damage_as_refusal, one_of


class Tdms(Reader):
    endings = (".tdms",)
    says = "TDMS"
    extra = "tdms"
    packages = ("nptdms",)

    def read(self, source: Path, names: list[str], rules: ImportMap) -> Table:
        """Return the named channels of the map's ``group``, and the times of a waveform by its ``wf_increment``."""
        with self._opened(source) as file:
            groups = {group.name: group for group in file.groups() if len(group.channels())}
            group = groups[one_of("group", rules.group, list(groups), source)]
            channels = {channel.name: channel for channel in group.channels()}
            columns = {name: _values(source, name, channels) for name in names}
            cut = file.file_status.incomplete_final_segment
            notes = ("the file is cut off: the whole samples are read, what came after them is lost",) if cut else ()
            return Table(columns, _times(source, [channels[name] for name in names]), notes)

    def columns(self, source: Path, rules: ImportMap) -> list[Column]:
        """Return the channels, with their ``unit_string``."""
        with self._opened(source) as file:
            groups = [group for group in file.groups() if len(group.channels())]
            return [
                Column(
                    channel.name,
                    str(channel.properties.get("unit_string", "")),
                    ("group", group.name) if len(groups) > 1 else None,
                )
                for group in groups
                for channel in group.channels()
                if not rules.group or group.name == rules.group
            ]

    @contextmanager
    def _opened(self, source: Path) -> Iterator[Any]:
        from nptdms import TdmsFile

        with damage_as_refusal(source, self.says), source.open("rb") as stream, TdmsFile.open(stream) as file:
            yield file


def _values(source: Path, name: str, channels: dict[str, Any]) -> np.ndarray:
    """Return a channel as numbers; time stamps as seconds since the first."""
    if name not in channels:
        raise unknown("channel", name, channels, str(source))
    check_bytes(source, 8 * len(channels[name]), f"'{name}'")
    found = np.asarray(channels[name][:])
    if found.dtype.kind == "M":
        return np.asarray((found - found[:1]) / np.timedelta64(1, "ns") * 1e-9)
    if found.dtype.kind not in "iufb":
        raise UsageError(f"{source}: '{name}' holds {found.dtype}, not numbers")
    return found.astype(np.float64)


def _times(source: Path, channels: list[Any]) -> np.ndarray | None:
    """Return the times of waveforms, s, from 0; None where a channel has no increment of time."""
    steps = {float(one.properties.get("wf_increment", 0.0)) for one in channels if len(one)}
    offsets = {float(one.properties.get("wf_start_offset", 0.0)) for one in channels if len(one)}
    steps.discard(0.0)
    if not steps:
        return None
    if len(steps) > 1 or len(offsets) > 1:
        listed = ", ".join(f"{one.name} {one.properties.get('wf_increment', 0.0):g} s" for one in channels)
        raise UsageError(f"{source}: the channels have clocks of their own ({listed}); import those of one clock")
    return np.arange(len(channels[0])) * steps.pop()
