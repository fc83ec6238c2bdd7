"""The command line: finds the commands in ``hjcamp/commands/``, and turns every error into one message."""

from __future__ import annotations

import contextlib
import errno
import logging
import os
import shutil
import signal
import sys
import tempfile
import textwrap
import traceback
from pathlib import Path
from types import FrameType
from typing import Annotated, Any

import typer

from hjcamp import __version__
from hjcamp.children import keep_children_safe
from hjcamp.commands import COMPLETING, PLAIN, Commands
from hjcamp.commands.shared.page_end import CALL
from hjcamp.commands.shared.session import free_standard_output
from hjcamp.commands.shared.streams import begin_in_utf8, take_streams
from hjcamp.errors import HjcampError, text_of, visible
from hjcamp.memory import guard_memory, memory_is_short
from hjcamp.storage import shown_path

INTERRUPTED = 130


def show_version(asked: bool) -> None:
    """Print the version and end."""
    if asked:
        print(f"hjcamp {__version__}")
        raise typer.Exit


app = typer.Typer(
    **PLAIN,
    cls=Commands,
    help="Find what the model of a machine leaves out, from a file of its equations and two recordings of it.",
    epilog="\b\nFirst  hjcamp tour --plant\nthen   hjcamp plan campaign=robustness_vertical",
)


@app.callback()
def root(
    version: Annotated[bool, typer.Option("--version", callback=show_version, is_eager=True, help="Show the version.")] = False,
) -> None:
    """Find what the model of a machine leaves out, from a file of its equations and two recordings of it."""


def main() -> None:
    """Run the command line and exit with its code."""
    begin_in_utf8()
    take_streams()
    # where home cannot be written it draws as well, and says so at length
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    signal.signal(signal.SIGTERM, _terminated)
    keep_children_safe()
    guard_memory()
    try:
        code = answer_bash() if os.environ.get(COMPLETING) == "complete_bash" else run()
    except KeyboardInterrupt:  # once more, while the first was being answered
        code = INTERRUPTED
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        sys.stdout.flush()
    except (BrokenPipeError, ValueError):
        _close_stdout()
    sys.exit(code)


def answer_bash() -> int:
    """Answer bash's request for completions; returns the exit code."""
    from hjcamp.commands.shared.complete_bash import complete_for_bash

    return complete_for_bash(run)


def run(arguments: list[str] | None = None) -> int:
    """Return the exit code of one call: 0 done, 1 failed, 2 unusable call, 3 rig made safe, 130 interrupted."""
    given = sys.argv[1:] if arguments is None else arguments
    token = CALL.set(tuple(given))
    try:
        answer: Any = app(args=given or ["--help"], prog_name="hjcamp", standalone_mode=False)
        code = answer if isinstance(answer, int) and not isinstance(answer, bool) else 0
        # typer makes Ctrl-C this number, without a word
        return _say("interrupted", INTERRUPTED) if code == INTERRUPTED else code
    except HjcampError as error:
        return _say(str(error), error.exit_code)
    except (KeyboardInterrupt, typer.Abort):
        return _say("interrupted", INTERRUPTED)
    except SystemExit as error:
        return error.code if isinstance(error.code, int) else int(error.code is not None)
    except BrokenPipeError:
        _close_stdout()
        return 0
    except MemoryError as error:
        return _say(f"not enough memory: {error}" if str(error) else "not enough memory", 1)
    except OSError as error:
        if error.errno == errno.ENAMETOOLONG:
            return _say(f"{shown_path(Path(str(error.filename)))}: the name is too long for a file", 2)
        place = f": {error.filename}" if error.filename else ""
        return _say(f"{error.strerror or error}{place}", 1)
    except Exception as error:
        if type(error).__module__.startswith(("click", "typer._click")) and hasattr(error, "format_message"):
            return _say(_unusable(error), 2)
        if _comes_from_interrupt(error):
            return _say("interrupted", INTERRUPTED)
        what = "not enough memory" if memory_is_short() else "internal error"
        return _say(f"{what}: {type(error).__name__}: {text_of(error)}{_keep_traceback()}", 1)
    finally:
        CALL.reset(token)
        free_standard_output()


def _unusable(error: Any) -> str:
    """Return in one line what the command line cannot use; a group without a command names those it has."""
    context: Any = getattr(error, "ctx", None)
    command, text = getattr(context, "command_path", "hjcamp"), error.format_message()
    if type(error).__name__ == "NoArgsIsHelpError":
        text = f"{command.removeprefix('hjcamp ')}: give one of {', '.join(context.command.list_commands(context))}"
    return f"{text}  (see {command} --help)"


def _comes_from_interrupt(error: BaseException | None) -> bool:
    """Return whether Ctrl-C was the reason: a library that is being loaded says something else instead."""
    seen: set[int] = set()
    while error is not None and id(error) not in seen:
        if isinstance(error, KeyboardInterrupt):
            return True
        seen.add(id(error))
        error = error.__cause__ or error.__context__
    return False


def _say(text: str, code: int) -> int:
    with contextlib.suppress(OSError):
        print(_between_words(f"hjcamp: {visible(text)}"), file=sys.stderr)
    return code


def _between_words(text: str) -> str:
    """Return a message as it is read best: on a terminal no word of it is cut at the last column."""
    if not sys.stderr.isatty():
        return text
    room = max(shutil.get_terminal_size().columns - 1, 20)
    lines = text.splitlines() or [text]
    parts = [textwrap.wrap(line, room, break_long_words=False, break_on_hyphens=False) or [""] for line in lines]
    return "\n".join(part for wrapped in parts for part in wrapped)


def _keep_traceback() -> str:
    try:
        with tempfile.NamedTemporaryFile("w", prefix="hjcamp-error-", suffix=".log", delete=False) as stream:
            traceback.print_exc(file=stream)
        return f"; details in {stream.name}"
    except OSError:
        return ""


def _close_stdout() -> None:
    free_standard_output()
    # Python flushes stdout once more at exit; a closed pipe would print an error there.
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _terminated(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt
