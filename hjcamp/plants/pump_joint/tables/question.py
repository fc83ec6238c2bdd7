"""What is asked of a table: its cells, the tests behind them, and the tables that are held out."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hjcamp.campaign.plan.planning import make_plan
from hjcamp.configuration.composer import Composer
from hjcamp.errors import UsageError, unknown
from hjcamp.plants.pump_joint.tables.cells import Cells
from hjcamp.plants.pump_joint.tables.printed import CAMPAIGNS, campaigns_of, check_names, printed_cells
from hjcamp.plants.pump_joint.tables.table_file import DEVIATION, TESTS, matching, read_table
from hjcamp.records.plan import Condition
from hjcamp.report.runs.indicators import CHOICES, INDICATORS

#: Fewer cells, or fewer conditions, do not hold the base parameters, let alone more.
FEWEST_CELLS, FEWEST_CONDITIONS = 8, 3


@dataclass(frozen=True)
class Question:
    """Cells with the planned condition of each of their rows; ``overrides`` are the words of the call for every test."""

    tables: tuple[str, ...]
    cells: Cells
    conditions: tuple[Condition, ...]
    overrides: tuple[str, ...]

    @property
    def lacking(self) -> list[str]:
        """Why nothing can be identified from these cells, in words; empty where something can."""
        found = []
        if len(self.cells) < FEWEST_CELLS:
            found.append(f"{_count(len(self.cells), 'mean')}; {FEWEST_CELLS} at least are needed to hold the base parameters")
        if len(self.conditions) < FEWEST_CONDITIONS:
            found.append(f"{_count(len(self.conditions), 'condition')}; {FEWEST_CONDITIONS} at least are needed")
        return found

    @property
    def sha256(self) -> str:
        """The hash of the numbers and of the configurations behind them."""
        parts: list[Any] = [self.cells.means.tolist(), self.cells.error_of_mean.tolist(), self.cells.rows.tolist()]
        parts += [self.cells.columns.tolist(), [one.sha256 for one in self.conditions]]
        return hashlib.sha256(repr(parts).encode()).hexdigest()


def asked(words: Sequence[str]) -> Question:
    """Return the question of the words after ``--tables``: tables by number, or files, and overrides such as campaign=NAME."""
    overrides = tuple(word for word in words if "=" in word)
    names = [word for word in words if "=" not in word]
    if not names:
        raise UsageError("--tables: name a table, such as 5.4.1, or a CSV file")
    files = [name for name in names if name.endswith(".csv") or Path(name).exists()]
    if not files:
        check_names(names)
        if any(word.startswith("campaign=") for word in overrides):
            raise UsageError("campaign=: printed tables have campaigns of their own; it belongs to a CSV file")
        return _planned(tuple(names), printed_cells(names), campaigns_of(names), overrides)
    if len(names) > 1:
        raise UsageError(f"--tables {' '.join(names)}: give one file, or tables by number")
    cells = read_table(Path(files[0]))
    campaigns = [word.removeprefix("campaign=") for word in overrides if word.startswith("campaign=")]
    return _planned((files[0],), cells, campaigns, overrides)


def held_out(question: Question, asked_for: Sequence[str] | None = None) -> Question | None:
    """Return the tables that were not used: those of ``asked_for``, else every printed one next to printed ones, else none."""
    if asked_for:
        numbers = all(name in CAMPAIGNS for name in asked_for)
        words = [word for word in question.overrides if not (numbers and word.startswith("campaign="))]
        found = asked([*asked_for, *words])
        if set(found.tables) & set(question.tables):
            raise UsageError(f"--held-out {' '.join(asked_for)}: a table that is fitted cannot be held out")
        return found
    if not set(question.tables) <= set(CAMPAIGNS):
        return None
    names = [name for name in CAMPAIGNS if name not in question.tables]
    return asked([*names, *question.overrides]) if names else None


def _planned(tables: tuple[str, ...], cells: Cells, campaigns: Sequence[str], overrides: tuple[str, ...]) -> Question:
    composer = Composer()
    rest = [word for word in overrides if not word.startswith("campaign=")]
    planned: list[Condition] = []
    for name in campaigns:
        planned += _conditions([f"campaign={name}", *rest], composer)
    where = f"table {', '.join(tables)}"
    if not campaigns:
        for place in cells.conditions:
            planned += _composed(place, rest, composer, where)
    rows = tuple(matching(place, planned, where) for place in cells.conditions)
    if any(one.config.get("plant") for one in rows):
        raise UsageError(f"{where}: only tables of plant pump_joint can be diagnosed")
    if any(one.config["backend"]["name"] != "simulation" for one in rows):
        raise UsageError(f"{where}: a table is compared with the simulator; leave backend= out")
    return Question(tables, cells, rows, overrides)


def _composed(place: Mapping[str, str], rest: Sequence[str], composer: Composer, where: str) -> tuple[Condition, ...]:
    """Return the condition of a row without a campaign; a column that names no choice and no parameter is refused."""
    for key in place:
        if "." not in key and not composer.is_group(key):
            deviations = [f"{one}{DEVIATION}" for one in INDICATORS]
            raise unknown("column", key, [*INDICATORS, *deviations, TESTS, *CHOICES, "or a parameter"], where)
    try:
        return _conditions([*rest, *(f"{key}={value}" for key, value in place.items())], composer)
    except UsageError as problem:
        raise UsageError(f"{where}, condition {' '.join(place.values())}: {problem}") from None


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'s' * (number != 1)}"


def _conditions(lines: Sequence[str], composer: Composer) -> tuple[Condition, ...]:
    found = composer.compose(lines)
    return make_plan(found.config, found.choices.get("campaign"), lines, composer).conditions
