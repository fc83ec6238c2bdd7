"""What a CI job reads of a run: a summary in Markdown, JUnit's XML of a check, metrics and parameters."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from typing import Any
from xml.etree import ElementTree

import polars as pl
import yaml

from hjcamp.errors import counted
from hjcamp.report.check import Violation, means_of, tables_of
from hjcamp.report.runs.indicators import INDICATORS
from hjcamp.report.tables.formats import escape_markdown, to_markdown
from hjcamp.report.tables.sheet import Cell, Sheet

SHOWN = 50
#: What XML 1.0 cannot hold, even escaped.
NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def summary_markdown(title: str, verdict: str, sheets: Sequence[Sheet], violations: Sequence[Violation] | None) -> str:
    """Return the page of a job: what was checked, what is outside (at most ``SHOWN``), and the tables."""
    parts = [f"# {escape_markdown(title)}\n"]
    if violations is not None:
        parts.append(
            f"**{counted(len(violations), 'mean is', 'means are')} outside the tolerances.**\n"
            if violations
            else "All means are within the tolerances.\n"
        )
        if violations:
            parts.append("\n" + to_markdown(_outside(violations)))
    if verdict:
        parts.append(f"\n{escape_markdown(verdict)}\n")
    return "\n".join(["".join(parts), *map(to_markdown, sheets)])


def junit_xml(suite: str, cells: pl.DataFrame, violations: Sequence[Violation], checked: Sequence[str]) -> str:
    """Return one test case for each mean of ``cells`` (of `against_published`) whose indicator was ``checked``.

    The tables in which a mean is printed are a property of its case.
    """
    outside = {(one.condition, one.indicator): str(one) for one in violations}
    means = means_of(cells, checked)
    root = ElementTree.Element("testsuites")
    place = ElementTree.SubElement(
        root,
        "testsuite",
        name=clean(suite),
        tests=str(len(means)),
        failures=str(len(violations)),
        errors="0",
        skipped="0",
    )
    for (condition, indicator), rows in means.items():
        case = ElementTree.SubElement(
            place, "testcase", classname=clean(f"{suite}.{indicator}"), name=clean(f"{condition} {indicator}"), time="0"
        )
        properties = ElementTree.SubElement(case, "properties")
        ElementTree.SubElement(properties, "property", name="tables", value=clean(tables_of(rows)))
        if said := outside.get((condition, indicator)):
            ElementTree.SubElement(case, "failure", message=clean(said)).text = clean(said)
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _outside(violations: Sequence[Violation]) -> Sheet:
    reference = violations[0].reference
    headers = ["condition", "indicator", "mean", reference, "difference", "allowed", "printed in"]
    more = [f"{len(violations) - SHOWN} more are outside."] if len(violations) > SHOWN else []
    rows = [[Cell(text) for text in one.row] for one in violations[:SHOWN]]
    return Sheet("outside", "Outside the tolerances", "", headers, rows, more)


def metrics_json(conditions: pl.DataFrame) -> str:
    """Return `metrics_of` as text, as trackers of experiments read it."""
    return json.dumps(metrics_of(conditions), indent=2, allow_nan=False) + "\n"


def metrics_of(conditions: pl.DataFrame) -> dict[str, Any]:
    """Return mean and deviation of every indicator by condition, and n."""
    found: dict[str, Any] = {}
    for row in conditions.iter_rows(named=True):
        values = {
            name: {"mean": row[f"{name}_mean"], "std": row[f"{name}_std"]}
            for name in INDICATORS
            if row[f"{name}_mean"] is not None
        }
        key, number = str(row["condition"]), 1
        while key in found:
            number += 1
            key = f"{row['condition']} ({number})"
        found[key] = {"n": row["n"], **values}
    return found


def params_yaml(plan: Mapping[str, Any]) -> str:
    """Return campaign, seed, repetitions and the choices of each condition of a plan."""
    kept = {name: plan[name] for name in ("campaign", "repetitions", "seed", "axes") if name in plan}
    conditions = {str(one["name"]): dict(one.get("choices") or {}) for one in plan.get("conditions") or ()}
    return str(yaml.safe_dump(json.loads(json.dumps({**kept, "conditions": conditions}, default=str)), sort_keys=False))


def clean(text: str) -> str:
    """Return a text without what XML cannot hold."""
    return NOT_IN_XML.sub("?", text)
