"""What stops the drives when this computer no longer does: the device's watchdog, a hardware interlock, or nothing."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hjcamp.errors import UsageError

NOTHING = "none"
NO_NAMES = ("", "no", "off", "false", "null", "yes", "on", "true", "-", "?")
LEFT = "after a crash, kill -9 or a cut connection its outputs stay where they are"


def is_real(config: Mapping[str, Any]) -> bool:
    """Return whether ``rig.connection`` leads to hardware: the driver, or a device server that is no virtual rig."""
    given = config["rig"]["connection"]
    return given["kind"] == "driver" or (given["kind"] == "address" and not given.get("virtual", True))


def interlock_of(config: Mapping[str, Any]) -> str | None:
    """Return what ``rig.interlock`` names, ``none`` where it says that there is nothing, None where it says nothing."""
    given = config["rig"].get("interlock")
    if given is None:
        return None
    if not isinstance(given, str) or given.strip().lower() in NO_NAMES:
        raise UsageError(
            f"rig '{config['rig'].get('name')}': rig.interlock is {given!r}; name what stops the drives, "
            f"such as rig.interlock='enable relay of the drives', or say rig.interlock={NOTHING}"
        )
    return NOTHING if given.strip().lower() == NOTHING else given.strip()


def notices(config: Mapping[str, Any]) -> list[str]:
    """Return what a person must know of this rig before it moves; nothing where a watchdog guards it."""
    watchdog, interlock = config["rig"].get("watchdog") or {}, interlock_of(config)
    if watchdog.get("enabled"):
        return []
    text = f"rig '{config['rig'].get('name')}' has no watchdog: {LEFT}"
    if not is_real(config):
        return [f"{text} (a virtual rig: nothing can be hurt)"]
    if interlock is None:
        return [f"{text}. A run is refused until rig.interlock says what stops the drives then (docs/rig.md)"]
    if interlock == NOTHING:
        return [f"{text}, and nothing else stops the drives (rig.interlock={NOTHING}): stay at the emergency stop"]
    return [f"{text}. Its interlock: {interlock}"]


def require_guard(config: Mapping[str, Any]) -> None:
    """Raise ``UsageError`` for hardware without a watchdog of which nobody has said what stops the drives instead."""
    watchdog = config["rig"].get("watchdog") or {}
    if is_real(config) and not watchdog.get("enabled") and interlock_of(config) is None:
        raise UsageError(
            f"rig '{config['rig'].get('name')}' has no watchdog: {LEFT}, so nothing moves. "
            "Say what stops the drives then: rig.interlock='NAME OF THE HARDWARE INTERLOCK', "
            f"or rig.interlock={NOTHING} where nothing does and somebody stays at the emergency stop (docs/rig.md)"
        )


def guard_facts(config: Mapping[str, Any]) -> dict[str, str]:
    """Return for the log what guards the rig."""
    watchdog = config["rig"].get("watchdog") or {}
    enabled = watchdog.get("enabled")
    facts = {"watchdog": f"{watchdog['timeout_ms']:g} ms" if enabled else NOTHING}
    interlock = interlock_of(config)
    return facts if interlock is None else {**facts, "interlock": interlock}
