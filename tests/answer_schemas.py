"""The schemas of the answers for programs, as the tests hold every answer against them."""

from __future__ import annotations

import json
from functools import lru_cache
from pathlib import Path
from typing import Any

SCHEMAS = Path(__file__).parents[1] / "docs" / "schemas"


@lru_cache(maxsize=64)
def validator(name: str) -> Any:
    """Return what validates answers of schema ``name`` (hjcamp.plan/1)."""
    from jsonschema import Draft7Validator

    file = SCHEMAS / f"{name.replace('/', '-')}.json"
    assert file.is_file(), f"{name} has no schema in {SCHEMAS}"
    return Draft7Validator(json.loads(file.read_text(encoding="utf-8")))


def check_answer(answer: dict[str, Any]) -> None:
    """Fail with the first place where an answer, as a reader of the file gets it, is not what its schema says."""
    read = json.loads(json.dumps(answer, allow_nan=False))
    problem = next(validator(read["schema"]).iter_errors(read), None)
    assert problem is None, f"{read['schema']}: {problem.json_path}: {problem.message[:300]}"
