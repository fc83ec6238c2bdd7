"""Make one run of a plan: its folder, every test that is left, the report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.campaign.conclude import conclude
from hjcamp.campaign.execution.before_moving import say_before_moving
from hjcamp.campaign.execution.on_cluster import cluster_for
from hjcamp.campaign.execution.stop_rule import StopRule
from hjcamp.campaign.files.provenance import code_identity
from hjcamp.campaign.files.run_folder import RunFolder, folder_for
from hjcamp.campaign.plan.planning import check_plan
from hjcamp.campaign.runner import RunResult, run_plan
from hjcamp.configuration.run_keys import read_run_keys
from hjcamp.live.feed import current_feed
from hjcamp.records.plan import Plan

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.report.build import Report


@dataclass(frozen=True)
class Made:
    """A run that was made: its folder, how its tests ended, its report."""

    path: Path
    result: RunResult
    report: Report | None


def make_run(plan: Plan, asked: Mapping[str, Any], lines: list[str], console: Console, run_dir: Path | None = None) -> Made:
    """Make every test of ``plan`` that is left, and the report; raises where tests failed.

    ``asked`` is the composed configuration of the call, ``lines`` its overrides; ``run_dir`` goes before that of the call.
    """
    keys = read_run_keys(asked)
    rule = StopRule(keys.fail_fast, keys.keep_going)
    if run_dir is None and keys.run_dir:
        run_dir = Path(str(keys.run_dir))
    say_before_moving(plan, console)
    # a page that cannot be had is said before anything is written
    current_feed()
    with cluster_for(keys.cluster, plan, "cluster=") as cluster:
        folder, goes_on = folder_for(plan, asked, lines, run_dir)
        if goes_on:
            console.print(f"goes on in {folder.path}", style="dim")
        result = run_plan(folder, console, keys.workers, rule, cluster=cluster)
    return _concluded(folder, result, console)


def finish_run(
    folder: RunFolder,
    console: Console,
    workers: int | None = None,
    rule: StopRule | None = None,
    cluster_address: str | None = None,
) -> Made:
    """Make the rest of a run that was begun, and the report; raises where tests failed."""
    check_plan(folder.plan, str(folder.path / "plan.json"))
    say_before_moving(folder.plan, console)
    sessions = folder.manifest["sessions"]
    if sessions and any(sessions[-1].get(key) != value for key, value in code_identity().items()):
        console.print("the program has changed since this run began; old and new tests may differ", style="yellow")
    with cluster_for(cluster_address, folder.plan, "--cluster ") as cluster:
        result = run_plan(folder, console, workers, rule, cluster=cluster)
    return _concluded(folder, result, console)


def _concluded(folder: RunFolder, result: RunResult, console: Console) -> Made:
    report = conclude(folder, result, console)
    feed = current_feed()
    if feed is not None:
        feed.say("complete", f"report: {report.page}" if report is not None else "")
    return Made(folder.path, result, report)
