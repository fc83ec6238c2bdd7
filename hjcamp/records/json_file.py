"""Read a JSON file of ours: one place says what is wrong with it, before anything uses it."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.errors import UsageError

if TYPE_CHECKING:
    from pydantic import TypeAdapter, ValidationError

LONGEST_SHOWN = 60


def read_json_file(file: Path, shape: Any, schema: str) -> tuple[dict[str, Any], Any]:
    """Return the content of a file as plain values and as a ``shape`` (a dataclass), whose types it must have.

    Raises ``UsageError`` where the file is missing, not JSON, of another version, or of another shape.
    """
    from pydantic import ValidationError

    if not file.is_file():
        raise UsageError(f"{file} is missing")
    try:
        data = file.read_bytes()
    except OSError as error:
        raise UsageError(f"{file} cannot be read: {error.strerror or error}") from error
    try:
        plain: dict[str, Any] = _adapter(dict[str, Any]).validate_json(data)
        if plain.get("schema") != schema:
            given = _shown(plain["schema"]) if "schema" in plain else "missing"
            raise UsageError(f"{file}: schema is {given}; this version reads {schema}")
        return plain, _adapter(shape).validate_json(data, strict=True)
    except ValidationError as error:
        raise UsageError(f"{file}: {_first(error)}") from error


@cache
def _adapter(shape: Any) -> TypeAdapter[Any]:
    from pydantic import TypeAdapter

    return TypeAdapter(shape)


def _first(error: ValidationError) -> str:
    found = error.errors(include_url=False)[0]
    place = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in found["loc"]).lstrip(".")
    if found["type"] == "json_invalid":
        return f"this is not JSON: {found['ctx']['error']}"
    if not place:
        return "an object {...} is needed"
    if found["type"] == "missing":
        return f"{place} is missing"
    needed = re.sub(r"^Input should be (.*)$", r"\1 is needed", found["msg"])
    return f"{place} is {_shown(found['input'])}; {needed}"


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= LONGEST_SHOWN else text[:LONGEST_SHOWN] + "..."
