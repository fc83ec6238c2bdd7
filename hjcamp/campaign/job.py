"""One job of Hydra: plan, run and conclude one campaign, alone or as part of a sweep."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

from hydra.core.hydra_config import HydraConfig
from hydra.experimental.callback import Callback
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf

from hjcamp.campaign.before import say_before_moving
from hjcamp.campaign.conclude import conclude
from hjcamp.campaign.folder import folder_for
from hjcamp.campaign.going_on import StopRule
from hjcamp.campaign.on_cluster import cluster_for
from hjcamp.campaign.planning import make_plan
from hjcamp.campaign.runner import run_plan
from hjcamp.configuration.composer import Composer
from hjcamp.configuration.run_keys import read_run_keys
from hjcamp.errors import HjcampError, Interrupted, RigStopped, UsageError

BASIC_LAUNCHER = "hydra._internal.core_plugins.basic_launcher.BasicLauncher"


class JobEnd:
    """How the job of a single run ended; Hydra would print a traceback for what is raised."""

    error: BaseException | None = None


class SweepFolder(Callback):
    """Remember where Hydra puts the jobs of a sweep."""

    path: Path | None = None

    def on_multirun_start(self, config: DictConfig, **kwargs: Any) -> None:
        """Note the folder before anything is written."""
        SweepFolder.path = Path(str(config.hydra.sweep.dir))


class JobError(HjcampError):
    """A job of a sweep failed; its message is out already."""


def job(config: DictConfig) -> str | None:
    """Run one campaign; the task function of Hydra."""
    sweep = HydraConfig.get().mode == RunMode.MULTIRUN
    try:
        return str(run_campaign(config, sweep))
    except Interrupted as error:
        if sweep:
            print(f"hjcamp: {error}", file=sys.stderr)
            raise KeyboardInterrupt from None
        JobEnd.error = error
    except RigStopped as error:
        if sweep:
            print(f"hjcamp: {error}", file=sys.stderr)
            raise SystemExit(error.exit_code) from None
        JobEnd.error = error
    except Exception as error:
        if not sweep:
            JobEnd.error = error
            return None
        exit_code = error.exit_code if isinstance(error, HjcampError) else 1
        number = HydraConfig.get().job.num
        print(f"hjcamp: job {number}: {error}", file=sys.stderr)
        failed = JobError(f"job {number} failed")
        failed.exit_code = exit_code
        raise failed from None
    return None


def run_campaign(config: DictConfig, sweep: bool) -> Path:
    """Plan, run and conclude what ``config`` asks for; returns the run folder."""
    from hjcamp.campaign.console import make_console

    hydra = HydraConfig.get()
    asked = OmegaConf.to_container(config, resolve=True)
    assert isinstance(asked, dict)
    plain = {str(key): value for key, value in asked.items()}
    lines = [str(line) for line in hydra.overrides.task]
    keys = read_run_keys(plain)
    sources = [(str(source.provider), f"{source.schema}://{source.path}") for source in hydra.runtime.config_sources]
    rule = StopRule(keys.fail_fast, keys.keep_going)
    composer = Composer(sources)
    if sweep and plain["backend"].get("name") != "simulation" and hydra.launcher._target_ != BASIC_LAUNCHER:
        raise UsageError("a rig runs one test at a time: leave hydra/launcher out, its default is the basic launcher")
    plan = make_plan(plain, hydra.runtime.choices.get("campaign"), lines, composer)
    run_dir = Path(str(keys.run_dir)) if keys.run_dir else None
    if sweep:
        run_dir = Path(os.path.relpath(hydra.runtime.output_dir))
    console = make_console()
    say_before_moving(plan, console)
    with cluster_for(keys.cluster, plan, "cluster=") as cluster:
        folder, goes_on = folder_for(plan, plain, lines, run_dir)
        if goes_on:
            console.print(f"goes on in {folder.path}", style="dim")
        result = run_plan(folder, console, keys.workers, rule, cluster=cluster)
    conclude(folder, result, console)
    return folder.path
