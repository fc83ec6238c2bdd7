"""What a value may be: strict models of configuration groups, and refusals that name path, value and what is allowed.

Import it where a configuration is checked, not at the top of a command: it brings pydantic.
"""

from __future__ import annotations

import json
import math
import types
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal, TypeVar, Union, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError

from hjcamp.errors import UsageError, shown, unknown
from hjcamp.storage import disk_errors, whole_file

NAMES = {
    float: "a number",
    int: "a whole number",
    bool: "true or false",
    str: "a text",
    type(None): "null",
    list: "a list",
    dict: "a mapping of names to values",
}


class Group(BaseModel):
    """The base of every group: no unknown keys, no conversion of types, finite numbers alone."""

    model_config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False, frozen=True)


Checked = TypeVar("Checked", bound=Group)


def between(low: float, high: float, default: Any = ...) -> Any:
    """Declare a number from ``low`` to ``high``, both included; without ``default`` it must be given."""
    return Field(default=default, ge=low, le=high)


def needs(text: str, at: str = "") -> PydanticCustomError:
    """Return what a validator raises: ``text`` says what is needed, ``at`` for which value of the group."""
    return PydanticCustomError("needs", "{text}", {"text": text, "at": at})


@contextmanager
def naming(where: str) -> Iterator[None]:
    """Put ``where`` before the message of any ``UsageError`` from within."""
    try:
        yield
    except UsageError as error:
        raise (UsageError(f"{where}: {error}") if where else error) from None


def checked(schema: type[Checked], content: Any, path: str) -> Checked:
    """Return ``content`` as ``schema`` describes it; ``UsageError`` names the first value that does not fit.

    ``path`` is where ``content`` stands in the configuration, such as ``rig.limits``; empty at its top.
    """
    try:
        return schema.model_validate(content)
    except ValidationError as problem:
        errors = problem.errors(include_url=False)
    # A misspelt key is also a missing one: its nearest match helps more.
    error = next((one for one in errors if one["type"] == "extra_forbidden"), errors[0])
    raise _refusal(schema, content, error, path)


def editor_line(file: Path, name: str, schema: Mapping[str, Any]) -> str:
    """Write a JSON schema as ``.schemas/NAME.json`` next to a file, and return the line by which editors find it there."""
    target = file.parent / ".schemas" / f"{name}.json"
    with disk_errors(target):
        target.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(target) as stream:
        stream.write((json.dumps(schema, indent=1) + "\n").encode())
    return f"# yaml-language-server: $schema=.schemas/{name}.json\n"


def _refusal(schema: type[Group], content: Any, error: Any, path: str) -> UsageError:
    location, value = error["loc"], error["input"]
    place = _path(content, location, path)
    if error["type"] == "extra_forbidden":
        model = _walk(schema, location[:-1])[0]
        return unknown("parameter", str(location[-1]), model.model_fields if model else (), place.rpartition(".")[0])
    model, field = _walk(schema, location)
    need = error["msg"] if error["type"] == "needs" else _need(field, model)
    if error["type"] == "missing":
        return UsageError(f"{place}.{location[-1]} is missing; {need} is needed".lstrip("."))
    if error["type"] == "needs" and isinstance(value, Mapping):
        at = error["ctx"]["at"]
        # A rule between several values stands at their group, whose content would say nothing.
        if not at:
            return UsageError(f"{place}: {need}")
        place, value = f"{place}.{at}", value.get(at)
    return UsageError(f"{place} is {shown(value)}; {need} is needed")


def _path(content: Any, location: Sequence[Any], path: str) -> str:
    # The location also holds which member of a union was tried: only what is in the content is a place.
    for part in location:
        if isinstance(content, Mapping) and part in content:
            content, path = content[part], f"{path}.{part}" if path else str(part)
        elif isinstance(content, Sequence) and isinstance(part, int):
            content, path = content[part], f"{path}[{part}]"
        else:
            break
    return path


def _walk(schema: type[Group], location: Sequence[Any]) -> tuple[type[Group] | None, FieldInfo | None]:
    """Return the group and the field at a location; a key of a free mapping stays with the field of the mapping."""
    model: type[Group] | None = schema
    field = None
    for part in location:
        if model is not None and part in model.model_fields:
            field = model.model_fields[part]
            model = next((one for one in _leaves(field.annotation) if _is_group(one)), None)
    return model, field


def _leaves(annotation: Any) -> Iterator[Any]:
    if get_origin(annotation) in (Union, types.UnionType, dict):
        for argument in get_args(annotation):
            yield from _leaves(argument)
    else:
        yield annotation


def _is_group(annotation: Any) -> bool:
    return isinstance(annotation, type) and issubclass(annotation, Group)


def _need(field: FieldInfo | None, model: type[Group] | None) -> str:
    if model is not None:
        return f"a mapping of {', '.join(model.model_fields)}"
    if field is None or get_origin(field.annotation) is dict:
        return NAMES[dict]
    limits = {key: getattr(one, key) for one in field.metadata for key in ("ge", "le") if hasattr(one, key)}
    if any(math.isinf(one) for one in limits.values()):
        limits = {}
    options = []
    for leaf in dict.fromkeys(_leaves(field.annotation)):
        style = ".0f" if leaf is int else "g"
        within = f" from {limits['ge']:{style}} to {limits['le']:{style}}" if limits and leaf in (float, int) else ""
        if get_origin(leaf) is Literal:
            options += [shown(one) for one in get_args(leaf)]
        else:
            options.append(NAMES.get(get_origin(leaf) or leaf, "a value") + within)
    return " or ".join(options)
