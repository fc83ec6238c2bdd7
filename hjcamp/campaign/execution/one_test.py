"""Make one test: call the backend, write its log. Runs in the runner's process or in a worker."""

from __future__ import annotations

import os
import re
import signal
import threading
import time
import traceback
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from hjcamp.campaign.execution.outcome import Outcome
from hjcamp.campaign.files.provenance import log_provenance
from hjcamp.errors import HjcampError, Interrupted, RigStopped
from hjcamp.known_plants import usual_plant
from hjcamp.records.plan import Condition, Plan, PlannedTest
from hjcamp.storage import FULL, put_in_place

PRIVATE_NAME = re.compile(r"\.mcap\.\d+(\.part)?$")
_USUAL = usual_plant()
CHOICES = ("trajectory", "controller", *_USUAL.setups, "friction", *_USUAL.rig, "backend", "rig", "model")


@dataclass(frozen=True)
class Job:
    """One test with all it needs, so that it can be sent to a worker."""

    test: PlannedTest
    config: dict[str, Any]
    metadata: dict[str, str]
    attachment: bytes
    path: Path


def make_jobs(plan: Plan, tests: list[PlannedTest], folder: Path) -> list[Job]:
    """Return the jobs of some tests of a plan; the attachment is written once for each condition."""
    attachments = {one.name: configuration_text(one).encode() for one in plan.conditions}
    conditions = {one.name: one for one in plan.conditions}
    program = log_provenance()
    return [
        Job(
            test,
            conditions[test.condition].config,
            metadata_of(plan, conditions[test.condition], test, program),
            attachments[test.condition],
            folder / test.log,
        )
        for test in tests
    ]


def configuration_text(condition: Condition) -> str:
    """Return the resolved configuration of a condition as YAML."""
    dumper = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
    return str(yaml.dump(condition.config, Dumper=dumper, sort_keys=False, allow_unicode=True))


def metadata_of(plan: Plan, condition: Condition, test: PlannedTest, program: Mapping[str, str]) -> dict[str, str]:
    """Return the record ``hjcamp.test`` of a log, without what only the backend knows.

    It holds no time and no host: equal tests give equal logs, whenever and wherever they are made.
    """
    config = condition.config
    present = [group for group in CHOICES if config.get(group)]
    choices = {group: condition.choices.get(group) or config[group]["name"] for group in present}
    return {
        "campaign": plan.campaign,
        "condition": condition.name,
        **choices,
        "repetition": str(test.repetition),
        "seed": str(test.seed),
        **_of_plant(config),
        "config_sha256": condition.sha256,
        **program,
    }


def _of_plant(config: Mapping[str, Any]) -> dict[str, str]:
    """Return what the metadata say of the plant: its name, period and given parameters; of the usual plant its preload."""
    if not config.get("plant"):
        return {"preload_mpa": str(config["procedure"].get("preload_mpa"))}
    from hjcamp.backends.plant_simulation import model_of, plant_in
    from hjcamp.records.of_plant import PERIOD_KEY, PLANT_KEY

    plant = plant_in(config)
    values = model_of(config, plant)[1]
    told = {item.given: values.get(name, item.default) for name, item in plant.parameters.items() if item.given}
    return {
        PLANT_KEY: plant.name,
        PERIOD_KEY: f"{plant.period:g}",
        **{name: f"{value:g}" for name, value in told.items()},
    }


def execute(job: Job) -> Outcome:
    """Run one test and write its log under its final name; never raises except for an immediate stop."""
    from hjcamp import backends
    from hjcamp.backends.recording import recording
    from hjcamp.backends.rig.fault import RigFault
    from hjcamp.campaign.execution.ended_tests import followed_error
    from hjcamp.live.feed import current_feed
    from hjcamp.records.log import TestLog
    from hjcamp.records.write import LogWriter, write_log

    start = time.perf_counter()
    attachments = {"config.yaml": job.attachment}
    facts: dict[str, str] = {}
    private = private_place(job.path)

    def outcome(state: str, message: str = "", **further: Any) -> Outcome:
        message = message.replace(str(private), str(job.path))
        seconds = round(time.perf_counter() - start, 4)
        return Outcome(job.test.id, job.test.condition, state, seconds, message, facts=facts, **further)

    def open_writer(path: Path, names: Sequence[str]) -> LogWriter:
        return LogWriter(path, names, {**job.metadata, **facts}, attachments, replace=True)

    try:
        feed = current_feed()
        look = feed.look(job.test.id, job.test.condition) if feed is not None else None
        with recording(job.path, open_writer, facts, look):
            columns, extra = backends.run_test(job.config, job.test.seed)
            job.path.parent.mkdir(parents=True, exist_ok=True)
            write_log(private, TestLog(columns, {**job.metadata, **extra}, attachments))
            put_in_place(private, job.path)
        return outcome("done", extra.get("warning", ""), error=followed_error(columns, job.config))
    except Interrupted as error:
        return outcome("failed", str(error), stops=error.exit_code)
    except RigFault as error:
        return outcome("failed", str(error), stops=error.exit_code, left=error.left)
    except RigStopped as error:
        return outcome("failed", str(error), stops=error.exit_code)
    except (HjcampError, OSError) as error:
        text, stops = failed_to_write(error, job.path)
        return outcome("failed", text, stops=stops)
    except MemoryError:
        return outcome("failed", "not enough memory for this test", stops=1)
    except Exception as error:
        message = f"internal error: {type(error).__name__}: {error}"
        return outcome("failed", message, detail=traceback.format_exc())
    finally:
        private.unlink(missing_ok=True)


def private_place(path: Path) -> Path:
    """Return the name that a log has until it is whole.

    A worker that outlives a killed runner must not write into the same file as the next run's worker.
    """
    return path.with_name(f"{path.name}.{os.getpid()}")


def failed_to_write(error: HjcampError | OSError, log: Path) -> tuple[str, int | None]:
    """Return what to say of a test that failed for this reason, and the exit code where the run cannot go on."""
    text = no_place(error, log) if isinstance(error, OSError) else str(error)
    return text, 1 if disk_is_full(error) else getattr(error, "stops", None)


def execute_in_worker(job: Job) -> Outcome:
    """Run one test in a worker process, where Ctrl-C is the business of the runner."""
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    return execute(job)


def ignore_interrupts() -> None:
    """Let a worker live through Ctrl-C: the runner lets it finish the test in hand."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def no_place(error: OSError, log: Path) -> str:
    """Return what to say about a file that cannot be written; numba's errors name none."""
    from hjcamp.model.compile.kernel_cache import cache_folder

    place = error.filename or f"{log.parent}, or the kernels in {cache_folder()}"
    return f"cannot write to {place}: {error.strerror or error}"


def disk_is_full(error: BaseException | None) -> bool:
    """Return whether an error, or what caused it, is a full disk."""
    while error is not None:
        if isinstance(error, OSError) and error.errno in FULL:
            return True
        error = error.__cause__ or error.__context__
    return False
