"""Overrides of the command line, read by Hydra's grammar."""

from __future__ import annotations

from collections.abc import Sequence

from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import Override
from hydra.errors import HydraException

from hjcamp.errors import UsageError, shown


def parse_overrides(lines: Sequence[str]) -> list[Override]:
    """Return the parsed overrides; raises ``UsageError`` where a line does not follow Hydra's grammar."""
    parsed = []
    parser = OverridesParser.create()
    for line in lines:
        try:
            parsed.append(parser.parse_override(line))
        except (HydraException, ValueError, RecursionError) as error:
            detail = str(error).splitlines()[0].split(". See ")[0].split("; use ")[0] if str(error) else "not understood"
            raise UsageError(
                f"cannot read the override {shown(line)}: {detail[:200]}. Expected GROUP=CHOICE or PARAMETER=VALUE"
            ) from error
    return parsed


def key_of(override: Override) -> str:
    """Return the group or parameter an override speaks of, without ``+`` and ``~``."""
    return override.key_or_group if override.package is None else f"{override.key_or_group}@{override.package}"
