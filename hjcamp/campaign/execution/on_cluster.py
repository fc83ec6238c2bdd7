"""Make the tests of a run on a dask cluster: the workers simulate, and the logs are written here."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from hjcamp.campaign.execution.one_test import Job, execute, failed_to_write, private_place
from hjcamp.campaign.execution.outcome import Outcome
from hjcamp.campaign.files.provenance import log_provenance
from hjcamp.cluster import as_done, connected
from hjcamp.errors import UsageError
from hjcamp.records.plan import Plan
from hjcamp.storage import put_in_place, write_whole

#: What every log says of the program: with another one the logs would be others.
PROGRAM = ("version", "python", "packages", "git", "git_changes_sha256", "own_code_sha256")


@contextmanager
def cluster_for(address: str | None, plan: Plan, named: str) -> Iterator[Any]:
    """Give a client of the cluster that the tests of a plan are made on; None where no cluster is asked for.

    `UsageError` for tests that are not simulated, or where no scheduler answers.
    """
    if address is None:
        yield None
        return
    for condition in plan.conditions:
        if (backend := condition.config["backend"].get("name")) != "simulation":
            raise UsageError(f"{named}{address}: only simulated tests are made on a cluster, not those of {backend}")
    client = connected(address, named)
    try:
        yield client
    finally:
        client.close()


def outcomes_on_cluster(jobs: Sequence[Job], client: Any, stop: Callable[[], bool]) -> Iterator[Outcome]:
    """Yield the outcome of each job as it ends; its log is in its place then, byte for byte as it were made here."""
    for job, (outcome, content) in as_done(client, execute_for_another, jobs, stop):
        yield outcome if content is None else put_log(job, outcome, content)


def execute_for_another(job: Job) -> tuple[Outcome, bytes | None]:
    """Run one test on a worker, which need not see the run folder; return the outcome and the log as it would be written."""
    here = log_provenance()
    asked = {key: job.metadata.get(key) for key in PROGRAM}
    differs = [f"{key} {here.get(key)}, not {value}" for key, value in asked.items() if here.get(key) != value]
    if differs:
        message = (
            f"a worker of the cluster runs another program: {'; '.join(differs)}; start it in this folder, with this version"
        )
        return Outcome(job.test.id, job.test.condition, "failed", 0.0, message, stops=1), None
    with tempfile.TemporaryDirectory(prefix="hjcamp_") as folder:
        there = Path(folder) / job.path.name
        outcome = execute(replace(job, path=there))
        content = there.read_bytes() if outcome.state == "done" else None
    return replace(outcome, message=outcome.message.replace(str(there), str(job.path))), content


def put_log(job: Job, outcome: Outcome, content: bytes) -> Outcome:
    """Write a log that was made elsewhere under its final name, at once; return the outcome, failed where it cannot be."""
    private = private_place(job.path)
    try:
        job.path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(private, content)
        put_in_place(private, job.path)
    except OSError as error:
        message, stops = failed_to_write(error, job.path)
        return replace(outcome, state="failed", message=message, stops=stops)
    finally:
        private.unlink(missing_ok=True)
    return outcome
