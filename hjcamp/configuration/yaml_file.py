"""Look at a configuration file before Hydra reads it: what would not end, or would end without the file's name."""

from __future__ import annotations

from pathlib import Path

import yaml

from hjcamp.errors import UsageError

MOST_VALUES = 200_000  # aliases counted as often as they are used


def check_file(path: Path) -> None:
    """Raise ``UsageError``, with the file's name, where the file is no readable YAML or grows without bounds."""
    try:
        text = path.read_bytes().decode()
    except UnicodeDecodeError as error:
        raise UsageError(
            f"{path} is no UTF-8 text: the byte at {error.start} is 0x{error.object[error.start]:02x}"
        ) from error
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}") from error
    try:
        node = yaml.compose(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
        count = _count(node, {})
    except RecursionError:
        raise UsageError(f"{path}: a value holds itself, or is nested too deeply") from None
    except yaml.YAMLError as error:
        raise UsageError(f"{path}: {' '.join(str(error).split())}") from error
    if count > MOST_VALUES:
        raise UsageError(f"{path} holds {count:.3g} values, its aliases written out; at most {MOST_VALUES} are allowed")


def _count(node: yaml.Node | None, known: dict[int, int]) -> int:
    if node is None:
        return 0
    if id(node) not in known:
        inner = [one for pair in node.value for one in pair] if isinstance(node, yaml.MappingNode) else node.value
        many = not isinstance(node, yaml.ScalarNode)
        known[id(node)] = 1 + (sum(_count(one, known) for one in inner) if many else 0)
    return known[id(node)]
