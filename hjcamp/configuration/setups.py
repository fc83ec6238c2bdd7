"""The resolved configuration for the hardware that a test log names."""

from __future__ import annotations

import functools
from typing import Any

from hjcamp.configuration.composer import Composer


@functools.lru_cache(maxsize=1)
def _composer() -> Composer:
    return Composer()


@functools.lru_cache(maxsize=64)
def configuration_for(names: tuple[tuple[str, str], ...]) -> dict[str, Any]:
    """Return the configuration with the given choices (group, choice); names and values that cannot be are refused."""
    from hjcamp.configuration.check import check_configuration

    config = dict(_composer().compose([f"{group}={choice}" for group, choice in names]).config)
    check_configuration(config)
    return config
