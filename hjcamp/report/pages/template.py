"""Pages from templates: one base for all, and a user's own file for the report, which shows values and runs nothing."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.errors import UsageError

if TYPE_CHECKING:
    from jinja2.sandbox import SandboxedEnvironment

HERE = Path(__file__).parent
STYLE = HERE / "page.css"
#: What a page may load: itself. A browser holds it to that.
NOTHING_FETCHED = (
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
    "script-src 'unsafe-inline'; img-src data:\">"
)


@lru_cache(maxsize=1)
def _environment() -> SandboxedEnvironment:
    """Return our templates; every value is escaped but what is marked as HTML, and a name that is not there is an error."""
    from jinja2 import FileSystemLoader, StrictUndefined
    from jinja2.sandbox import ImmutableSandboxedEnvironment

    return ImmutableSandboxedEnvironment(
        loader=FileSystemLoader(HERE / "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )


def html(text: str) -> Any:
    """Mark a text as HTML that is made and escaped already."""
    from markupsafe import Markup

    return Markup(text)


def page_of(title: str, content: str, **more: Any) -> str:
    """Return a page of HTML that is made already: ``content`` is its body; ``more`` are ``style``, ``policy``, ``kind`` (a class
    of the body) and ``head``.
    """
    return "".join(pieces_of("base.html", title, content=html(content), **more))


def pieces_of(
    name: str,
    title: str,
    own: Path | None = None,
    style: str = "",
    policy: str = NOTHING_FETCHED,
    head: str = "",
    **values: Any,
) -> Iterator[str]:
    """Yield a page piece by piece, as its values are asked for; ``own`` is a user's template, which may extend ``name``.

    Raises ``UsageError`` with file and line for a template that cannot be read or filled in.
    """
    dress = html(STYLE.read_text(encoding="utf-8") + style)
    shown = {"title": title, "policy": html(policy), "style": dress, "head": html(head), "kind": "", **values}
    if own is None:
        return _environment().get_template(name).generate(shown)
    return _own(own, shown)


def _own(path: Path, values: dict[str, Any]) -> Iterator[str]:
    from jinja2 import TemplateError

    try:
        yield from _environment().from_string(path.read_text(encoding="utf-8")).generate(values)
    except (OSError, UnicodeDecodeError) as error:
        raise UsageError(f"the template {path} cannot be read: {getattr(error, 'strerror', None) or error}") from error
    except (TemplateError, ArithmeticError, LookupError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise UsageError(f"the template {path}{_line(error)}: {str(error) or type(error).__name__}") from error


def _line(error: BaseException) -> str:
    """Return the line of the user's template at which it went wrong: of a frame, or of a fault of syntax."""
    number = getattr(error, "lineno", None)
    trace = error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code.co_filename in ("<template>", "<unknown>"):
            number = trace.tb_lineno
        trace = trace.tb_next
    return f", line {number}" if number else ""
