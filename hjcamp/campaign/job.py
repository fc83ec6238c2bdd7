"""One job of Hydra: plan, run and conclude one campaign, alone or as part of a sweep."""

from __future__ import annotations

import os
import sys
import time
from contextlib import nullcontext
from pathlib import Path
from typing import Any

from hydra.core.hydra_config import HydraConfig
from hydra.experimental.callback import Callback
from hydra.types import RunMode
from omegaconf import DictConfig, ListConfig, OmegaConf

from hjcamp.campaign.execution.console import make_console
from hjcamp.campaign.one_run import make_run
from hjcamp.campaign.plan.objective import read_objectives
from hjcamp.campaign.plan.planning import make_plan
from hjcamp.configuration.composer import Composer
from hjcamp.configuration.run_keys import read_run_keys
from hjcamp.errors import HjcampError, Interrupted, RigStopped, UsageError

BASIC_LAUNCHER = "hydra._internal.core_plugins.basic_launcher.BasicLauncher"


class JobEnd:
    """How the job of a single run ended; Hydra would print a traceback for what is raised."""

    error: BaseException | None = None


class SweepFolder(Callback):
    """Remember where Hydra puts the jobs of a sweep, which way its sweeper looks, and what it varies."""

    path: Path | None = None
    directions: tuple[str, ...] = ()
    fixed: tuple[str, ...] = ()

    def __init__(self) -> None:
        self.task: tuple[str, ...] = ()

    def on_multirun_start(self, config: DictConfig, **kwargs: Any) -> None:
        """Note the folder before anything is written."""
        SweepFolder.path = Path(str(config.hydra.sweep.dir))
        SweepFolder.directions = directions_of(config.hydra.sweeper)
        self.task = tuple(str(line) for line in config.hydra.overrides.task)

    def on_job_start(self, config: DictConfig, **kwargs: Any) -> None:
        """Note what was asked of the whole sweep; Hydra hands this object to the process of the job."""
        SweepFolder.fixed = self.task


def directions_of(sweeper: Any) -> tuple[str, ...]:
    """Return what a sweeper does with each objective, ``minimize`` or ``maximize``; empty where it does not say."""
    given = sweeper.get("direction")
    several = given if isinstance(given, list | tuple | ListConfig) else [given]
    return tuple(str(getattr(one, "name", one)) for one in several if one is not None)


class JobError(HjcampError):
    """A job of a sweep failed; its message is out already."""


def job(config: DictConfig) -> float | tuple[float, ...] | str | None:
    """Run one campaign; the task function of Hydra. Returns the objectives where some are asked for, else the run folder."""
    sweep = HydraConfig.get().mode == RunMode.MULTIRUN
    try:
        return run_campaign(config, sweep)
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


def run_campaign(config: DictConfig, sweep: bool) -> float | tuple[float, ...] | str:
    """Plan, run and conclude what ``config`` asks for; returns what `job` does."""
    hydra = HydraConfig.get()
    asked = OmegaConf.to_container(config, resolve=True)
    assert isinstance(asked, dict)
    plain = {str(key): value for key, value in asked.items()}
    lines = [str(line) for line in hydra.overrides.task]
    objectives = read_objectives(read_run_keys(plain).objective)
    sources = [(str(source.provider), f"{source.schema}://{source.path}") for source in hydra.runtime.config_sources]
    composer = Composer(sources)
    if sweep and plain["backend"].get("name") != "simulation" and hydra.launcher._target_ != BASIC_LAUNCHER:
        raise UsageError("a rig runs one test at a time: leave hydra/launcher out, its default is the basic launcher")
    plan = make_plan(plain, hydra.runtime.choices.get("campaign"), lines, composer)
    folder = Path(os.path.relpath(hydra.runtime.output_dir)) if sweep else None
    # One line for a job of many; what a rig will do is always said before it moves.
    brief = sweep and bool(objectives) and plain["backend"].get("name") == "simulation"
    console, begun = make_console(), time.monotonic()
    varied = " ".join(line for line in lines if line not in SweepFolder.fixed)
    with console.status(f"job {hydra.job.num}  {varied}") if brief else nullcontext():
        made = make_run(plan, plain, lines, make_console(quiet=True) if brief else console, folder)
    if not objectives or made.report is None:
        return str(made.path)
    values = tuple(one.of(made.report.indicators) for one in objectives)
    said = [f"{one.text} = {value:.6g}" for one, value in zip(objectives, values, strict=True)]
    if brief:
        said = ["   ".join([f"job {hydra.job.num}", *said, varied, f"{time.monotonic() - begun:.1f} s", str(made.path)])]
    for line in said:
        console.print(line if brief else f"  objective  {line}", markup=False)
    return values if len(values) > 1 else values[0]
