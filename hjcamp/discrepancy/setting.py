"""Where compare and diagnose learn the configuration: set by the command line, so that this layer stays below it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

Setup = tuple[tuple[str, str], ...]
_composers: list[Callable[[Setup], dict[str, Any]]] = []


def use_configuration(composer: Callable[[Setup], dict[str, Any]]) -> None:
    """Let ``composer`` give the resolved configuration for the choices that a log names."""
    _composers[:] = [composer]


def setup_configuration(names: Setup) -> dict[str, Any]:
    """Return the resolved configuration for the choices (group, choice) that a log names."""
    if not _composers:
        from importlib import import_module

        use_configuration(import_module("hjcamp.campaign.setups").configuration_for)
    return _composers[0](names)
