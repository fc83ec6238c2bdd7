"""A rig that is open for one test or one check: found, locked, reached; whatever happens, it ends safe and closed."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hjcamp.backends.plant_simulation import law_of, plant_in
from hjcamp.backends.rig import check_stamp
from hjcamp.backends.rig.any_plant.driver import Driver, DriverFailed, last_words
from hjcamp.backends.rig.any_plant.limits import limits_of, told
from hjcamp.backends.rig.fault import RigUnavailable
from hjcamp.backends.rig.guard import Guard, named_interlock
from hjcamp.backends.rig.lock import hold
from hjcamp.controllers.fit import commanded, controlled_field
from hjcamp.errors import UsageError
from hjcamp.model.declare.field import Phase
from hjcamp.model.declare.plant import Plant
from hjcamp.model.files.user_file import file_of
from hjcamp.rigs import find_rig
from hjcamp.rigs.fit import Wiring, wired
from hjcamp.rigs.rig import Rig


@dataclass
class Session:
    """An open rig with its wiring; ``facts`` are what the device says of itself, ``problem`` what kept it from being safe."""

    driver: Driver
    wiring: Wiring
    facts: str = ""
    problem: str | None = None


def rig_in(config: Mapping[str, Any]) -> Rig:
    """Return the rig that a configuration names, not open; raises ``UsageError`` for one that is not of its plant."""
    plant, name = plant_in(config), str(config["rig"]["name"])
    if name in ("simulated", "virtual"):
        from hjcamp.backends.virtual_rig.clients import shipped_rig

        rig = shipped_rig(name, config)
    else:
        rig = find_rig(name)()
    if rig.plant and rig.plant != plant.name:
        raise UsageError(f"rig '{name}' is of plant {rig.plant}; this test is of plant {plant.name}")
    if lacking := rig.lacking():
        raise UsageError(f"rig '{name}' has no {' and no '.join(f'{one}()' for one in lacking)}")
    rig.interlock = named_interlock(config["rig"].get("interlock") or rig.interlock, name)
    return rig


def wiring_of(rig: Rig, config: Mapping[str, Any]) -> Wiring:
    """Return the wiring of a rig for the plant and the law of a configuration, and tell the rig its channels."""
    plant = plant_in(config)
    law, chosen = law_of(config)
    wiring = wired(rig, plant, commanded(law, plant, chosen))
    rig.measured, rig.given = wiring.readings, tuple(one.channel for one in wiring.given)
    return wiring


def guard_of(rig: Rig) -> Guard:
    """Return what guards a rig."""
    return Guard(rig.name, rig.real, rig.watchdog_s, rig.interlock)


def decisive(rig: Rig) -> dict[str, Any]:
    """Return every value that a check of a rig rests on, by its dotted path, as JSON keeps it: its file, too, which is code."""
    file = file_of(type(rig).__module__)
    content = hashlib.sha256(Path(file).read_bytes()).hexdigest()[:16] if file else ""
    values = dict(check_stamp.leaves("", {**told(rig), "interlock": rig.interlock, "file": content}))
    return dict(json.loads(json.dumps(values)))


def stamp_path(rig: Rig) -> Path:
    """Return the file that says what was checked last on a rig."""
    return check_stamp.state_file(rig.name, f"{rig.identity()} {rig.plant}", ".json")


def require_check(rig: Rig, config: Mapping[str, Any]) -> None:
    """Raise ``RigUnavailable`` unless the check has passed, or the user says ``rig.check_required=false``."""
    if rig.real and config["rig"].get("check_required", True):
        command = f"hjcamp rig check plant={plant_in(config).name} rig={rig.name}"
        check_stamp.refuse_unchecked(rig.name, check_stamp.differences(stamp_path(rig), decisive(rig)), command)


def check_start(plant: type[Plant], rig: Rig, wiring: Wiring, reference: Any) -> None:
    """Raise ``UsageError``, with the numbers, for a reference (n,), SI, of what is controlled that leaves its limits."""
    field = controlled_field(plant)
    limit = next(one for one in limits_of(wiring) if one.wire.field == field)
    values = reference * abs(limit.wire.scale)
    low, high = max(limit.low, limit.wire.channel.range[0]), min(limit.high, limit.wire.channel.range[1])
    for value, words in ((values[0], "begins at"), (values.min(), "goes to"), (values.max(), "goes to")):
        if not low <= value <= high:
            there = f"{limit.name} is limited to {low:g} to {high:g}"
            raise UsageError(f"rig '{rig.name}': the trajectory {words} {value:.4g} {limit.wire.unit}; {there}")


def check_driven(rig: Rig, wiring: Wiring, phases: Iterable[Phase]) -> None:
    """Raise ``UsageError``, with the numbers, for a phase that takes an input beyond what the rig gives."""
    for limit in limits_of(wiring):
        low, high = limit.clipped
        for one in phases:
            value = one.to.get(limit.wire.name, None)
            if value is not None and not low <= (asked := value * abs(limit.wire.scale)) <= high:
                raise UsageError(
                    f"rig '{rig.name}': phase '{one.name}' takes {limit.name} to {asked:.4g} {limit.wire.unit}; "
                    f"it is limited to {low:g} to {high:g}"
                )


@contextmanager
def open_session(rig: Rig, wiring: Wiring, seed: int, signals: Any) -> Iterator[Session]:
    """Give a rig that is open and whose outputs are safe; at the end they are made safe, and it is closed."""
    if rig.real:
        hold(rig.identity())
    rig.seed = seed
    driver = Driver(rig)
    session = Session(driver, wiring)
    try:
        try:
            driver.open()
            session.facts = rig.facts()
        except DriverFailed as error:
            raise RigUnavailable(f"rig '{rig.name}': {error}") from error
        guard_of(rig).require()
        signals.last_words = lambda: last_words(driver)
        if (problem := driver.make_safe()) is not None:
            raise RigUnavailable(f"rig '{rig.name}': before anything moved its outputs could not be made safe: {problem}")
        try:
            yield session
        finally:
            if session.problem is None and not driver.is_safe:
                session.problem = driver.make_safe()
    finally:
        driver.close()
