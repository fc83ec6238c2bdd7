"""Run a campaign: every condition, every repetition, then tables and report. All of Hydra's command line.

hjcamp run campaign=NAME [GROUP=CHOICE ...] [PARAMETER=VALUE ...] [-m] [--cfg job] [--config-dir DIR]
           [--keep-going | --fail-fast] [--yes] [--live [PORT]] [--no-browser]
hjcamp run --like LOG [run_dir=DIR] [workers=N]: the tests of that log's condition again, by the configuration in it
"""

from __future__ import annotations

import logging
import os
import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

from hjcamp.commands.shared.complete import complete_override
from hjcamp.errors import HjcampError, UsageError

SEARCH_PATH = "hydra.searchpath"
# The keys may be absent from a user's own configuration, so they are set or added.
SWITCHES = {"--keep-going": "keep_going=true", "--fail-fast": "fail_fast=true"}
# With these Hydra would begin with a configuration, or a pickled job, from anywhere.
YES = "--yes"
LIKE = "--like"
# What a call with it may say besides: all else is in the log.
OF_THE_CALL = ("run_dir", "workers", "cluster", "fail_fast", "keep_going")
#: Jobs of a sweep that begin without a question; what takes hours is asked before.
UNASKED_JOBS = 1000
NOT_OURS = ("config-path", "config-name", "experimental-rerun")
PASS_EVERYTHING = {"ignore_unknown_options": True, "allow_extra_args": True, "help_option_names": []}


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("run", context_settings=PASS_EVERYTHING, add_help_option=False)(run)


def run(
    arguments: Annotated[list[str] | None, typer.Argument(metavar="OVERRIDES", autocompletion=complete_override)] = None,
) -> None:
    """Run a campaign: every condition, every repetition, then tables and report. All of Hydra's command line."""
    if arguments and arguments[0] in ("--help", "-h"):
        arguments = ["--help"]
    from hjcamp.commands.shared.live import live, take_live

    left, asked = take_live(arguments or [])
    log, left = take_like(left)
    with live(asked):
        if log is not None:
            run_like(log, [SWITCHES.get(word, word) for word in left])
            return
        call_hydra([SWITCHES.get(word, word) for word in left if word != YES], YES in left)


def take_like(arguments: list[str]) -> tuple[Path | None, list[str]]:
    """Return the log that a run is to be like, None where none is named, and the other arguments."""
    for place, word in enumerate(arguments):
        name, equals, value = word.partition("=")
        if name == LIKE:
            rest = arguments[place + 1 :]
            if not equals and not rest:
                raise UsageError(f"{LIKE}: give the log whose test is to be made again")
            return Path(value if equals else rest[0]), [*arguments[:place], *(rest if equals else rest[1:])]
    return None, arguments


def run_like(path: Path, lines: list[str]) -> None:
    """Make the tests of a log's condition again; ``lines`` say where and on how many processes, and nothing of the test."""
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.campaign.one_run import make_run
    from hjcamp.campaign.plan.like import plan_like
    from hjcamp.configuration.composer import Composer, free
    from hjcamp.records.read import read_log

    for line in lines:
        if line.partition("=")[0] not in OF_THE_CALL:
            raise UsageError(
                f"{LIKE} {path}: '{line}' is no part of it: the log says all of the test; allowed: {', '.join(OF_THE_CALL)}"
            )
    asked = Composer().compose([free(line) for line in lines]).config
    make_run(plan_like(read_log(path), path), asked, [f"{LIKE}={path}", *lines], make_console())


