"""Make the report of a run: indicators, tables, figures and the page, from the logs alone."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import polars as pl

from hjcamp.errors import UsageError, counted, unknown
from hjcamp.report.against_run import RunComparison, read_tests, tests_of
from hjcamp.report.ci import metrics_json, params_yaml
from hjcamp.report.pages.exploration import REFERENCE, Exploration, names_of
from hjcamp.report.pages.explorer import explorer_html
from hjcamp.report.pages.page import Picture, build_page
from hjcamp.report.pictures.conditions import draw_condition
from hjcamp.report.pictures.dot_plot import Dots, dots_of, draw_dots
from hjcamp.report.pictures.main_effects import CAPTION, draw_main_effects
from hjcamp.report.runs.indicators import COLUMNS, FURTHER, IDENTITY, INDICATORS, configuration, row_of, varied_columns
from hjcamp.report.runs.origin import RunOrigin, origin_facts, read_origin, states_of_tests
from hjcamp.report.runs.published import beside_refit
from hjcamp.report.runs.spread import Condition, Gathering
from hjcamp.report.runs.varied import frame_with_varied
from hjcamp.report.tables.aggregation import (
    FAR_OFF,
    against_published,
    build_table,
    by_condition,
    differences,
    lines_by_condition,
)
from hjcamp.report.tables.declared import TableDefinition, declared_tables
from hjcamp.report.tables.factors import Factor, effects_of, effects_sheet, factors_of, samples_of
from hjcamp.report.tables.formats import to_latex, to_markdown
from hjcamp.report.tables.sheet import Sheet, arrange, arrange_conditions, arrange_lines
from hjcamp.report.tables.store import replace_file, write_frame

if TYPE_CHECKING:
    from hjcamp.records.log import TestLog
    from hjcamp.records.sets.look import InSet

AGAINST = ("published",)
INTERNAL = pl.selectors.ends_with("_decimals", "_printed") | pl.selectors.starts_with("_")
#: From logs to further pictures of the page: heading -> (SVG, caption).
Pictures = Callable[[Sequence["TestLog"]], dict[str, tuple[str, str]]]


@dataclass(frozen=True)
class Report:
    """What was made: the frames in memory, where the page is, and why no published value stands beside (reason: conditions)."""

    run_dir: Path
    page: Path
    indicators: pl.DataFrame
    tables: dict[str, pl.DataFrame]
    sheets: list[Sheet]
    by_condition: pl.DataFrame
    conditions: Sheet
    comparison: pl.DataFrame
    differs: dict[str, list[str]]
    verdict: str
    baseline: RunComparison | None = None
    refitted: Sheet | None = None
    effects: pl.DataFrame = field(default_factory=pl.DataFrame)

    @property
    def title(self) -> str:
        """The campaign and the name of the folder."""
        campaigns = self.indicators["campaign"].drop_nulls().unique(maintain_order=True).to_list()
        return " ".join(dict.fromkeys((*campaigns[:1], self.run_dir.resolve().name)))


def build_report(
    run_dir: Path,
    *,
    against: str | None = None,
    output: Path | None = None,
    logs: Sequence[TestLog] | None = None,
    further: Pictures | None = None,
    template: Path | None = None,
) -> Report:
    """Write ``tables/`` and ``report.html`` of a run folder, or of a folder of logs, each file whole or not at all.

    With ``against="published"`` the published values stand beside, with a path those of that run. ``output`` is another
    folder for the files, ``logs`` are the logs where they have been read already, ``further`` gives more pictures for the
    page, ``template`` is a file that the page is made by (docs/templates.md).
    The logs of the folder are read one after the other. `UsageError` where there is no log, a log that cannot be
    read, an unknown ``against`` or table, or a baseline that has no condition of this run.
    """
    from hjcamp.records.find import refuse_mixed_plants, tell
    from hjcamp.records.run_folder import refuse_links_out
    from hjcamp.records.stored import stored_logs

    if against is not None and against not in AGAINST and not Path(against).exists():
        raise unknown("comparison", against, (*AGAINST, "a run folder"), "--against")
    run_dir, target = Path(run_dir), Path(output or run_dir)
    if target.is_file():
        raise UsageError(f"{target} is a file; name the folder for tables and page with output (--output DIR)")
    origin = read_origin(run_dir)
    if origin.plan and target == run_dir:
        refuse_links_out(target)
    left_out: list[str] = []
    doubtful: list[str] = []

    def leave_out(text: str) -> None:
        left_out.append(text.replace(f"{run_dir}{os.sep}", ""))
        tell(text)

    found = list(logs) if logs is not None else stored_logs([run_dir], leave_out)
    if not found:
        raise UsageError(f"{run_dir}: there are no test logs to report on")
    refuse_mixed_plants(found)
    found = in_plan_order(found, origin)
    baseline = read_tests(Path(against)) if against is not None and against not in AGAINST else None
    indicators, spreads, in_sets, shown = _condensed(found, origin, run_dir)
    for one in in_sets:
        line = f"{one.log.path} {one.finding.text}"
        if counts_not(one):
            leave_out(line)
            found.remove(one.log)
        elif one.original is None:
            tell(line)
            doubtful.append(line.replace(f"{run_dir}{os.sep}", ""))
    beside: str | RunComparison | None = against
    if baseline is not None:
        beside = runs = RunComparison(tests_of(str(run_dir), indicators, found), baseline)
        runs.refuse_without_pairs()
    definitions = _with_rows(declared_tables(origin.tables), indicators)
    tables = {one.name: build_table(indicators, one, beside) for one in definitions}
    sheets = [arrange(tables[one.name], one) for one in definitions]
    compared = beside if isinstance(beside, RunComparison) else None
    comparison = compared.cells if compared else against_published(indicators, definitions)
    conditions = by_condition(indicators, beside)
    factors = factors_of(origin)
    effects = effects_of(factors, indicators)
    if effects.height:
        write_frame(target / "tables", "effects", effects)
    differs = differences(conditions.iter_rows(named=True))
    write_frame(target / "tables", "indicators", indicators.select(*COLUMNS, *IDENTITY, *FURTHER, *varied_columns(indicators)))
    for name, sheet in zip(tables, sheets, strict=True):
        write_frame(target / "tables", name, tables[name].select(~INTERNAL))
        replace_file(target / "tables" / f"{name}.md", to_markdown(sheet))
        replace_file(target / "tables" / f"{name}.tex", to_latex(sheet))
    replace_file(target / "metrics.json", metrics_json(conditions))
    if origin.plan:
        replace_file(target / "params.yaml", params_yaml(origin.plan))
    by_name = arrange_conditions(conditions, compared.notes if compared else ())
    found_effects = effects_sheet(effects)
    lines = arrange_lines(lines_by_condition(indicators))
    all_sheets = [*([found_effects] if found_effects else []), *sheets, by_name, *lines]
    more = {**_main_effects(factors, indicators, effects), **(further(found) if further else {})}
    said = compared.verdict if compared else verdict(comparison, differs) if against else ""
    dots = _dots(conditions, found)
    refitted = beside_refit(conditions) if against in AGAINST and _as_printed(found) else None
    notes = [*(("left out", text) for text in left_out), *(("doubtful", text) for text in doubtful)]
    page = _page(run_dir, origin, found, spreads, all_sheets, said, more, notes, shown, dots, refitted, template)
    replace_file(target / "report.html", page)
    return Report(
        run_dir,
        target / "report.html",
        indicators,
        tables,
        sheets,
        conditions,
        by_name,
        comparison,
        differs,
        said,
        compared,
        refitted,
        effects,
    )


def _main_effects(factors: Sequence[Factor], indicators: pl.DataFrame, effects: pl.DataFrame) -> dict[str, tuple[str, str]]:
    """Return the picture of what varies, nothing where no effect has an interval."""
    names = [name for name in INDICATORS if (effects["indicator"] == name).any()]
    shown = [one for one in factors if (effects["axis"] == one.name).any()]
    if not shown:
        return {}
    return {"Main effects": (draw_main_effects(shown, {name: samples_of(indicators, name) for name in names}), CAPTION)}


def _as_printed(logs: Sequence[TestLog]) -> bool:
    """Whether every test was simulated, and none with another model than the published one."""
    from hjcamp.records.log import observed

    if observed(logs) != "simulated":
        return False
    models = (configuration(log.attachments.get("config.yaml", b"")).get("model") for log in logs)
    return all(not isinstance(one, dict) or one.get("name") in (None, "published") for one in models)


def in_plan_order(logs: Sequence[TestLog], origin: RunOrigin) -> list[TestLog]:
    """Return the logs sorted by the conditions of the plan, then by repetition; others after them as they came."""
    place = {name: number for number, name in enumerate(origin.condition_order)}

    def key(log: TestLog) -> tuple[int, int]:
        repetition = log.metadata.get("repetition", "")
        return place.get(log.condition_key, len(place)), int(repetition) if repetition.isdecimal() else 0

    return sorted(logs, key=key) if place else list(logs)


def _condensed(
    logs: Sequence[TestLog], origin: RunOrigin, folder: Path
) -> tuple[pl.DataFrame, list[Condition], list[InSet], Exploration]:
    """Return the indicators of all logs, the spread of each condition, what the logs say as a set, and what the explorer shows.

    Copies are left out. The logs of one condition are read once and let go, all once more without those that are copies of a log of
    another condition.
    """
    from hjcamp.records.log import observed
    from hjcamp.records.sets.glance import Glance, glance_at
    from hjcamp.records.sets.look import look_across, look_at_condition
    from hjcamp.records.stored import kept

    shown = Exploration(len(logs), [REFERENCE], observed=observed(logs))
    names = names_of(logs)
    groups: dict[str, list[int]] = {}
    for place, log in enumerate(logs):
        groups.setdefault(log.condition_key, []).append(place)
    rows: dict[int, dict[str, Any]] = {}
    spreads = []
    in_sets: list[InSet] = []
    glances: list[Glance] = []
    for name, places in groups.items():
        gathering, group = Gathering(name), [logs[place] for place in places]
        with kept(group):
            found = look_at_condition(group)
            for place in (place for place in places if not any(one.log is logs[place] and counts_not(one) for one in found)):
                glances.append(glance_at(logs[place], glances))
                rows[place] = row_of(logs[place], folder)
                gathering.add(logs[place])
                shown.add_log(names[place], logs[place])
        in_sets += found
        spreads.append(gathering.condition())
    across = look_across(glances)
    if again := [one for one in across if counts_not(one)]:
        rest = [log for log in logs if not any(one.log is log for one in again)]
        indicators, conditions, others, explored = _condensed(rest, origin, folder)
        return indicators, conditions, [*again, *others], explored
    attached = [logs[place].attachments.get("config.yaml", b"") for place in sorted(rows)]
    return (
        frame_with_varied([rows[place] for place in sorted(rows)], attached, origin.axes),
        spreads,
        [*in_sets, *across],
        shown,
    )


def counts_not(one: InSet) -> bool:
    """Whether a log is a copy of another one; repetitions of a simulation without scatter keep their rows."""
    return one.original is not None and not one.simulated


def _dots(conditions: pl.DataFrame, logs: Sequence[TestLog]) -> list[Dots]:
    """Return the means of the run, and the published ones or a baseline's where any stands beside."""
    from hjcamp.records.log import observed

    rows = conditions.to_dicts()
    kinds = [
        dots_of(rows, observed(logs), INDICATORS),
        dots_of(rows, "published", INDICATORS, "_published"),
        dots_of(rows, "baseline", INDICATORS, "_baseline"),
    ]
    return [one for one in kinds if one.values]


