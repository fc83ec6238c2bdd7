"""The figures of chapter 4 for the report of a run, where its logs are those of an identification."""

from __future__ import annotations

from collections.abc import Sequence

from hjcamp.configuration.setups import configuration_for
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.calibrate.constants import hardware_of
from hjcamp.plants.pump_joint.calibrate.estimate import Finding
from hjcamp.plants.pump_joint.calibrate.identify import identify
from hjcamp.plants.pump_joint.calibrate.kinds import KINDS, kind_of
from hjcamp.plants.pump_joint.calibrate.validation import validate
from hjcamp.plants.pump_joint.figures.identification import draw_chart, title_of
from hjcamp.records.log import TestLog
from hjcamp.records.stored import kept


def identification_pictures(logs: Sequence[TestLog]) -> dict[str, tuple[str, str]]:
    """Return heading -> (SVG, caption) of each figure that the logs of an identification campaign give.

    Logs of other campaigns give none. What cannot be identified is no error here: the report shows what was measured.
    """
    groups: dict[tuple[str, ...], list[TestLog]] = {}
    for log in logs:
        # The name alone decides: a controller's test is not searched for ramps.
        if log.metadata.get("campaign") in KINDS:
            groups.setdefault(tuple(choice for _, choice in hardware_of(log)), []).append(log)
    pictures = {}
    for names, own in groups.items():
        subject = " ".join(names) if len(groups) > 1 else ""
        try:
            with kept(own):
                findings = _findings(own)
        except UsageError:
            continue
        for finding in findings:
            values = [f"{one.text} {one.shown}" for one in finding.estimates]
            facts = [f"{key}: {value}" for key, value in finding.facts.items()]
            caption = "; ".join([*values, *facts, *finding.warnings])
            for chart in finding.charts:
                pictures[title_of(chart, subject)] = draw_chart(chart), caption
    return pictures


def _findings(logs: Sequence[TestLog]) -> list[Finding]:
    open_loop = [log for log in logs if kind_of(log) == "open_loop_validation"]
    others = [log for log in logs if kind_of(log) != "open_loop_validation"]
    found = list(identify(others, configuration_for).findings.values()) if others else []
    return found + ([validate(open_loop, configuration_for)] if open_loop else [])
