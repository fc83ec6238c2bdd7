"""Make the report of a run: indicators, tables, figures and the page, from the logs alone."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import polars as pl

from hjcamp.errors import UsageError, counted, unknown
from hjcamp.records.log import observed
from hjcamp.report.against_run import RunComparison, tests_of
from hjcamp.report.ci import metrics_json, params_yaml
from hjcamp.report.pages.explorer import explorer_html
from hjcamp.report.pages.page import Picture, build_page
from hjcamp.report.pictures.conditions import draw_condition
from hjcamp.report.pictures.dot_plot import Dots, dots_of, draw_dots
from hjcamp.report.pictures.main_effects import CAPTION, draw_main_effects
from hjcamp.report.reading import AGAINST, LogsOfRun, read_logs
from hjcamp.report.runs.indicators import COLUMNS, FURTHER, IDENTITY, INDICATORS, configuration, varied_columns
from hjcamp.report.runs.origin import RunOrigin, origin_facts, read_origin, states_of_tests
from hjcamp.report.runs.published import against_refit
from hjcamp.report.runs.spread import Condition
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

INTERNAL = pl.selectors.ends_with("_decimals", "_printed") | pl.selectors.starts_with("_")
#: From logs to further pictures of the page: heading -> (SVG, caption).
Pictures = Callable[[Sequence["TestLog"]], dict[str, tuple[str, str]]]


@dataclass(frozen=True)
class Report:
    """What was made: the frames in memory, where the page is, and why no published value stands next to it (reason: conditions)."""

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

    With ``against="published"`` the published values stand next to it, with a path those of that run. ``output`` is another
    folder for the files, ``logs`` are the logs where they have been read already, ``further`` gives more pictures for the
    page, ``template`` is a file that the page is made by (docs/templates.md).
    The logs of the folder are read one after the other. `UsageError` where there is no log, a log that cannot be
    read, an unknown ``against`` or table, or a baseline that has no condition of this run.
    """
    from hjcamp.records.run_folder import refuse_links_out

    if against is not None and against not in AGAINST and not Path(against).exists():
        raise unknown("comparison", against, (*AGAINST, "a run folder"), "--against")
    run_dir, target = Path(run_dir), Path(output or run_dir)
    if target.is_file():
        raise UsageError(f"{target} is a file; name the folder for tables and page with output (--output DIR)")
    origin = read_origin(run_dir)
    if origin.plan and target == run_dir:
        refuse_links_out(target)
    read = read_logs(run_dir, origin, logs, against)
    indicators = read.indicators
    reference: str | RunComparison | None = against
    if read.baseline is not None:
        reference = runs = RunComparison(tests_of(str(run_dir), indicators, read.logs), read.baseline)
        runs.refuse_without_pairs()
    definitions = _with_rows(declared_tables(origin.tables), indicators)
    tables = {one.name: build_table(indicators, one, reference) for one in definitions}
    sheets = [arrange(tables[one.name], one) for one in definitions]
    compared = reference if isinstance(reference, RunComparison) else None
    comparison = compared.cells if compared else against_published(indicators, definitions)
    conditions = by_condition(indicators, reference)
    factors = factors_of(origin)
    effects = effects_of(factors, indicators)
    differs = differences(conditions.iter_rows(named=True))
    _write_tables(target, origin, indicators, tables, sheets, conditions, effects)
    by_name = arrange_conditions(conditions, compared.notes if compared else ())
    found_effects = effects_sheet(effects)
    lines = arrange_lines(lines_by_condition(indicators))
    all_sheets = [*([found_effects] if found_effects else []), *sheets, by_name, *lines]
    more = {**_main_effects(factors, indicators, effects), **(further(read.logs) if further else {})}
    said = compared.verdict if compared else verdict(comparison, differs) if against else ""
    dots = _dots(conditions, read.logs)
    refitted = against_refit(conditions) if against in AGAINST and _as_printed(read.logs) else None
    page = target / "report.html"
    replace_file(page, _page(run_dir, origin, read, all_sheets, said, more, dots, refitted, template))
    made = (run_dir, page, indicators, tables, sheets, conditions, by_name, comparison, differs, said, compared)
    return Report(*made, refitted=refitted, effects=effects)


