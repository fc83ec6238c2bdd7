"""What every answer in Python has: a frame, a picture, and how a notebook shows it."""

from __future__ import annotations

import html
import io
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

from hjcamp.errors import HjcampError, counted

if TYPE_CHECKING:
    import polars as pl
    from rich.console import Console

MOST_ROWS = 60
#: The columns of base parameters, as published or declared and as tests have them.
CALIBRATED = ("parameter", "published", "value", "unit", "low", "high")


class Picture(Figure):
    """A figure of matplotlib that a notebook shows without pyplot."""

    def _repr_png_(self) -> bytes:
        from hjcamp.report.pictures.conditions import own_settings

        buffer = io.BytesIO()
        with own_settings():
            self.savefig(buffer, format="png", dpi=110)
        return buffer.getvalue()


class Result:
    """An answer: ``frame`` (polars) is its table, ``answer`` what the command writes with ``--json``."""

    #: The answer for programs, by the keys of its schema.
    answer: Mapping[str, Any]

    @property
    def frame(self) -> pl.DataFrame:
        """The table of the answer."""
        raise NotImplementedError

    @property
    def title(self) -> str:
        """The answer in one line."""
        raise NotImplementedError

    def sentences(self) -> list[str]:
        """Return the answer in sentences, as the command prints them."""
        return []

    def to_pandas(self) -> Any:
        """Return ``frame`` as a DataFrame of pandas; ``HjcampError`` where pandas is not installed."""
        return to_pandas(self.frame)

    def plot(self) -> Figure:
        """Return the picture of the answer."""
        raise NotImplementedError

    def __repr__(self) -> str:
        return "\n".join([self.title, *self.sentences(), str(self.frame)])

    def _repr_html_(self) -> str:
        said = "".join(f"<li>{html.escape(line)}</li>" for line in self.sentences())
        bullets = f"<ul>{said}</ul>" if said else ""
        return f"<p><b>{html.escape(self.title)}</b></p>{bullets}{table_html(self.frame)}"


def to_pandas(frame: pl.DataFrame) -> Any:
    """Return a frame as a DataFrame of pandas; only pandas itself is needed for it."""
    try:
        import pandas
    except ImportError:
        raise HjcampError(
            "pandas is not installed: pip install pandas; .frame is the same table in polars, .frame.to_dicts() in plain Python"
        ) from None
    return pandas.DataFrame({name: frame[name].to_list() for name in frame.columns})


def frame_of(rows: Sequence[Mapping[str, Any]], columns: Sequence[str]) -> pl.DataFrame:
    """Return rows as a frame with these columns, also where there are none."""
    import polars as pl

    return pl.DataFrame(
        [{name: row.get(name) for name in columns} for row in rows], schema=list(columns), infer_schema_length=None
    )


def interval_row(row: Mapping[str, Any], **before: Any) -> dict[str, Any]:
    """Return a row of a parameter with its interval as ``low`` and ``high``."""
    low, high = row.get("ci95") or (None, None)
    first = {"published": row["published"]} if "published" in row else {}
    return before | first | {"value": row["value"], "unit": row["unit"], "low": low, "high": high}


def table_html(frame: pl.DataFrame) -> str:
    """Return a frame as a table of HTML; numbers with four digits, the first 60 rows."""
    head = "".join(f"<th>{html.escape(name)}</th>" for name in frame.columns)
    rows = "".join(
        "<tr>" + "".join(f"<td>{html.escape(_cell(value))}</td>" for value in row) + "</tr>"
        for row in frame.head(MOST_ROWS).rows()
    )
    more = f"<p>... and {counted(frame.height - MOST_ROWS, 'more row')}</p>" if frame.height > MOST_ROWS else ""
    return f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>{more}"


def _cell(value: object) -> str:
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)


def figure_of(draw: Callable[..., str], *given: Any) -> Picture:
    """Return the figure that a function of `hjcamp.report` draws as SVG."""
    from hjcamp.report.pictures.drawing import kept_figure

    return kept_figure(draw, *given, kind=Picture)


def quiet() -> Console:
    """Return a console that prints nothing: what a run says is in what it returns."""
    from rich.console import Console

    return Console(quiet=True)
