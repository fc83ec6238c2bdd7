"""What every page says of itself: the command that goes on from it, and what made it of which logs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextvars import ContextVar
from typing import TYPE_CHECKING

from hjcamp import __version__
from hjcamp.errors import counted

if TYPE_CHECKING:
    from hjcamp.records.log import TestLog

#: The words of the call behind ``hjcamp``; none where pages are made from Python.
CALL: ContextVar[tuple[str, ...]] = ContextVar("call", default=())
HASH = 12


def next_steps(commands: Sequence[str]) -> str:
    """Return the commands that go on from a page, which can be pasted as they are."""
    from html import escape

    return f"<h3>Next</h3>\n<pre>{escape(chr(10).join(commands))}</pre>" if commands else ""


def made_from(logs: Iterable[TestLog]) -> str:
    """Return the last part of a page: command, version with commit, logs with their hash, day."""
    import hashlib
    import shlex

    from hjcamp.campaign.files.provenance import git_label, utc_now
    from hjcamp.configuration.saved_model import log_hashes
    from hjcamp.report.pages.discrepancy_page import heading, table_of

    hashes = log_hashes(log.path for log in logs)
    whole = hashlib.sha256("\n".join(sorted(hashes.values())).encode()).hexdigest()
    commit = git_label()
    rows = [
        ["command", shlex.join(("hjcamp", *CALL.get())) if CALL.get() else "called from Python"],
        ["version", f"{__version__}, commit {commit}" if commit else __version__],
        ["logs", f"{counted(len(hashes), 'log')}, sha256 {whole[:HASH]} (of their hashes, sorted)"],
        ["made on", f"{utc_now()[:10]} (UTC)"],
    ]
    return heading("Where this comes from") + table_of(("what", "this page"), rows)