def _write_tables(
    target: Path,
    origin: RunOrigin,
    indicators: pl.DataFrame,
    tables: Mapping[str, pl.DataFrame],
    sheets: Sequence[Sheet],
    conditions: pl.DataFrame,
    effects: pl.DataFrame,
) -> None:
    """Write the frames of a report as files, the declared tables as Markdown and LaTeX too, and what a CI job reads."""
    folder = target / "tables"
    if effects.height:
        write_frame(folder, "effects", effects)
    write_frame(folder, "indicators", indicators.select(*COLUMNS, *IDENTITY, *FURTHER, *varied_columns(indicators)))
    for name, sheet in zip(tables, sheets, strict=True):
        write_frame(folder, name, tables[name].select(~INTERNAL))
        replace_file(folder / f"{name}.md", to_markdown(sheet))
        replace_file(folder / f"{name}.tex", to_latex(sheet))
    replace_file(target / "metrics.json", metrics_json(conditions))
    if origin.plan:
        replace_file(target / "params.yaml", params_yaml(origin.plan))


def _main_effects(factors: Sequence[Factor], indicators: pl.DataFrame, effects: pl.DataFrame) -> dict[str, tuple[str, str]]:
    """Return the picture of what varies, nothing where no effect has an interval."""
    names = [name for name in INDICATORS if (effects["indicator"] == name).any()]
    shown = [one for one in factors if (effects["axis"] == one.name).any()]
    if not shown:
        return {}
    return {"Main effects": (draw_main_effects(shown, {name: samples_of(indicators, name) for name in names}), CAPTION)}


def _as_printed(logs: Sequence[TestLog]) -> bool:
    """Whether every test was simulated, and none with another model than the published one."""
    if observed(logs) != "simulated":
        return False
    models = (configuration(log.attachments.get("config.yaml", b"")).get("model") for log in logs)
    return all(not isinstance(one, dict) or one.get("name") in (None, "published") for one in models)


def _dots(conditions: pl.DataFrame, logs: Sequence[TestLog]) -> list[Dots]:
    """Return the means of the run, and the published ones or a baseline's where any stands next to it."""
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

    ``differs`` are the reasons why no published value stands next to some conditions.
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
    read: LogsOfRun,
    sheets: Sequence[Sheet],
    verdict_text: str,
    more: dict[str, tuple[str, str]],
    dots: Sequence[Dots],
    refitted: Sheet | None,
    template: Path | None,
) -> Iterator[str]:
    logs, spreads = read.logs, read.spreads
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
    for kind in dict.fromkeys(kind for kind, _ in read.notes):
        facts.append(f"{counted(sum(kind == one for one, _ in read.notes), 'log')} {kind}, see below")
    return build_page(
        title=campaign,
        facts=[*facts, *filter(None, [str(origin.plan.get("description") or "")])],
        verdict=verdict_text,
        overview=_overview(spreads, dots),
        small=spreads,
        explorer=explorer_html(read.shown),
        sheets=sheets,
        open_sheet=refitted,
        pictures=pictures,
        further=more,
        origin=[*origin_facts(origin, logs), *read.notes],
        command=origin.command,
        configuration=origin.config_text,
        template=template,
    )


def _overview(spreads: Sequence[Condition], dots: Sequence[Dots]) -> str:
    """Return the picture of all conditions as SVG, empty where no test has an indicator."""
    indicators = [name for name in INDICATORS if any(one == name for kind in dots for _, one in kind.values)]
    return draw_dots([one.name for one in spreads], indicators, dots) if indicators else ""
