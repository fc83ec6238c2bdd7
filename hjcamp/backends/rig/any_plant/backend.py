"""Any plant on a rig: one resolved configuration and one seed make one test, under limits."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from datetime import UTC, datetime
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.backends.plant_simulation import law_of, log_sources, plant_in, prepare, simulator_of
from hjcamp.backends.recording import current_recording
from hjcamp.backends.rig.any_plant.control import PlantControl, control_text
from hjcamp.backends.rig.any_plant.driver import last_words, not_written
from hjcamp.backends.rig.any_plant.limits import PlantLimits, plant_watches
from hjcamp.backends.rig.any_plant.loop import PlantLoop, Stopped, StoppedForGood
from hjcamp.backends.rig.any_plant.session import (
    Session,
    check_driven,
    check_start,
    guard_of,
    open_session,
    require_check,
    rig_in,
    wiring_of,
)
from hjcamp.backends.rig.fault import RigFault
from hjcamp.backends.rig.journal import Journal
from hjcamp.backends.rig.stop import StopSignals, while_moving
from hjcamp.backends.rig.timing import LoopTiming, undisturbed
from hjcamp.backends.schedule import phases_of
from hjcamp.controllers.fit import sources
from hjcamp.errors import RigStopped
from hjcamp.model.checks.watch import Watch
from hjcamp.rigs.rig import Rig

Array = NDArray[np.float64]


def follows(config: Mapping[str, Any]) -> bool:
    """Return whether the law of a configuration looks at what is controlled: only then does that follow the reference."""
    law, _ = law_of(config)
    plant = plant_in(config)
    return any(one.startswith("seen[") for one in sources(law, plant, law.planned))


def check_test(config: Mapping[str, Any]) -> None:
    """Raise ``UsageError`` where wiring and limits of the rig do not reach what a test needs; nothing is opened."""
    rig = rig_in(config)
    wiring = wiring_of(rig, config)
    check_driven(rig, wiring, [*chain(*phases_of(config, plant_in(config)))])
    if follows(config):
        check_start(plant_in(config), rig, wiring, prepare(config, 1).test.reference[:, 0])


def run_test(config: Mapping[str, Any], seed: int) -> tuple[dict[str, Array], dict[str, str]]:
    """Make one test on the rig; return the columns of its log and what is worth noting as metadata.

    Raises ``RigStopped`` after the rig was made safe, ``RigUnavailable`` where there is none. ``seed`` decides what a virtual rig
    draws; a real one has its own scatter.
    """
    rig = rig_in(config)
    require_check(rig, config)
    return run_on(rig, config, seed)


def run_on(rig: Rig, config: Mapping[str, Any], seed: int) -> tuple[dict[str, Array], dict[str, str]]:
    """Make one test on a rig that is not open yet, as `run_test` does."""
    wiring = wiring_of(rig, config)
    prepared = prepare(config, seed)
    control = PlantControl(prepared)
    recording = current_recording()
    columns = log_sources(config, prepared.simulator)
    with while_moving() as signals, undisturbed(), open_session(rig, wiring, seed, signals) as session:
        facts = _facts(session)
        if recording is not None:
            recording.notes.update(facts)
        period = plant_in(config).period
        journal = Journal(recording, control.samples + 1, {name: scale for name, (_, scale) in columns.items()}, period)
        loop = PlantLoop(
            session.driver,
            wiring,
            control,
            PlantLimits(rig, wiring, follows(config)),
            journal,
            LoopTiming(control.samples, rig.lockstep),
            [source for source, _ in columns.values()],
            lambda: signals.reason,
        )
        reason, may_go_on = _driven(loop, session, signals)
    _raise(reason, may_go_on, session)
    notes = {"late_samples": str(loop.limits.missed), "cycle_times": loop.timing.histogram()}
    return journal.columns(0, journal.count), {**facts, **notes}


def _driven(loop: PlantLoop, session: Session, signals: StopSignals) -> tuple[str, bool]:
    """Run the loop; return why it ended early, empty where it did not, and whether the run may go on. The outputs come first."""
    reason, may_go_on = "", False
    signals.last_words = lambda: _close_log(loop)
    try:
        loop.run()
    except Stopped as error:
        reason, may_go_on = str(error), not isinstance(error, StoppedForGood)
    except KeyboardInterrupt:
        reason = "Ctrl-C"
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
    finally:
        session.problem = session.driver.make_safe()
        loop.journal.close()
    return reason, may_go_on


def _raise(reason: str, may_go_on: bool, session: Session) -> None:
    if session.problem is not None:
        raise RigStopped(f"{reason or 'the end of the test'}. {not_written(session.driver, session.problem)}")
    if reason and may_go_on:
        raise RigFault(f"the rig was made safe: {reason}", None)
    if reason:
        raise RigStopped(f"the rig was made safe: {reason}")


def _close_log(loop: PlantLoop) -> str:
    loop.journal.close()
    return last_words(loop.driver)


def _facts(session: Session) -> dict[str, str]:
    """Return what every log of a rig says about where, when (UTC) and under what guard it was made."""
    return {
        "devices": session.facts,
        "host": platform.node(),
        "started_at": datetime.now(UTC).isoformat(timespec="milliseconds"),
        **guard_of(session.driver.rig).facts(),
    }


def notices(config: Mapping[str, Any]) -> list[str]:
    """Return what a person must know of this rig; a device that has a watchdog may say so only once it is opened."""
    rig = rig_in(config)
    return [] if rig.says_at_open else guard_of(rig).notices()


def before_moving(config: Mapping[str, Any]) -> list[str]:
    """Return the same at the start of a run; raises ``UsageError`` where nothing must move."""
    rig = rig_in(config)
    if not rig.says_at_open:
        guard_of(rig).require()
    return notices(config)


def kernel_texts(config: Mapping[str, Any]) -> dict[str, tuple[str, str]]:
    """Return what a test here compiles: what each is in words, its text, and the function that is compiled last."""
    found = {"the control law for the rig": (control_text(simulator_of(config)), "decide")}
    if config["rig"]["name"] == "simulated":
        from hjcamp.backends.virtual_rig.stepping import step_simulator

        found["the plant on the virtual rig"] = (step_simulator(config).source, "tick")
    return found


def compile_ahead(config: Mapping[str, Any]) -> None:
    """Compile what a test here needs and see whether there is a rig, before anything moves."""
    PlantControl(prepare(config, 1))
    if config["rig"]["name"] == "simulated":
        from hjcamp.backends.virtual_rig.stepping import compile_stepping

        compile_stepping(config)
    rig = rig_in(config)
    wiring = wiring_of(rig, config)
    with while_moving() as signals, open_session(rig, wiring, 1, signals):
        pass


def watches(config: Mapping[str, Any], reach: bool = False) -> list[Watch]:
    """Return the limits of a rig that a log can show; with ``reach`` the ranges of its channels, too."""
    rig = rig_in(config)
    return plant_watches(rig, wiring_of(rig, config), follows(config), reach)


def look_again(config: Mapping[str, Any], left: Any) -> str:
    """Look at a rig that was made safe: at rest, in its limits, quiet; raises ``RigStopped`` where it is not fit."""
    from hjcamp.backends.rig.any_plant.check import at_rest

    rig = rig_in(config)
    wiring = wiring_of(rig, config)
    with while_moving() as signals, open_session(rig, wiring, 1, signals) as session:
        finding = at_rest(session, plant_in(config).period, lambda: signals.reason)
    if session.problem is not None:
        raise RigStopped(not_written(session.driver, session.problem))
    if not finding.passed:
        raise RigStopped(f"{finding.name}: {finding.text}")
    return f"{finding.name}: {finding.text}"
