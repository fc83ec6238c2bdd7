"""What the commands answer, for the tests to look at."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple


class Answer(NamedTuple):
    """What a call of the command line gave."""

    code: int
    out: str
    err: str


Call = Callable[..., Answer]


def read_answer(path: Path) -> dict[str, Any]:
    """Return a JSON answer; NaN is refused."""

    def refuse(text: str) -> float:
        raise AssertionError(f"{text} in {path}")

    content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"), parse_constant=refuse)
    return content
