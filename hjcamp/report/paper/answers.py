"""The answers of compare, diagnose and calibrate as tables and numbers for a text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from hjcamp.errors import UsageError, counted, unknown
from hjcamp.json_text import read_json
from hjcamp.report.paper.names import macro
from hjcamp.report.paper.numbers import Quantity, of_estimate
from hjcamp.report.paper.tables import plain_sheet
from hjcamp.report.tables.sheet import NO_TEST, Sheet
from hjcamp.report.wording.names import UNITS
from hjcamp.report.wording.units import estimate_texts, label, number_like, plain


def read_answer(path: Path) -> dict[str, Any]:
    """Return an answer of which tables can be made; `UsageError` for a file that is none."""
    answer = read_json(path)
    kind = answer.get("schema") if isinstance(answer, dict) else None
    if not isinstance(kind, str) or kind not in SHEETS:
        raise unknown("schema", str(kind), SHEETS, str(path))
    found: dict[str, Any] = answer
    return found


def sheet_of(answer: Mapping[str, Any], name: str) -> Sheet:
    """Return the table of an answer; `UsageError` where a key that the schema promises is not there."""
    with _as_promised(answer, name):
        return SHEETS[answer["schema"]](answer, name)


def quantities_of(answer: Mapping[str, Any], prefix: str) -> dict[str, Quantity]:
    """Return the fitted parameters of an answer by the name of their macro."""
    with _as_promised(answer, prefix):
        rows = {name: row for name, row in (answer.get("calibration") or {}).items() if isinstance(row, dict)}
        found = {macro(prefix, name): of_estimate(row) for name, row in rows.items()}
        for one in answer.get("candidates") or []:
            if one.get("effect") in (answer.get("effects") or []):
                found |= {macro(prefix, one["effect"], name): of_estimate(row) for name, row in one["parameters"].items()}
    return found


@contextmanager
def _as_promised(answer: Mapping[str, Any], name: str) -> Iterator[None]:
    """Turn what goes wrong with an answer of another shape than its schema's into a ``UsageError``."""
    try:
        yield
    except (LookupError, TypeError, AttributeError, ValueError, ArithmeticError) as error:
        kind = f"{type(error).__name__}: {error}"
        raise UsageError(f"{name}: the answer is not what its schema {answer['schema']} says ({kind})") from error


def _comparison(answer: Mapping[str, Any], name: str) -> Sheet:
    rows = []
    for one in answer["models"]:
        for channel, error in one["error"].items():
            told = [plain(error[key]) if error and error.get(key) is not None else NO_TEST for key in ("rms", "floor")]
            score = "" if one["score"] is None else f"{one['score']:.2f}"
            rows.append([one["name"], _with_unit(channel), *told, score])
    headers = ["model", "channel", "rms error", "noise floor", "error over noise floor"]
    return plain_sheet(name, "Errors of the models on the same tests", headers, rows, ["In the unit of each channel."])


def _with_unit(channel: str) -> str:
    unit = UNITS[max((one for one in UNITS if channel.endswith(f"_{one}")), key=len, default="ratio")]
    return f"{label(channel)} ({unit})" if unit else label(channel)


def _diagnosis(answer: Mapping[str, Any], name: str) -> Sheet:
    rows = [
        [
            one["effect"],
            *(
                f"{value:.3f}" if (value := one.get(key)) is not None else NO_TEST
                for key in ("posterior", "heldout_error_ratio")
            ),
            "; ".join(f"{key} {_estimate(row)}" for key, row in one["parameters"].items()),
        ]
        for one in answer["candidates"]
    ]
    said = answer["verdict"].replace("_", " ") + (f": {', '.join(answer['effects'])}" if answer["effects"] else "")
    headers = ["effect", "posterior", "held-out error ratio", "parameters, 95 % interval"]
    return plain_sheet(name, "Effects that were fitted", headers, rows, [f"Verdict: {said}."])


def _calibration(answer: Mapping[str, Any], name: str) -> Sheet:
    rows = []
    for key, row in answer["calibration"].items():
        value, ends, unit = estimate_texts(row, 4)
        published = NO_TEST if row.get("published") is None else number_like(row["published"], row, 4)
        rows.append([row.get("text") or label(key), unit, value, " to ".join(ends) if ends else NO_TEST, published])
    headers = ["constant", "unit", "value", "95 % interval", "published"]
    return plain_sheet(name, f"Constants identified from {counted(answer['tests'], 'test')}", headers, rows)


def _estimate(row: Mapping[str, Any]) -> str:
    value, ends, unit = estimate_texts(row)
    interval = f" ({' to '.join(ends)})" if ends else ""
    return f"{value}{interval} {unit}".rstrip()


SHEETS = {
    "hjcamp.comparison/1": _comparison,
    "hjcamp.diagnosis/1": _diagnosis,
    "hjcamp.diagnosis/2": _diagnosis,
    "hjcamp.calibration/1": _calibration,
}
