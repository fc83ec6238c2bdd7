"""A log as a recording of Rerun, with the blueprint that shows it: curves by panel, phases and missed samples as events."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from hjcamp.errors import UsageError
from hjcamp.records.log import TestLog
from hjcamp.storage import new_part

PANELS, EVENTS = "panel", "events"
TIMELINE = "test_time"
Labels = Mapping[str, Mapping[str, str]]


def events_of(log: TestLog, phases: Mapping[str, str]) -> list[tuple[float, str]]:
    """Return what happened in a test: (time in s, words) of each phase that begins, and what its metadata warn of."""
    time = log.columns["time_s"]
    found: list[tuple[float, str]] = []
    if "phase" in log.columns:
        phase = log.columns["phase"]
        begins = np.flatnonzero(np.diff(phase, prepend=phase[0] - 1.0))
        found = [(float(time[k]), phases.get(f"{phase[k]:g}", f"phase {phase[k]:g}")) for k in begins]
    if int(log.metadata.get("late_samples", "0") or 0):
        found.append((float(time[-1]), f"{log.metadata['late_samples']} samples were missed"))
    if log.metadata.get("warning"):
        found.append((float(time[-1]), log.metadata["warning"]))
    return found


def write_recording(path: Path, log: TestLog, panels: Labels, phases: Mapping[str, str]) -> Path:
    """Write a log as ``path`` (.rrd) with its blueprint; ``panels`` names the label of each field by panel.

    Raises ``UsageError`` where Rerun's library is not installed.
    """
    try:
        import rerun as rr
        import rerun.blueprint as rrb
    except ImportError:
        raise UsageError("--with rerun: the package rerun-sdk is not installed; pip install 'hjcamp[viewers]'") from None
    views: list[Any] = [rrb.TextLogView(origin=f"/{EVENTS}", name="events")]
    part = path.with_name(path.name + ".part")
    path.parent.mkdir(parents=True, exist_ok=True)
    new_part(part).close()
    recording = rr.RecordingStream("hjcamp", recording_id=log.metadata.get("config_sha256") or path.stem)
    recording.save(part)
    for number, (title, fields) in enumerate(panels.items()):
        here = [name for name in fields if name in log.columns]
        for name in here:
            place = f"{PANELS}_{number}/{name}"
            recording.log(place, rr.SeriesLines(names=fields[name]), static=True)
            recording.send_columns(
                place,
                indexes=[rr.TimeColumn(TIMELINE, duration=log.columns["time_s"])],
                columns=rr.Scalars.columns(scalars=log.columns[name]),
            )
        if here:
            views.append(rrb.TimeSeriesView(origin=f"/{PANELS}_{number}", name=title))
    for when, words in events_of(log, phases):
        recording.set_time(TIMELINE, duration=when)
        recording.log(EVENTS, rr.TextLog(words))
    recording.send_blueprint(rrb.Blueprint(rrb.Vertical(*views[1:], views[0]), rrb.TimePanel(state="collapsed")))
    recording.flush()
    recording.disconnect()
    os.replace(part, path)
    return path
