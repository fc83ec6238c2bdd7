"""Check this installation: versions, folders, caches, the rig's driver; exit code 1 where something is broken."""

from __future__ import annotations

import os
import platform
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hjcamp.commands.shared.session import AnswerFile, check_answer_file, write_answer
from hjcamp.errors import HjcampError, UsageError
from hjcamp.storage import user_folder

if TYPE_CHECKING:
    from rich.console import Console

SCHEMA = "hjcamp.doctor/1"
Finding = tuple[str, str, str]  # state (good, note, broken), subject, text


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("doctor")(doctor)


def doctor(
    warm: Annotated[bool, typer.Option("--warm", help="Compile the kernels that runs and diagnoses need.")] = False,
    detach: Annotated[bool, typer.Option("--detach", help="With --warm: in the background, and return at once.")] = False,
    json: AnswerFile = None,
) -> None:
    """Check this installation: versions, folders, caches, the rig's driver; exit code 1 where something is broken."""
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.commands.shared.wrapped import print_wrapped

    check_answer_file(json)
    console = make_console()
    if detach and not warm:
        raise UsageError("--detach goes with --warm")
    if detach:
        from hjcamp.commands.shared.warm import start

        print_wrapped(console, [start()], 2)
        write_answer(json, {"schema": SCHEMA, "findings": [], "broken": 0, "compiled": []})
        return
    if warm:
        compiled = [{"kernel": what, "seconds": seconds} for what, seconds in compile_kernels(console)]
        write_answer(json, {"schema": SCHEMA, "findings": [], "broken": 0, "compiled": compiled})
        return
    marks = {"good": ("ok", "green"), "note": ("note", "yellow"), "broken": ("BROKEN", "red")}
    told, broken = [], 0
    for check in (versions, configuration, folders, kernel_cache, driver):
        for state, subject, text in findings(check):
            broken += state == "broken"
            told.append({"state": state, "subject": subject, "text": text})
            mark, style = marks[state]
            console.print(f"{mark:<6}", style=style, end="")
            console.print(f" {subject:<14}{text}")
    write_answer(json, {"schema": SCHEMA, "findings": told, "broken": broken, "compiled": []})
    if broken:
        raise HjcampError(f"{broken} thing{'s are' if broken > 1 else ' is'} broken")


def compile_kernels(console: Console) -> Iterator[tuple[str, float]]:
    """Compile what is not compiled yet, saying what (and yielding it); nothing is written but the cache of kernels."""
    from hjcamp.commands.shared.warm import alone
    from hjcamp.known_plants import usual_plant

    with alone():
        for subject, seconds in usual_plant().own_room("kernels").warm():
            console.print(f"  {seconds:5.1f} s  {subject}", markup=False)
            yield subject, seconds


def findings(check: Callable[[], Iterator[Finding]]) -> Iterator[Finding]:
    """Yield what a check finds; a check that fails is a finding."""
    try:
        yield from check()
    except Exception as error:
        yield "broken", check.__name__.replace("_", " "), f"{type(error).__name__}: {error}"


def versions() -> Iterator[Finding]:
    """Program, Python and packages."""
    from hjcamp.campaign.files.provenance import provenance

    facts = provenance()
    commit = f", commit {facts['git'][:12]}" if facts["git"] else ""
    changes = " with changes" if facts["git_changes_sha256"] else ""
    yield (
        "good",
        "hjcamp",
        f"{facts['version']}{commit}{changes}, Python {platform.python_version()}, {facts['system']}",
    )
    missing = [name for name, version in facts["packages"].items() if version is None]
    known = ", ".join(f"{name} {version}" for name, version in facts["packages"].items() if version)
    yield ("broken" if missing else "good"), "packages", known + (f"; missing: {', '.join(missing)}" if missing else "")


def configuration() -> Iterator[Finding]:
    """Where configuration comes from, and whether it composes."""
    from hjcamp.configuration.composer import Composer
    from hjcamp.configuration.search_path import configuration_folders
    from hjcamp.model.files.user_folders import ENVIRONMENT_VARIABLE

    for name in filter(None, os.environ.get(ENVIRONMENT_VARIABLE, "").split(os.pathsep)):
        if not Path(os.path.expanduser(name)).is_dir():
            yield "broken", "configuration", f"{ENVIRONMENT_VARIABLE} names {name}, which is no folder"
    composer = Composer()
    composer.compose([])
    for place in composer.places():
        yield "good", "configuration", place
    for folder in configuration_folders():
        if (folder / "config.yaml").is_file():
            yield "note", "configuration", f"{folder / 'config.yaml'} replaces the program's own config.yaml"
    yield "good", "campaigns", " ".join(composer.options("campaign"))


def folders() -> Iterator[Finding]:
    """Whether runs, the user's cache and the temporary folder can be written."""
    for subject, folder, state in (
        ("runs", Path("runs"), "broken"),
        ("cache", user_folder("XDG_CACHE_HOME", ".cache"), "note"),
        ("home", user_folder("HOME"), "note"),
        ("temporary", Path(tempfile.gettempdir()), "broken"),
    ):
        if folder is None:
            yield (
                "note",
                subject,
                f"this user has no home folder: kernels go where HJCAMP_CACHE or {tempfile.gettempdir()} is",
            )
            continue
        existing = next(parent for parent in (folder.absolute(), *folder.absolute().parents) if parent.exists())
        writable = os.access(existing, os.W_OK)
        text = str(folder) if writable else f"{folder} cannot be written; runs can go elsewhere with run_dir=DIR"
        yield ("good" if writable else state), subject, text


def kernel_cache() -> Iterator[Finding]:
    """Whether compiled kernels are kept from call to call."""
    from hjcamp.model.compile.kernel_cache import TEMPORARY, cache_folder

    if os.environ.get("NUMBA_DISABLE_JIT") == "1":
        yield "note", "kernels", "NUMBA_DISABLE_JIT=1: nothing is compiled, simulations are slow"
        return
    folder = cache_folder()
    if folder.parent.name.startswith(TEMPORARY):
        yield "note", "kernels", "the cache folder cannot be written: kernels are compiled again in every call"
    else:
        yield "good", "kernels", f"{len(list(folder.glob('*.py')))} compiled kernels are kept in {folder}"


def driver() -> Iterator[Finding]:
    """Whether the NI-DAQmx driver of a real rig is there."""
    from nidaqmx.errors import DaqNotFoundError
    from nidaqmx.system import System

    try:
        version = System.local().driver_version
        yield "good", "nidaqmx", f"driver {version.major_version}.{version.minor_version}"
    except DaqNotFoundError:
        yield "note", "nidaqmx", "no driver: only backend=simulation and the virtual rig work here"
