"""What logs and answers say of themselves is text in every output: no command of LaTeX, formula, HTML or terminal."""

from __future__ import annotations

import io
import json
import re
from pathlib import Path

import polars as pl
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from report_samples import make_log
from rich.table import Table

from hjcamp import cli
from hjcamp.campaign.execution.console import bold, make_console
from hjcamp.campaign.execution.progress import progress_bar
from hjcamp.commands.shared.streams import Visible
from hjcamp.errors import visible
from hjcamp.records.write import write_log
from hjcamp.report.paper.numbers import unit_latex
from hjcamp.report.tables.formats import IN_LATEX, escape_csv, escape_latex, escape_markdown

HOSTILE = (
    "../../evil", r"\input{/etc/passwd}", r"}\input{/etc/passwd}{", "^^5cinput{x}", "$\\frac$", "$", "=HYPERLINK(\"http://x\")",
    "@SUM(1)", "<img src=x onerror=alert(1)>", "![x](http://x/y)", "`x`|y", "\x1b]0;title\x07", "\x9b2J", "a\nb\r\n# c",
    "\u202egpj", "%0a", "[bold]x[/y]", "{evil}", "a" * 60,
)  # fmt: skip
COMMAND = re.compile(r"\\(?:input|include|write|def|csname|immediate|openin|read|catcode)\b")


def unescaped(text: str) -> str:
    """Return LaTeX without its escapes."""
    return re.sub("|".join(re.escape(one) for one in IN_LATEX.values()), "", text)


@given(st.text(max_size=40))
@settings(max_examples=200, deadline=None)
def test_every_format_escapes_what_it_would_obey(text: str) -> None:
    for one in (text, *HOSTILE):
        for tex in (escape_latex(one), unit_latex(one)):
            assert not COMMAND.search(tex) and "^^" not in tex and "\n" not in tex
            assert not re.search(r"[\\%#$&{}]", unescaped(tex)), tex
        markdown = escape_markdown(one)
        assert not re.search(r"<|>|(?<!\\)[\[\]`|]|[\x00-\x1f\x7f-\x9f]", markdown.replace("\\\\", ""))
        assert not re.match(r"[=@\t\r]|[+-](?![\d.])", escape_csv(one))
        assert not re.search(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]", visible(one))


def test_numbers_and_usual_names_stay_as_they_are() -> None:
    for one in ("-1.5", "+2e-3", "ramp_pos__pid", "1.2 ± 0.3", "kp=0.7"):
        assert escape_csv(one) == visible(one) == one
    assert unit_latex("Pa*s^2/m^3") == "Pa.s^2/m^3" and unit_latex("m^-1") == "m^-1"
    assert visible("\x1b[1mbold") == "\\x1b[1mbold"


@pytest.fixture(scope="module")
def received(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("received") / "run"
    for number, text in enumerate(HOSTILE):
        log = make_log("ramp_pos", "pid", 1, 1.5, condition=text, campaign=text, trajectory_note=text)
        write_log(folder / f"{number}.mcap", log)
    return folder


def test_a_paper_of_hostile_logs_is_text(
    received: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    home = tmp_path / "deep" / "er"
    home.mkdir(parents=True)
    monkeypatch.chdir(home)
    estimates = {f"k{number}": {"value": 1.0, "unit": text, "text": text} for number, text in enumerate(HOSTILE)}
    answer = {"schema": "hjcamp.calibration/1", "tests": 1, "calibration": estimates}
    Path("an_&_answer{}.json").write_text(json.dumps(answer))
    assert cli.run(["paper", str(received), "an_&_answer{}.json", "--as", "text/p", "--formats", "svg"]) == 0, (
        capsys.readouterr()
    )
    assert {one.name for one in tmp_path.iterdir()} == {"deep"} and sorted(one.name for one in Path("text").iterdir()) == ["p"]
    written = [one for one in Path("text/p").rglob("*") if one.is_file()]
    assert len([one for one in written if one.suffix == ".svg"]) == len(HOSTILE) + 1
    for file in Path("text/p").rglob("*.tex"):
        assert file.name == "main.tex" or not COMMAND.search(file.read_text(encoding="utf-8")), file
    main = Path("text/p/main.tex").read_text(encoding="utf-8")
    assert all((Path("text/p") / f"{name}.tex").is_file() for name in re.findall(r"\\input\{([^}]*)\}", main))
    capsys.readouterr()


def test_a_report_of_hostile_logs_is_text(received: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, summary = tmp_path / "out", tmp_path / "summary.md"
    assert cli.run(["report", str(received), "--output", str(out), "--summary", str(summary)]) == 0, capsys.readouterr()
    rows = pl.read_csv(out / "tables" / "indicators.csv", infer_schema=False)
    for cell in (cell for row in rows.iter_rows() for cell in row if cell):
        assert cell[0] not in "=@\t\r" and (cell[0] not in "+-" or re.fullmatch(r"[-+\d.eE]+", cell)), cell
    assert "<img" not in summary.read_text() and "![" not in summary.read_text().replace("!\\[", "")
    assert "<img src=x" not in (out / "report.html").read_text()
    assert not COMMAND.search("".join(file.read_text() for file in (out / "tables").glob("*.tex")))


def test_the_terminal_obeys_no_log(received: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for command in (["log", "info"], ["log", "verify"]):
        cli.run([*command, str(received)])
        said = capsys.readouterr()
        assert "\x1b" not in said.out + said.err and "\x9b" not in said.out + said.err and "\u202e" not in said.out


@pytest.mark.parametrize("terminal", [False, True])
@given(st.text(st.characters(codec="utf-8", exclude_characters="\n\r\t"), min_size=1, max_size=30))
@example("[bold]x[/y]")
@example("[/]")
@example(":warning: [link=file:///x]y")
@example("\x1b[2J\x1b[31mred\x1b]0;title\x07")
@settings(max_examples=50, deadline=None)
def test_a_name_is_printed_as_it_is_and_no_terminal_obeys_it(terminal: bool, name: str) -> None:
    console = make_console()
    console.file, console._force_terminal, console.width = io.StringIO(), terminal, 500
    table = Table(box=None, title=name)
    table.add_column(name, no_wrap=True)
    table.add_row(name)
    table.add_row(f"[dim]{name}")
    for one in (table, bold(name, name), name):
        console.print(one, soft_wrap=True)
    console.print(table)
    printed = console.file.getvalue()
    plain = re.sub(r"\x1b\[[0-9;]*m", "", printed)
    assert not re.search(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f]", plain)
    kept = visible(name)
    assert kept.strip() in plain and f"[dim]{kept}".strip() in plain
    colours = set(re.findall(r"\x1b\[[0-9;]*m", printed))
    assert colours <= ({"\x1b[0m", "\x1b[1m", "\x1b[3m"} if terminal else set())


def test_a_bar_is_drawn_though_texts_are_escaped(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = io.StringIO()
    monkeypatch.setattr("sys.stdout", Visible(stream))
    console = make_console()
    console._force_terminal, console.legacy_windows = True, False
    with progress_bar(console, 2, 0) as advance:
        advance("\x1b[31mname/1")
        print("\x1b[2Jprinted")
    drawn = stream.getvalue()
    assert "\x1b[?25l" in drawn and "\\x1b[2K" not in drawn and "\\x1b[?25" not in drawn
    assert "\x1b[2J" not in drawn and "\x1b[31mname" not in drawn and "printed" in drawn
