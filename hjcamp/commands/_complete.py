"""Completion of overrides in the shell: groups, choices, campaigns and parameters."""

from __future__ import annotations


def complete_override(incomplete: str) -> list[str]:
    """Return what may follow ``incomplete``; nothing rather than an error."""
    try:
        from hjcamp.configuration.composer import Composer

        return Composer().complete(incomplete)
    except Exception:
        # A shell waits for an answer: a broken configuration must not print into the prompt.
        return []
