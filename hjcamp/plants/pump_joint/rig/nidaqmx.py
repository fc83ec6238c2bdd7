"""A rig through NI-DAQmx: one test with the procedure and the control law of the simulator, under limits."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.backends.recording import current_recording
from hjcamp.backends.rig.fault import RigFault
from hjcamp.backends.rig.guard import guard_facts, notices, require_guard
from hjcamp.backends.rig.stop import while_moving
from hjcamp.backends.rig.timing import LoopTiming, undisturbed
from hjcamp.controllers import find_controller
from hjcamp.errors import RigStopped
from hjcamp.model.run.simulator import PERIOD
from hjcamp.plants.pump_joint.procedure import Procedure
from hjcamp.plants.pump_joint.rig.check_stamp import require_check
from hjcamp.plants.pump_joint.rig.connection import connect
from hjcamp.plants.pump_joint.rig.control import RigControl, control_source
from hjcamp.plants.pump_joint.rig.journal import Journal
from hjcamp.plants.pump_joint.rig.left import LeftAt
from hjcamp.plants.pump_joint.rig.limits import limit_check, read_limits
from hjcamp.plants.pump_joint.rig.lock import take_lock
from hjcamp.plants.pump_joint.rig.look_again import look_again as look_at
from hjcamp.plants.pump_joint.rig.loop import RigLoop, Stopped, StoppedForGood
from hjcamp.plants.pump_joint.rig.park import note_parked, parked_at
from hjcamp.plants.pump_joint.rig.tasks import RigTasks, device_facts, last_words, not_written
from hjcamp.plants.pump_joint.rig.wiring import read_wiring
from hjcamp.plants.pump_joint.simulation import (
    control_values,
    dither_of,
    effects_in,
    feedforward_of,
    feedforward_text,
    log_notes,
    procedure_values,
    reference_of,
    simulator_of,
)

Array = NDArray[np.float64]
SPARE_SAMPLES = 100
SLOWEST_RETURN = 2 * np.pi  # rad/s: 1 mm/s of the pump


def run_test(config: Mapping[str, Any], seed: int) -> tuple[dict[str, Array], dict[str, str]]:
    """Make one test on the rig; return the columns of its log and what is worth noting as metadata.

    Raises ``RigStopped`` after the rig was made safe, ``RigUnavailable`` where there is none. ``seed`` decides what a
    virtual rig draws; a real one has its own scatter. Source of the procedure: thesis 5.2.5.
    """
    wiring, limits = read_wiring(config), read_limits(config)
    require_check(config)
    control, procedure = rig_control(config)
    take_lock(config)
    parked = parked_at(config, wiring)
    longest = samples_at_most(config, procedure)
    recording = current_recording()
    with while_moving() as signals, undisturbed():
        connection = connect(config, seed)
        try:
            require_guard(config)
            facts = rig_facts(config, device_facts(wiring, connection))
            if recording is not None:
                recording.notes.update(facts)
            journal = Journal(recording, longest)
            try:
                loop = RigLoop(
                    RigTasks(wiring, connection, limits.read_timeout_ms * 1e-3, LeftAt(parked, 0.0)),
                    control,
                    limit_check(config, wiring),
                    journal,
                    LoopTiming(longest, config["rig"]["connection"]["kind"] != "driver"),
                    lambda: signals.reason,
                    parked,
                )
                signals.last_words = lambda: _close_log(loop)
                drive(loop, config)
            finally:
                journal.close()
        finally:
            connection.close()
    recorded = journal.columns(0, journal.count)
    return recorded, {**facts, **_notes(loop, recorded, config)}


def before_moving(config: Mapping[str, Any]) -> list[str]:
    """Return what a person must know before this rig moves; raises ``UsageError`` where it must not."""
    require_guard(config)
    return notices(config)


def kernel_texts(config: Mapping[str, Any]) -> dict[str, tuple[str, str]]:
    """Return what a test here compiles: what each is in words, its text, and the function that is compiled last."""
    law: Any = find_controller(config["controller"]["name"])
    found = {"the control law for the rig": (control_source(law), "decide"), **feedforward_text(config)}
    if config["rig"]["connection"]["kind"] == "in_process":
        from hjcamp.plants.pump_joint.virtual_rig.plant import bench_text

        simulator = simulator_of(config)
        found[f"the virtual rig with {effects_in(simulator)}"] = (bench_text(simulator), "rig_tick")
    return found


def compile_ahead(config: Mapping[str, Any]) -> None:
    """Compile what a test here needs and see whether there is a rig, before anything moves; needs the lock of the rig."""
    rig_control(config)
    connect(config, 1).close()


def look_again(config: Mapping[str, Any], left: LeftAt) -> str:
    """Look at the rig after a fault and bring it to where a test begins; raises ``HjcampError`` where it is not fit."""
    return look_at(config, left)


def drive(loop: RigLoop, config: Mapping[str, Any]) -> None:
    """Run the loop and leave the rig safe, whatever happens; then say why, as ``RigStopped`` or ``RigFault``."""
    reason, may_go_on = "the test could not be started", False
    speed = (config["rig"].get("return_speed_mm_per_s") or 0.0) / config["pump"]["lead_mm_per_rev"] * 2 * np.pi
    note_parked(config, loop.tasks.wiring, None)
    try:
        if loop.motor != 0.0:
            loop.return_to_start(speed or SLOWEST_RETURN)
            loop.control.out[:] = 0.0
        loop.run()
        if speed:
            loop.return_to_start(speed)
        reason = ""
    except Stopped as error:
        reason, may_go_on = str(error), not isinstance(error, StoppedForGood)
    except KeyboardInterrupt:
        reason = "Ctrl-C"
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
    finally:
        problem = loop.tasks.make_safe(loop.motor)
        note_parked(config, loop.tasks.wiring, None if problem else loop.tasks.stands_at(loop.motor))
        loop.journal.close()
        loop.tasks.close()
    if problem is not None:
        raise RigStopped(f"{reason or 'the end of the test'}. {not_written(loop.tasks, problem)}")
    if reason and may_go_on:
        raise RigFault(f"the rig was made safe: {reason}", LeftAt(loop.motor, loop.arm))
    if reason:
        raise RigStopped(f"the rig was made safe: {reason}")


def rig_control(config: Mapping[str, Any]) -> tuple[RigControl, dict[str, float]]:
    """Return what controls one test, and the parameters of its procedure."""
    law = find_controller(config["controller"]["name"])
    reference, direction = reference_of(config)
    samples = len(reference)
    procedure = procedure_values(config, direction, samples * PERIOD)
    dither = dither_of(config, samples)
    wiring = read_wiring(config)
    if wiring.quantity == "position" and "dither" not in wiring.outputs:
        dither = np.zeros(samples)
    control = RigControl(
        law,
        law.vector(control_values(config, law, direction)),
        Procedure.vector(procedure),
        np.column_stack([reference, feedforward_of(config, samples)]),
        dither,
        PERIOD,
    )
    return control, procedure


def samples_at_most(config: Mapping[str, Any], procedure: Mapping[str, float]) -> int:
    """Return how many samples a test may have: its own, and the longest of every other phase."""
    return round((procedure["control"] + procedure["rest"] + 3 * procedure["limit"]) / PERIOD) + SPARE_SAMPLES


def _close_log(loop: RigLoop) -> str:
    """Close the log of a test whose thread is stuck in a call; return what is known of the outputs."""
    loop.journal.close()
    return last_words(loop.tasks)


def rig_facts(config: Mapping[str, Any], devices: str) -> dict[str, str]:
    """Return what every log of a rig says about where, when (UTC) and under what guard it was made."""
    return {
        "devices": devices,
        "host": platform.node(),
        "calibration": str(config["rig"].get("calibration")),
        "started_at": datetime.now(UTC).isoformat(timespec="milliseconds"),
        **guard_facts(config),
    }


def _notes(loop: RigLoop, columns: dict[str, Array], config: Mapping[str, Any]) -> dict[str, str]:
    pascals = {name: columns[name] * 1e6 for name in ("pressure1_mpa", "pressure2_mpa")}
    notes = log_notes({"phase": columns["phase"], **pascals}, config["procedure"])
    notes["late_samples"] = str(loop.limits.missed)
    notes["cycle_times"] = loop.timing.histogram()
    return notes
