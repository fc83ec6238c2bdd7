"""What stops the drives when this computer no longer does: the device's watchdog, a hardware interlock, or nothing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from hjcamp.errors import UsageError

NOTHING = "none"
NO_NAMES = ("", "no", "off", "false", "null", "yes", "on", "true", "-", "?")
LEFT = "after a crash, kill -9 or a cut connection its outputs stay where they are"


@dataclass(frozen=True)
class Guard:
    """What guards the rig called ``name``: its watchdog (s, None: none) and ``interlock``; ``real``: it can do harm."""

    name: str
    real: bool
    watchdog_s: float | None
    interlock: str | None
    said_by: str = "rig.interlock"

    def notices(self) -> list[str]:
        """Return what a person must know of this rig before it moves; nothing where a watchdog guards it."""
        if self.watchdog_s is not None:
            return []
        text = f"rig '{self.name}' has no watchdog: {LEFT}"
        if not self.real:
            return [f"{text} (a virtual rig: nothing can be hurt)"]
        if self.interlock is None:
            return [f"{text}. A run is refused until {self.said_by} says what stops the drives then (docs/rig.md)"]
        if self.interlock == NOTHING:
            return [f"{text}, and nothing else stops the drives ({self.said_by}={NOTHING}): stay at the emergency stop"]
        return [f"{text}. Its interlock: {self.interlock}"]

    def require(self) -> None:
        """Raise ``UsageError`` for hardware without a watchdog of which nobody has said what stops the drives instead."""
        if self.real and self.watchdog_s is None and self.interlock is None:
            raise UsageError(
                f"rig '{self.name}' has no watchdog: {LEFT}, so nothing moves. "
                f"Say what stops the drives then: {self.said_by}='NAME OF THE HARDWARE INTERLOCK', "
                f"or {self.said_by}={NOTHING} where nothing does and somebody stays at the emergency stop (docs/rig.md)"
            )

    def facts(self) -> dict[str, str]:
        """Return for the log what guards the rig."""
        facts = {"watchdog": NOTHING if self.watchdog_s is None else f"{self.watchdog_s * 1e3:g} ms"}
        return facts if self.interlock is None else {**facts, "interlock": self.interlock}


def named_interlock(given: Any, rig: str) -> str | None:
    """Return what is said of an interlock: a name, ``none`` where there is nothing, None where nobody says; refuse what is no name."""
    if given is None:
        return None
    if not isinstance(given, str) or given.strip().lower() in NO_NAMES:
        raise UsageError(
            f"rig '{rig}': rig.interlock is {given!r}; name what stops the drives, "
            f"such as rig.interlock='enable relay of the drives', or say rig.interlock={NOTHING}"
        )
    return NOTHING if given.strip().lower() == NOTHING else given.strip()


def is_real(config: Mapping[str, Any]) -> bool:
    """Return whether ``rig.connection`` leads to hardware: the driver, or a device server that is no virtual rig."""
    given = config["rig"]["connection"]
    return given["kind"] == "driver" or (given["kind"] == "address" and not given.get("virtual", True))


def interlock_of(config: Mapping[str, Any]) -> str | None:
    """Return what ``rig.interlock`` names, ``none`` where it says that there is nothing, None where it says nothing."""
    return named_interlock(config["rig"].get("interlock"), config["rig"].get("name"))


def guard_of(config: Mapping[str, Any]) -> Guard:
    """Return what guards the rig of a configuration with a ``connection``."""
    watchdog = config["rig"].get("watchdog") or {}
    seconds = watchdog["timeout_ms"] * 1e-3 if watchdog.get("enabled") else None
    return Guard(config["rig"].get("name"), is_real(config), seconds, interlock_of(config))


def notices(config: Mapping[str, Any]) -> list[str]:
    """Return what a person must know of this rig before it moves; nothing where a watchdog guards it."""
    return guard_of(config).notices()


def require_guard(config: Mapping[str, Any]) -> None:
    """Raise ``UsageError`` for hardware without a watchdog of which nobody has said what stops the drives instead."""
    guard_of(config).require()


def guard_facts(config: Mapping[str, Any]) -> dict[str, str]:
    """Return for the log what guards the rig."""
    return guard_of(config).facts()
