"""Any command in Python: those that have no function of their own."""

from __future__ import annotations

import contextlib
import io
from pathlib import Path

from hjcamp.errors import HjcampError, UsageError, unknown


def command(*words: str | Path) -> str:
    """Run a command with its words as they would be typed, and return what it prints: `next`, `tune`, `budget`, `sizing` ...

    Raises what the command reports, ``UsageError`` for an unknown command or option. With ``--json -`` the answer is printed.

    >>> "stage" in hjcamp.command("plants")
    True
    >>> hjcamp.command("siezing")
    Traceback (most recent call last):
        ...
    hjcamp.errors.UsageError: unknown command 'siezing'; did you mean 'sizing'? ...
    """
    from hjcamp.commands import command_files, load
    from hjcamp.commands._session import free_standard_output

    files = command_files()
    name, *given = [str(word) for word in words] or [""]
    if name not in files:
        raise unknown("command", name, files)
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        try:
            load(files[name]).main(args=given, prog_name=f"hjcamp {name}", standalone_mode=False)
        except HjcampError:
            raise
        except Exception as error:
            # What is wrong with an option is an exception of click, whichever click typer brings.
            if not hasattr(error, "format_message"):
                raise
            raise UsageError(f"{error.format_message()}  (hjcamp {name} --help)") from None
        finally:
            free_standard_output()
    return out.getvalue()
