"""Read YAML of the user's: what is no YAML, would never end or grows without bounds is one message with the file's name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from hjcamp.errors import UsageError
from hjcamp.storage import check_is_file

LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
MOST_VALUES = 200_000  # aliases counted as often as they are used
MOST_BYTES = 20_000_000
DEEPEST = 100


def read_yaml(path: Path) -> Any:
    """Return what a YAML file holds as plain values; raises ``UsageError`` as `check_yaml` does."""
    return _values(_text(path), str(path))


def check_yaml(path: Path, mapping: bool = False) -> None:
    """Raise ``UsageError``, with the file's name, where the file is no readable YAML or grows without bounds.

    With ``mapping`` it may hold keys with values only.
    """
    _values(_text(path), str(path), construct=False, mapping=mapping)


def yaml_values(content: bytes | str, where: str = "YAML") -> Any:
    """Return what a text holds, such as a log's attachment; raises ``UsageError`` as `check_yaml` does."""
    return _values(_decoded(content, where) if isinstance(content, bytes) else content, where)


def _text(path: Path) -> str:
    try:
        check_is_file(path)
        with path.open("rb") as stream:
            content = stream.read(MOST_BYTES + 1)
    except (OSError, ValueError) as error:
        raise UsageError(f"{path} cannot be read: {getattr(error, 'strerror', None) or error}") from error
    return _decoded(content, str(path))


def _decoded(content: bytes, where: str) -> str:
    if len(content) > MOST_BYTES:
        raise UsageError(f"{where} is longer than {MOST_BYTES / 1e6:g} MB: this cannot be configuration")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise UsageError(f"{where}: line {line}: this is not UTF-8 text") from error


def _values(text: str, where: str, construct: bool = True, mapping: bool = False) -> Any:
    loader: Any = None
    try:
        _check_depth(text)
        loader = LOADER(text)
        node = loader.get_single_node()
        count, depth = _size(node, {})
        if depth > DEEPEST:
            raise RecursionError
        if count > MOST_VALUES:
            raise UsageError(f"{where} holds {count:.3g} values, its aliases written out; at most {MOST_VALUES} are allowed")
        if mapping and node is not None and not isinstance(node, yaml.MappingNode):
            raise UsageError(f"{where}: names with values are needed (NAME: VALUE)")
        return None if node is None or not construct else loader.construct_document(node)
    except RecursionError:
        raise UsageError(f"{where}: a value holds itself, or is nested too deeply (at most {DEEPEST} levels)") from None
    except yaml.MarkedYAMLError as error:
        # What is missing at the end is found one line behind it.
        line = min(error.problem_mark.line, text.rstrip().count("\n")) + 1 if error.problem_mark else 1
        said = ": ".join(filter(None, (error.context, error.problem)))
        raise UsageError(f"{where}: {' '.join(said.split())}, line {line}") from error
    # A date such as 2001-99-99 and a number too long to be read are ValueErrors of Python's own.
    except (yaml.YAMLError, ValueError, TypeError, OverflowError) as error:
        raise UsageError(f"{where}: {' '.join(str(error).split())}") from error
    finally:
        if loader is not None:
            loader.dispose()


def _check_depth(text: str) -> None:
    """Raise ``RecursionError`` for a text that is nested too deeply: libyaml builds nodes on the processor's own stack."""
    depth, loader = 0, LOADER(text)
    try:
        while loader.check_event():
            event = loader.get_event()
            depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
            if depth > DEEPEST:
                raise RecursionError
    finally:
        loader.dispose()


def _size(node: yaml.Node | None, known: dict[int, tuple[int, int]]) -> tuple[int, int]:
    """Return how many values a node holds, and how deeply they are nested."""
    if node is None or isinstance(node, yaml.ScalarNode):
        return int(node is not None), 0
    if id(node) not in known:
        inner = [one for pair in node.value for one in pair] if isinstance(node, yaml.MappingNode) else node.value
        sizes = [_size(one, known) for one in inner]
        known[id(node)] = 1 + sum(count for count, _ in sizes), 1 + max((depth for _, depth in sizes), default=0)
    return known[id(node)]