def call_hydra(arguments: list[str], yes: bool = False) -> None:
    """Give the arguments to Hydra, flags before overrides, and raise what its job or Hydra itself reports."""
    # With it Hydra raises what goes wrong instead of printing it and exiting.
    os.environ["HYDRA_FULL_ERROR"] = "1"
    import hydra
    from hydra._internal.utils import get_args_parser

    from hjcamp.campaign import job as jobs
    from hjcamp.campaign.plan.sweep import read_sweep
    from hjcamp.configuration.composer import COMPOSE_ERRORS, Composer, free
    from hjcamp.configuration.explain import explain
    from hjcamp.configuration.fitted import fitted
    from hjcamp.configuration.overrides import key_of, parse_overrides
    from hjcamp.configuration.search_path import packaged_root
    from hjcamp.configuration.trust import check_overrides

    parser = get_args_parser()
    parser.prog = "hjcamp run"
    parser.error = refuse  # type: ignore[method-assign, assignment]
    parsed = parser.parse_intermixed_args(arguments)
    for flag in NOT_OURS:
        if getattr(parsed, flag.replace("-", "_"), None):
            raise UsageError(f"--{flag} is not taken: the main configuration is part of the program; see --config-dir")
    overrides = [free(line) for line in parsed.overrides]
    flags = without(arguments, parsed.overrides)
    fixed: list[str] = []
    folder = Path(parsed.config_dir) if parsed.config_dir else None
    if not (parsed.help or parsed.hydra_help or parsed.shell_completion):
        lines = parse_overrides(overrides)
        check_overrides(overrides, parse_overrides)
        # Of what belongs to Hydra only a further folder changes which files are read.
        own = [line for line in lines if not line.is_hydra_override() or line.key_or_group == SEARCH_PATH]
        if parsed.multirun:
            confirm(read_sweep(lines, Composer(folder=folder)).count, yes)
            fixed = [key_of(line) for line in own if not line.is_sweep_override()]
        else:
            # Hydra reads the same files: what it would stumble over is said here.
            Composer(folder=folder).compose([str(line.input_line) for line in own])
        overrides = fitted(overrides, Composer(folder=folder))
    # They would say each job's overrides in a line with the time; `job` says what it found.
    for name in ("hydra", "hydra_plugins"):
        logging.getLogger(name).setLevel(logging.WARNING)
    jobs.JobEnd.error = None
    jobs.SweepFolder.path = None
    before = sys.argv
    sys.argv = ["hjcamp run", *flags, *overrides]
    try:
        hydra.main(version_base="1.3", config_path=str(packaged_root() / "conf"), config_name="config")(jobs.job)()
    except HjcampError:
        raise
    except COMPOSE_ERRORS as error:
        raise explain(error, overrides, Composer(folder=folder)) from error
    finally:
        sys.argv = before
        discard_empty(jobs.SweepFolder.path)
    if jobs.JobEnd.error is not None:
        raise jobs.JobEnd.error
    if jobs.SweepFolder.path is not None:
        tell_of_sweep(jobs.SweepFolder.path, jobs.SweepFolder.directions, fixed)


def confirm(jobs: int | None, yes: bool) -> None:
    """Ask before a sweep of so many jobs that nobody meant it; raise ``UsageError`` where nobody can answer or says no."""
    if yes or jobs is None or jobs <= UNASKED_JOBS:
        return
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        raise UsageError(f"{jobs} jobs: {YES} begins a sweep of more than {UNASKED_JOBS}, or give fewer values")
    if not typer.confirm(f"{jobs} jobs. Begin?"):
        raise UsageError(f"nothing was run: {jobs} jobs were not confirmed")


def tell_of_sweep(folder: Path, directions: tuple[str, ...], fixed: list[str]) -> None:
    """Print where the runs of a sweep are, the best of them, and what to do next."""
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.campaign.plan.sweep_results import SHOWN, read_results

    console = make_console()
    place = Path(os.path.relpath(folder))
    console.print(f"the runs of the sweep are in {place}", markup=False)
    found = read_results(place, directions, fixed)
    if found is None:
        listed = f"hjcamp ls --folder {shlex.quote(str(place))} --columns +rmse1_deg --sort rmse1_deg"
        console.print(f"next    {listed}", markup=False)
        return
    for job in found.best[:SHOWN]:
        values = ", ".join(f"{one.text} {value:.4g}" for one, value in zip(found.objectives, job.values, strict=True))
        keys = " ".join(f"{key}={job.overrides.get(key, '')}" for key in found.varied)
        console.print(f"best    {job.path}   {values}   {keys}", markup=False)
    console.print(f"table   {found.write()}", markup=False)
    console.print(f"next    {found.next_command()}", markup=False)


def refuse(message: str) -> None:
    """Report a flag that Hydra does not know."""
    raise UsageError(f"{message}  (flags: hjcamp run --hydra-help)")


def without(arguments: list[str], overrides: list[str]) -> list[str]:
    """Return the arguments that are no overrides, in order."""
    left = list(overrides)
    flags = []
    for word in arguments:
        if word in left:
            left.remove(word)
        else:
            flags.append(word)
    return flags


def discard_empty(folder: Path | None) -> None:
    """Remove what Hydra made for a sweep of which no job came to a run."""
    if folder is None or not folder.is_dir() or any(folder.glob("*/plan.json")):
        return
    try:
        for child in folder.iterdir():
            if child.is_dir():
                child.rmdir()
            elif child.name == "multirun.yaml":
                child.unlink()
        folder.rmdir()
        folder.parent.rmdir()
    except OSError:
        # Something of the user's is in there: it stays.
        return
