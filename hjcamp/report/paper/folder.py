"""The folder for a text: tables/, figures/, numbers.tex, references.bib, and a main.tex that shows them all."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from hjcamp.errors import UsageError, unknown
from hjcamp.known_plants import DEFAULT
from hjcamp.report.against_run import Tests, tests_of
from hjcamp.report.paper.answers import quantities_of, read_answer, sheet_of
from hjcamp.report.paper.cite import bibliography
from hjcamp.report.paper.figures import (
    MEANS,
    Style,
    course_caption,
    course_painter,
    drawable,
    means_caption,
    means_painter,
    write_figure,
)
from hjcamp.report.paper.names import MACROS, distinct, macro
from hjcamp.report.paper.numbers import Quantity, macros, of_mean
from hjcamp.report.paper.tables import paper_table
from hjcamp.report.pictures.dot_plot import dots_of
from hjcamp.report.runs.indicators import INDICATORS, row_of
from hjcamp.report.runs.origin import read_origin
from hjcamp.report.runs.spread import Condition, Gathering
from hjcamp.report.runs.varied import frame_with_varied
from hjcamp.report.tables.aggregation import build_table, by_condition
from hjcamp.report.tables.declared import declared_tables
from hjcamp.report.tables.formats import escape_latex
from hjcamp.report.tables.sheet import Sheet, arrange, arrange_conditions
from hjcamp.report.tables.store import replace_file
from hjcamp.storage import file_name, file_names

#: From names of effects, and of a plant, to what has their docstrings.
Documented = Callable[[str, set[str]], Sequence[object]]
MAIN = r"""% Shows everything that is here; hjcamp paper writes this file once and leaves it alone afterwards.
@class@
\usepackage[utf8]{inputenc}
\usepackage{amssymb,booktabs,graphicx,siunitx}
\input{numbers}
\begin{document}
@tables@
@figures@
\section*{Numbers}
\begin{itemize}
@numbers@
\end{itemize}
\nocite{*}
\bibliographystyle{@style@}
\bibliography{references}
\end{document}
"""


#: By the class of the document: its lines at the top, and its style of sources.
CLASSES = {
    "article": ("\\documentclass{article}\n\\usepackage[margin=20mm]{geometry}", "plain"),
    "IEEEtran": ("\\documentclass[journal]{IEEEtran}", "IEEEtran"),
    "elsarticle": ("\\documentclass[final,5p,times,twocolumn]{elsarticle}", "elsarticle-num"),
}


@dataclass
class Paper:
    """What is written: files inside the folder, the numbers by macro, the keys to cite.

    ``waiting`` writes tables and figures once nothing more can be refused.
    """

    folder: Path
    style: Style
    tables: list[str] = field(default_factory=list)
    figures: list[str] = field(default_factory=list)
    numbers: dict[str, Quantity] = field(default_factory=dict)
    captions: dict[str, str] = field(default_factory=dict)
    cite: list[str] = field(default_factory=list)
    waiting: list[Callable[[], object]] = field(default_factory=list)


def write_paper(
    paths: Sequence[Path], folder: Path, style: Style, formats: Sequence[str], documented: Documented, only: Sequence[str] = ()
) -> Paper:
    """Write the folder of runs and of answers (``.json`` files of compare, diagnose, calibrate); returns what is in it.

    ``only`` names the figures that are wanted: ``means`` and conditions; all of them where none is named.

    Each file is written whole or not at all; ``main.tex`` stays as it is where there is one. `UsageError`, and nothing is
    written, for what is neither a run nor an answer, for equal names and unknown figures.
    """
    runs = [path for path in paths if path.suffix != ".json"]
    answers = [(path, read_answer(path)) for path in paths if path.suffix == ".json"]
    paper = Paper(folder, style)
    used: set[str] = set()
    plants: set[str] = set()
    there: dict[str, None] = {}
    for number, path in enumerate(runs):
        prefix = f"{_letter(number)}" if len(runs) > 1 else ""
        tests = _add_run(paper, path, prefix, style, formats, only, there)
        used |= {name for config in tests.configurations.values() for name in _effects(config)}
        plants |= {str((config.get("plant") or {}).get("name") or "") for config in tests.configurations.values()}
    for name in only:
        if name not in there:
            raise unknown("figure", name, [*there], "--only")
    for path, answer in answers:
        _add_table(paper, sheet_of(answer, path.stem))
        paper.numbers |= quantities_of(answer, path.stem)
        used |= {str(name) for name in answer.get("effects") or ()}
        plants.add(str(answer.get("plant") or ""))
    sources = [one for plant in sorted(plants) for one in documented(plant, used)]
    entries = bibliography(sources, bool(plants & {"", DEFAULT}))
    paper.cite = list(entries)
    for write in paper.waiting:
        write()
    replace_file(folder / "references.bib", "\n".join(entries.values()))
    replace_file(folder / "numbers.tex", macros(paper.numbers))
    if not (folder / "main.tex").exists():
        replace_file(folder / "main.tex", _main(paper))
    return paper


def _add_run(
    paper: Paper, path: Path, prefix: str, style: Style, formats: Sequence[str], only: Sequence[str], there: dict[str, None]
) -> Tests:
    """Add tables, figures (those of ``only``) and numbers of one run; ``there`` hears the names of all its figures."""
    tests, spreads, tables = _read(path)
    conditions = by_condition(tests.indicators)
    for sheet in [*tables, arrange_conditions(conditions)]:
        _add_table(paper, sheet, prefix)
    rows = conditions.to_dicts()
    kinds = [dots_of(rows, "run", INDICATORS), dots_of(rows, "published", INDICATORS, "_published")]
    kinds = [one for one in kinds if one.values]
    names = list(dict.fromkeys(str(row["condition"]) for row in rows))
    shown = [name for name in INDICATORS if any(one == name for kind in kinds for _, one in kind.values)]
    tag = f"{prefix.lower()}_" if prefix else ""
    height = 0.25 + 0.07 * len(names) * -(-len(shown) // 2)
    figures = {MEANS: (height, means_painter(names, shown, kinds), means_caption(shown, rows))} if shown else {}
    drawn = list(filter(drawable, spreads))
    stems = dict(zip([MEANS, *(one.name for one in drawn)], file_names([MEANS, *(one.name for one in drawn)]), strict=True))
    figures |= {one.name: (0.75, course_painter(one), course_caption(one)) for one in drawn}
    there.update(dict.fromkeys(figures))
    for name, (tall, painter, caption) in figures.items():
        if only and name not in only:
            continue
        stem = f"{tag}{stems[name]}"
        paper.waiting.append(partial(write_figure, paper.folder / "figures", stem, formats, style, tall, painter))
        shown_files = [f"figures/{stem}.{kind}" for kind in formats]
        paper.figures += shown_files
        paper.captions |= dict.fromkeys(shown_files, caption)
    for name, base in zip(names, distinct(macro(prefix, name) for name in names), strict=True):
        paper.numbers |= _numbers(next(row for row in rows if row["condition"] == name), base)
    return tests


def _numbers(row: Mapping[str, Any], base: str) -> dict[str, Quantity]:
    found = {f"{base}N": Quantity(float(row["n"]), None, "")}
    for name, word in MACROS.items():
        mean, std = row[f"{name}_mean"], row[f"{name}_std"]
        if mean is not None:
            found[f"{base}{word}"] = of_mean(mean, std, row["n"], r"\degree")
        if std is not None:
            found[f"{base}{word}Std"] = Quantity(std, None, r"\degree", 2)
    return found


def _read(path: Path) -> tuple[Tests, list[Condition], list[Sheet]]:
    from hjcamp.records.find import refuse_mixed_plants
    from hjcamp.records.stored import stored_logs

    logs = stored_logs([path])
    refuse_mixed_plants(logs)
    origin = read_origin(path)
    rows, gatherings = [], {log.condition_key: Gathering(log.condition_key) for log in logs}
    for log in logs:
        rows.append(row_of(log, path))
        gatherings[log.condition_key].add(log)
    attached = [log.attachments.get("config.yaml", b"") for log in logs]
    tests = tests_of(str(path), frame_with_varied(rows, attached, origin.axes), logs)
    built = [(one, build_table(tests.indicators, one, "published")) for one in declared_tables(origin.tables)]
    spreads = [one.condition() for one in gatherings.values()]
    return tests, spreads, [arrange(table, one) for one, table in built if table.height]


def _add_table(paper: Paper, sheet: Sheet, prefix: str = "") -> None:
    name = file_name("_".join(filter(None, (prefix.lower(), sheet.name))), "answer")
    file = f"tables/{name}.tex"
    if file in paper.tables:
        raise UsageError(f"two of the answers are named {name}.json; give them different names")
    content = paper_table(sheet, name.replace("_", "-"), paper.style.width_mm, paper.style.text_mm)
    paper.waiting.append(partial(replace_file, paper.folder / file, content))
    paper.tables.append(file)
    paper.captions[file] = sheet.title


def _figure(name: str, caption: str) -> str:
    label = Path(name).stem.replace("_", "-")
    lines = [r"\begin{figure}", r"\centering", rf"\includegraphics{{{name}}}", rf"\caption{{{escape_latex(caption)}}}"]
    return "\n".join([*lines, rf"\label{{fig:{label}}}", r"\end{figure}"])


def _effects(config: Mapping[str, Any]) -> list[str]:
    model = config.get("controller_model")
    held = [config.get("effects"), model.get("effects") if isinstance(model, Mapping) else None]
    return [str(name) for one in held if isinstance(one, Mapping) for name in one]


def _letter(number: int) -> str:
    return chr(ord("A") + number) if number < 26 else f"{_letter(number // 26 - 1)}{_letter(number % 26)}"


def _main(paper: Paper) -> str:
    pictures = [name for name in paper.figures if name.endswith(".pdf")]
    top, sources = CLASSES[paper.style.document]
    filled = {
        "class": top,
        "style": sources,
        "tables": "\n".join(rf"\input{{{name.removesuffix('.tex')}}}" for name in paper.tables),
        "figures": "\n\n".join(_figure(name, paper.captions[name]) for name in pictures),
        "numbers": "\n".join(rf"\item \texttt{{\char92 {name}}}: \{name}" for name in paper.numbers),
    }
    text = MAIN
    for name, content in filled.items():
        text = text.replace(f"@{name}@", content)
    # An empty list is an error of LaTeX.
    return text if paper.numbers else text.replace("\\begin{itemize}\n\n\\end{itemize}", "None.")
