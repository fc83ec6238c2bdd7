"""Whether the check of a rig has passed for what it is now, and if not, what has changed."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from hjcamp.backends.rig.fault import RigUnavailable
from hjcamp.json_text import read_json
from hjcamp.storage import user_folder, whole_file

CHECKED = "checked"
SHOWN = 3


def state_file(rig: str, where: str, suffix: str) -> Path:
    """Return a file that is kept for the rig of a name at a connection; raises ``RigUnavailable`` for a user without a home folder."""
    digest = hashlib.sha256(where.encode()).hexdigest()[:16]
    base = user_folder("XDG_STATE_HOME", ".local", "state")
    if base is None:
        raise RigUnavailable("this user has no home folder to keep a rig's check in: set XDG_STATE_HOME to a folder")
    return base / "hjcamp" / "rig_checks" / f"{rig}_{digest}{suffix}"


def leaves(path: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Return every value below ``value`` by its dotted path."""
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from leaves(f"{path}.{key}" if path else key, item)
    else:
        yield path, value


def write(path: Path, findings: Mapping[str, Any], now: Mapping[str, Any]) -> Path:
    """Note that the check has passed for the values ``now``; returns the file."""
    content = {"checked_at": datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ"), **findings, CHECKED: now}
    with whole_file(path) as stream:
        stream.write(json.dumps(content, indent=1).encode())
    return path


def differences(path: Path, now: Mapping[str, Any]) -> list[str] | None:
    """Return what differs from the last check that passed, nothing where it holds, None where there was none."""
    try:
        then = read_json(path)[CHECKED]
    except (OSError, ValueError, KeyError, TypeError):
        return None
    if not isinstance(then, dict):
        return None
    return [
        f"{one} was {_shown(then, one)} and is {_shown(now, one)}"
        for one in dict.fromkeys((*now, *then))
        if one not in then or one not in now or then[one] != now[one]
    ]


def refuse_unchecked(name: str, changed: list[str] | None, command: str) -> None:
    """Raise ``RigUnavailable`` where what has ``changed`` since the check, or that there was none, forbids to move the rig."""
    if changed == []:
        return
    why = ""
    if changed:
        more = f" and {len(changed) - SHOWN} more" if len(changed) > SHOWN else ""
        why = f" (since the last check {', '.join(changed[:SHOWN])}{more})"
    raise RigUnavailable(
        f"rig '{name}' was not checked as it is configured now{why}, so nothing moves: "
        f"run `{command}` first, or say rig.check_required=false"
    )


def _shown(values: Mapping[str, Any], path: str) -> str:
    return str(values[path]) if path in values else "absent"
