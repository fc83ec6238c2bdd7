"""Run the rest of a plan: progress, state, stopping, going on."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.backends.rig.stop import StopSignals
from hjcamp.campaign.execution.one_test import PRIVATE_NAME, Job, make_jobs
from hjcamp.campaign.execution.outcome import Outcome
from hjcamp.campaign.execution.stop_rule import StopRule
from hjcamp.campaign.execution.workers import available_workers, outcomes
from hjcamp.campaign.files.json_files import run_errors
from hjcamp.campaign.files.lock import run_lock
from hjcamp.campaign.files.run_folder import RunFolder
from hjcamp.cluster import threads_of
from hjcamp.errors import HjcampError, Interrupted, RigStopped, UsageError, counted, without_numbers
from hjcamp.records.plan import Plan, PlannedTest
from hjcamp.records.run_folder import difference, refuse_links_out

if TYPE_CHECKING:
    from rich.console import Console


@dataclass
class RunResult:
    """How a run ended: tests made now, tests that were there, failures as (test, message), times the rig was made safe.

    ``before`` says why tests failed in an earlier session.
    """

    path: Path
    done: int = 0
    kept: int = 0
    failures: list[tuple[str, str]] = field(default_factory=list)
    warnings: dict[str, int] = field(default_factory=dict)
    made_safe: int = 0
    before: dict[str, str] = field(default_factory=dict)

    def stopped_again(self, stopper: Outcome) -> str:
        """Return what to say where a test was stopped by the same limit in an earlier session; else nothing."""
        then, now = (without_numbers(text) for text in (self.before.get(stopper.test, ""), stopper.message))
        # what was found when the rig was looked at again stands in a line of its own
        if stopper.stops != RigStopped.exit_code or then.partition("\n")[0] != now.partition("\n")[0]:
            return ""
        return f"{stopper.test} was stopped by the same limit before; without it: hjcamp report {self.path}\n"


def run_plan(
    folder: RunFolder,
    console: Console,
    workers: int | None = None,
    rule: StopRule | None = None,
    announce: Callable[[str], None] | None = None,
    cluster: Any = None,
) -> RunResult:
    """Make every test of the plan that has no whole log yet, on the ``cluster`` (a dask client) where one is given.

    After a failed test ``rule`` says whether the run goes on. Raises ``Interrupted`` after a stop that was asked for,
    ``RigStopped`` where the rig was made safe, ``HjcampError`` where it cannot go on (a full disk).
    """
    rule = rule or StopRule()
    aloud = announce or (lambda text: console.print(text, style="yellow", highlight=False))

    def say(text: str) -> None:
        aloud(text)
        folder.note(text)

    refuse_links_out(folder.path)
    with run_errors(folder.path), run_lock(folder.path):
        result = RunResult(folder.path)
        waiting = _waiting(folder, result, say)
        number, fixed = available_workers(workers, str(folder.plan.conditions[0].config["backend"].get("name")))
        if cluster is not None:
            number = threads_of(cluster)
        folder.begin(number)
        state = "interrupted"
        stopper = None
        try:
            with StopSignals(say) as signals:
                stopper = _run(folder, result, waiting, (number, fixed), signals, console, rule, say, cluster)
            state = "complete" if folder.complete else "failed" if result.failures else "interrupted"
        except KeyboardInterrupt:
            pass
        finally:
            with _bookkeeping(stopper):
                folder.end(state)
    left = len(folder.plan.tests) - result.done - result.kept
    if stopper is not None and stopper.stops is not None:
        kind = {3: RigStopped, 130: Interrupted}.get(stopper.stops, HjcampError)
        again = result.stopped_again(stopper)
        raise kind(f"{stopper.message}\n{again}{counted(left, 'test')} left; go on with: hjcamp resume {folder.path}")
    if state == "interrupted" and left:
        raise Interrupted(f"stopped, {left} of {len(folder.plan.tests)} tests left; go on with: hjcamp resume {folder.path}")
    return result


def _run(
    folder: RunFolder,
    result: RunResult,
    waiting: list[PlannedTest],
    workers: tuple[int, bool],
    signals: StopSignals,
    console: Console,
    rule: StopRule,
    say: Callable[[str], None],
    cluster: Any,
) -> Outcome | None:
    from hjcamp.campaign.execution.compiling import kernels_of
    from hjcamp.campaign.execution.ended_tests import Ends
    from hjcamp.campaign.execution.progress import progress_bar
    from hjcamp.model.compile.kernel_cache import cache_folder

    # Chosen here, so that the workers share it where the user's own cannot be written.
    cache_folder()
    stoppers: list[Outcome] = []
    jobs = make_jobs(folder.plan, waiting, folder.path)
    left = {test.condition for test in waiting}
    here = [one.config for one in folder.plan.conditions if one.name in left and cluster is None]
    kernels = kernels_of(here)
    ends = Ends(folder, waiting, console, kernels.words())
    with progress_bar(console, len(folder.plan.tests), result.kept, kernels) as advance:
        for outcome in _outcomes(jobs, workers, cluster, stop=lambda: signals.asked or bool(stoppers)):
            if outcome.state == "done":
                result.done += 1
                folder.record(outcome.test, "done", seconds=outcome.seconds)
                if outcome.message:
                    result.warnings[outcome.message] = result.warnings.get(outcome.message, 0) + 1
            else:
                result.failures.append((outcome.test, outcome.message))
                folder.note(f"{outcome.test}: {outcome.message}")
                result.made_safe += outcome.stops == RigStopped.exit_code
                detail = {"detail": outcome.detail} if outcome.detail else {}
                with _bookkeeping(outcome):
                    folder.record(outcome.test, "failed", message=outcome.message, **detail)
                stopper = rule.stopper(outcome, folder.plan.condition(outcome.condition).config, say)
                if stopper is not None:
                    stoppers.append(stopper)
            folder.note_rig(outcome.facts)
            ends(outcome)
            advance(outcome.test)
    return stoppers[0] if stoppers else None


def _outcomes(jobs: Sequence[Job], workers: tuple[int, bool], cluster: Any, stop: Callable[[], bool]) -> Iterator[Outcome]:
    if cluster is None:
        return outcomes(jobs, *workers, stop=stop)
    from hjcamp.campaign.execution.on_cluster import outcomes_on_cluster

    return outcomes_on_cluster(jobs, cluster, stop)


@contextmanager
def _bookkeeping(stopper: Outcome | None) -> Iterator[None]:
    """On a full disk the manifest cannot be written either: that must not hide why the run stops."""
    try:
        yield
    except HjcampError:
        if stopper is None or stopper.stops is None:
            raise


def _waiting(folder: RunFolder, result: RunResult, say: Callable[[str], None]) -> list[PlannedTest]:
    """Return the tests without a whole log, those that failed before last; what is damaged or foreign is put aside."""
    for left_over in folder.path.glob("logs/*/*.mcap.*"):
        if PRIVATE_NAME.search(left_over.name):
            left_over.unlink(missing_ok=True)
    waiting = []
    for test in folder.plan.tests:
        path = folder.path / test.log
        known = folder.manifest["tests"][test.id]
        if known["state"] != "done" and known.get("message"):
            result.before[test.id] = known["message"]
        if not path.exists():
            waiting.append(test)
            # why it failed is kept until it is made
            folder.manifest["tests"][test.id] = {**known, "state": "planned"}
            continue
        problem = _problem(folder.plan, test, path)
        if problem is None:
            result.kept += 1
            if known["state"] != "done":
                folder.manifest["tests"][test.id] = {"state": "done"}
            continue
        kind, reason = problem
        aside = _free(path.with_suffix(f".mcap.{kind}"))
        os.replace(path, aside)
        say(f"{path} is {kind} ({reason}); kept as {aside.name} and repeated")
        waiting.append(test)
        folder.manifest["tests"][test.id] = {"state": "planned"}
    # What a rig or a model stopped once may stop again: it must not keep the others from being made.
    return sorted(waiting, key=lambda test: test.id in result.before)


def _problem(plan: Plan, test: PlannedTest, path: Path) -> tuple[str, str] | None:
    """Return what a log is that cannot be kept, and why; None where it is the test that was planned, and whole."""
    from hjcamp.records.read import read_log

    try:
        other = difference(plan, test, read_log(path).metadata)
    except UsageError as error:
        return "damaged", str(error)
    return ("foreign", other) if other else None


def _free(path: Path) -> Path:
    """Return ``path``, with a number behind it where that name is taken: what was put aside before stays."""
    number, free = 1, path
    while os.path.lexists(free):
        number += 1
        free = path.with_name(f"{path.name}_{number}")
    return free
