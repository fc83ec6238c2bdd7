"""What is said before a run moves anything, and what it must not begin without."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from hjcamp import backends
from hjcamp.records.plan import Plan

if TYPE_CHECKING:
    from rich.console import Console


def say_notices(plan: Plan, console: Console) -> None:
    """Print what a person must know of the plan's rigs."""
    _say(plan, console, backends.notices)


def say_before_moving(plan: Plan, console: Console) -> None:
    """Print the same at the start of a run; raises ``UsageError`` where a rig must not move as it is described."""
    _say(plan, console, backends.before_moving)


def _say(plan: Plan, console: Console, texts_of: Callable[[Mapping[str, Any]], list[str]]) -> None:
    for text in dict.fromkeys(text for one in plan.conditions for text in texts_of(one.config)):
        console.print(f"  note    {text}", style="yellow", markup=False)