def _with_rows(definitions: Sequence[TableDefinition], indicators: pl.DataFrame) -> list[TableDefinition]:
    return [one for one in definitions if build_table(indicators, one).height]


def verdict(comparison: pl.DataFrame, differs: Mapping[str, Sequence[str]]) -> str:
    """Return one sentence on how far the means are from the published ones; empty where nothing compares.

    ``differs`` are the reasons why no published value stands beside some conditions.
    """
    if not comparison.height:
        return ""
    cells = comparison.drop_nulls("difference_in_std").unique(["condition", "indicator"], keep="first")
    outside = cells.filter(pl.col("difference_in_std").abs() > FAR_OFF).height
    left = sum(map(len, differs.values()))
    others = f" Not judged: {left} of another configuration." if left else ""
    if not cells.height:
        stand = counted(comparison.height, "published value stands", "published values stand")
        return f"{stand} next to it, without a published deviation.{others}"
    return (
        f"{cells.height - outside} of {counted(cells.height, 'mean')} within {FAR_OFF:g} published standard deviations of the"
        f" published mean, {outside} outside.{others}"
    )


def _page(
    run_dir: Path,
    origin: RunOrigin,
    logs: Sequence[TestLog],
    spreads: Sequence[Condition],
    sheets: Sequence[Sheet],
    verdict_text: str,
    more: dict[str, tuple[str, str]],
    notes: Sequence[tuple[str, str]],
    shown: Exploration,
    dots: Sequence[Dots],
    beside: Sheet | None,
    template: Path | None,
) -> Iterator[str]:
    tests = Counter(log.condition_key for log in logs)
    pictures = {}
    for one in spreads:
        caption = f"{tests[one.name]} test{'s' * (tests[one.name] > 1)}"
        pictures[one.name] = Picture(caption, partial(draw_condition, one))
    states = states_of_tests(origin)
    unfinished = [f"{count} {state}" for state, count in states.items() if state != "done"]
    campaign = str(origin.plan.get("campaign") or logs[0].metadata.get("campaign") or "Test logs")
    facts = [run_dir.resolve().name, counted(len(logs), "test"), counted(len(spreads), "condition"), *unfinished]
    repetitions = {log.metadata.get("repetition", "") for log in logs}
    if len(repetitions) == 1 and (one_alone := repetitions.pop()) not in ("", "1"):
        facts.insert(1, f"repetition {one_alone} alone")
    for kind in dict.fromkeys(kind for kind, _ in notes):
        facts.append(f"{counted(sum(kind == one for one, _ in notes), 'log')} {kind}, see below")
    return build_page(
        title=campaign,
        facts=[*facts, *filter(None, [str(origin.plan.get("description") or "")])],
        verdict=verdict_text,
        overview=_overview(spreads, dots),
        small=spreads,
        explorer=explorer_html(shown),
        sheets=sheets,
        beside=beside,
        pictures=pictures,
        further=more,
        origin=[*origin_facts(origin, logs), *notes],
        command=origin.command,
        configuration=origin.config_text,
        template=template,
    )


def _overview(spreads: Sequence[Condition], dots: Sequence[Dots]) -> str:
    """Return the picture of all conditions as SVG, empty where no test has an indicator."""
    indicators = [name for name in INDICATORS if any(one == name for kind in dots for _, one in kind.values)]
    return draw_dots([one.name for one in spreads], indicators, dots) if indicators else ""
