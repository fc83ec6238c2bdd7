"""Times that are written out, as loggers and people of several countries write them, as seconds since the first."""

from __future__ import annotations

import re
from collections.abc import Iterable
from datetime import date
from typing import TYPE_CHECKING

import numpy as np

from hjcamp.errors import UsageError

if TYPE_CHECKING:
    import polars

DAY, HOUR = 86_400 * 10**9, 3600 * 10**9  # ns
# What is around a time: a date before or behind it, half of the day, zone. A colon or a comma may stand before the fraction.
TIME = (
    r"^(?P<before>.*?)(?P<first>\d{1,5}):(?P<second>\d{1,2})(?::(?P<third>\d{1,2}))?(?:(?P<mark>[.,:])(?P<part>\d{1,12}))?"
    r"\s*(?P<half>[AaPp]\.?[Mm]\.?)?\s*(?P<zone>[+-]\d{2}:?\d{2})?(?P<after>[^:]*)$"
)
ORDERS = ("dmy", "mdy")  # of what stands as 3/4/2026: of those that can be read the shortest test
MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
MONTH_OF = {name: number for number, name in enumerate(MONTHS, 1)} | {
    "mär": 3,
    "mae": 3,
    "mrz": 3,
    "mai": 5,
    "okt": 10,
    "dez": 12,
}
OTHER_WORDS = {
    "t",
    "z",
    "utc",
    "gmt",
    "mon",
    "tue",
    "wed",
    "thu",
    "fri",
    "sat",
    "sun",
    "mo",
    "di",
    "mi",
    "do",
    "fr",
    "sa",
    "so",
}
WORD = re.compile(r"\d+|[^\W\d_]+")
MOST_DATES = 1000
MOST_DAYS = 36_500
COLON_DIGITS = (3, 6, 9)


def seconds_of(column: polars.Series, where: str) -> np.ndarray | None:
    """Return a column of texts (rows,) as seconds since the first; None where they are no times.

    A time without a date goes on behind midnight, and one of minutes and seconds behind the hour. Raises UsageError where
    one of many is no time, or can be read in two ways.
    """
    import polars

    parts = column.str.extract_groups(TIME).struct.unnest()
    strange = parts["first"].is_null()
    if 2 * strange.sum() >= len(column):
        return None
    if strange.any():
        row = int(strange.arg_max() or 0)
        raise UsageError(f"{where} is no time in row {row + 1}: {column[row] or ''!r:.60}")
    number = {name: parts[name].cast(polars.Int64).fill_null(0).to_numpy() for name in ("first", "second", "third")}
    short = parts["third"].null_count()
    around = parts.select("before", "after", "zone").fill_null("").with_columns(polars.all().str.strip_chars())
    keys = around.unique(maintain_order=True).rows()
    if short not in (0, len(column)) or len(keys) > MOST_DATES:
        return None
    dated = any(before or after for before, after, _ in keys)
    marks = parts["mark"].unique().to_list()
    lengths = parts["part"].str.len_chars().unique().to_list()
    if ":" in marks and (short or len(marks) > 1 or len(lengths) > 1 or lengths[0] not in COLON_DIGITS):
        raise UsageError(
            f"{where}: {column[0]!r:.60} can be read in several ways: write the fraction of a second behind a point"
        )
    if short and not dated and marks == [None]:
        raise UsageError(
            f"{where}: {column[0]!r:.60} may be hours and minutes, or minutes and seconds: write seconds as well, or give period_s"
        )
    minutes = bool(short) and not dated
    hours, minute, second = (
        (np.zeros(len(column), np.int64), number["first"], number["second"])
        if minutes
        else (_of_the_day(number["first"], parts["half"]), number["second"], number["third"])
    )
    fraction = parts["part"].fill_null("0").str.slice(0, 9).str.pad_end(9, "0").cast(polars.Int64).to_numpy()
    ticks = hours * HOUR + (60 * minute + second) * 10**9 + fraction
    if not dated:
        turn = HOUR if minutes else DAY
        return _since_first(_going_on(ticks, turn) if ticks.max() < turn else ticks)
    place = {key: index for index, key in enumerate(keys)}
    rows = np.array([place[key] for key in around.rows()]) if len(keys) > 1 else np.zeros(len(column), np.intp)
    found = [_since_first(ticks + np.array(days)[rows]) for order in ORDERS if (days := _ns_of_days(keys, order)) is not None]
    going = [one for one in found if (np.diff(one) > 0.0).all()] or found[:1]
    return min(going, key=lambda one: one[-1], default=None)


def time_of_day(ticks: np.ndarray) -> np.ndarray:
    """Return times of the day in ns, of shape (rows,), as seconds since the first, also behind midnight."""
    return _since_first(_going_on(ticks, DAY))


def _going_on(ticks: np.ndarray, turn: int) -> np.ndarray:
    """Return a clock that begins again after ``turn`` as one that goes on."""
    return np.asarray(ticks + turn * np.cumsum(np.diff(ticks, prepend=ticks[:1]) < -turn // 2))


def _since_first(ticks: np.ndarray) -> np.ndarray:
    return np.asarray((ticks - ticks[0]) * 1e-9)


def _of_the_day(hours: np.ndarray, half: polars.Series) -> np.ndarray:
    if half.null_count():
        return hours
    later = half.str.to_lowercase().str.starts_with("p").to_numpy()
    return np.asarray(hours % 12 + 12 * later)


def _ns_of_days(keys: Iterable[tuple[str, str, str]], order: str) -> list[int] | None:
    """Return where the day of each date begins, ns; None where one cannot be read in this order."""
    found = []
    for before, after, zone in keys:
        days = _day(f"{before} {after}", order)
        if days is None:
            return None
        digits = zone.replace(":", "")
        ahead = (int(digits[1:3]) * 60 + int(digits[3:5])) * 60 * 10**9 if digits else 0
        found.append(days * DAY - (ahead if not zone.startswith("-") else -ahead))
    return [one - found[0] for one in found] if max(found) - min(found) < MOST_DAYS * DAY else None


def _day(text: str, order: str) -> int | None:
    """Return the number of a day of a date; None where the text is none."""
    words = [word.casefold() for word in WORD.findall(text)]
    numbers = [word for word in words if word.isdigit()]
    names = [word for word in words if not word.isdigit() and word not in OTHER_WORDS and word[:3] not in OTHER_WORDS]
    if len(numbers) == 1 and names in (["days"], ["day"]):
        return int(numbers[0])
    months = [MONTH_OF[word[:3]] for word in names if word[:3] in MONTH_OF]
    if len(months) != len(names) or len(months) > 1:
        return None
    if not months and len(numbers) == 1 and len(numbers[0]) == 8:
        numbers = [numbers[0][:4], numbers[0][4:6], numbers[0][6:]]
    first_is_year = bool(numbers) and len(numbers[0]) == 4
    if months:
        # without a year it is any, and without a day the date is none
        day_and_year = {1: [*numbers, "2000"], 2: numbers[::-1] if first_is_year else numbers}.get(len(numbers), [])
        parts = [*day_and_year[1:], str(months[0]), *day_and_year[:1]]
    elif len(numbers) == 3:
        day, month = (2, 1) if first_is_year else (order.index("d"), order.index("m"))
        parts = [numbers[0 if first_is_year else 2], numbers[month], numbers[day]]
    else:
        parts = []
    try:
        year_, month_, day_ = map(int, parts)
        return date(year_ + (2000 if year_ < 100 else 0), month_, day_).toordinal()
    except ValueError:
        return None
