"""The folder for a text: numbers as siunitx has them, tables, figures, sources; compiled where there is a LaTeX."""

from __future__ import annotations

import inspect
import json
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from report_samples import make_log

from hjcamp.commands.runs.paper import paper
from hjcamp.effects import load_effects
from hjcamp.errors import UsageError
from hjcamp.records.write import write_log
from hjcamp.report.paper.cite import bibliography, entries_of, sources_of
from hjcamp.report.paper.figures import STYLES, formats_of, style_of
from hjcamp.report.paper.folder import Paper, _main
from hjcamp.report.paper.names import distinct, macro
from hjcamp.report.paper.numbers import Quantity, of_estimate, uncertain, unit_latex
from hjcamp.report.paper.tables import DEVIATION, paper_table, plain_sheet
from hjcamp.report.tables.sheet import Cell, Sheet
from hjcamp.report.wording.names import readable


def test_numbers_with_uncertainties_by_hand() -> None:
    assert uncertain(1.23456, 0.0449) == "1.235(45)" and uncertain(1.23456, 0.0996) == "1.23(10)"
    assert uncertain(-0.5, 1.25) == "-0.5(12)" and uncertain(1234.5, 56.0) == "1234(56)"
    assert uncertain(1.0, 0.0) == "1" and uncertain(2.0, None) == "2" and uncertain(2.57e-14, 1.2e-16) == "2.570(12)e-14"
    assert Quantity(1.5, 0.25, r"\degree").latex == r"\SI{1.50(25)}{\degree}" and Quantity(7, None, "").latex == r"\num{7}"
    row = {"value": 2.57e13, "unit": "Pa/m^3", "ci95": [2.47e13, 2.67e13]}
    # Half the interval, 0.001 MPa/mm3, is 1.96 standard uncertainties.
    assert of_estimate(row).latex == r"\SI{0.02570(51)}{MPa/mm^3}"
    assert (
        unit_latex("kPa s/mm3") == "kPa.s/mm^3" and unit_latex("N*s/m") == "N.s/m" and unit_latex("Pa s2/mm3") == "Pa.s^2/mm^3"
    )


def test_names_for_people_and_for_latex() -> None:
    assert readable("sine_0p5hz__ffwd_pid") == "sine 0.5 Hz, feedforward PID" and readable("brass_8p5g") == "brass 8.5 g"
    assert macro("ramp_pos__pid", "N") == "RampPosPidN" and macro("", "sine_0p5hz") == "SineZeroPointFiveHz"
    assert macro("sine_1hz__ffwd_pid") == "SineOneHzFfwdPid"
    assert distinct(["A", "A", "AX", "A"]) == ["A", "AX", "AXX", "AXXX"]


def test_a_table_has_columns_of_numbers() -> None:
    rows = [
        [Cell("ramp_pos", "key"), Cell("12.34 ± 0.56", mark="▲"), Cell("–"), Cell("5.7 ± 1.08", "published")],
        [Cell("x_y", "key"), Cell("-1.20 ± 0.05 (-12 %)"), Cell("3"), Cell("", "published")],
    ]
    text = paper_table(Sheet("t", "Means & more", "", ["trajectory", "RMSE1", "n", "published"], rows, ["a note"]), "t")
    assert r"\begin{tabular}{lS[table-format=-2.2]@{\,}lS[table-format=1.0]S[table-format=1.1]@{\,}l}" in text
    assert r"ramp positive & 12.34 & $\pm$ 0.56 $\bigtriangleup$ & {--} & 5.7 & $\pm$ 1.08 \\" in text
    assert r"x y & -1.20 & $\pm$ 0.05 (-12 \%) & 3 & {} &  \\" in text and r"\caption{Means \& more}" in text


def test_what_is_wider_than_a_column_goes_across_or_into_blocks_and_is_never_scaled() -> None:
    names = ["RMSE1", "published", "RMSE2", "published", "|e|max", "published", "SSE", "published"]
    keys = [("ramp_pos__pid", "ramp_pos", "pid"), ("sine_1hz__ffwd_pid", "sine_1hz", "ffwd_pid")]
    rows = [[*(Cell(one, "key") for one in key), *(Cell(f"{k}.25 ± 0.10") for k in range(8))] for key in keys]
    sheet = Sheet("t", "T", "", ["condition", "trajectory", "controller", *names], rows, [])
    seen = {}
    for column_mm, text_mm in ((600.0, 600.0), (90.0, 600.0), (88.9, 177.8), (60.0, 100.0)):
        text = paper_table(sheet, "t", column_mm, text_mm)
        assert "resizebox" not in text and "Condition" not in text
        tabulars = text.split(r"\begin{tabular}")[1:]
        seen[column_mm] = (r"\begin{table*}" in text, len(tabulars))
        heads = [one.split(r"\midrule")[0] for one in tabulars]
        assert all("Trajectory & Controller" in one for one in heads)
        assert [one.count("(deg)") for one in heads] == [one.count("(deg)") // 2 * 2 for one in heads], "a pair stays together"
        assert sum(one.count("(deg)") for one in heads) == len(names)
        for k in range(8):
            assert text.count(f"& {k}.25 & ") == 2
        for one in tabulars:
            body = one.split(r"\bottomrule")[0].split("\n")[1:]
            assert len({line.count("&") for line in body if "&" in line}) == 1
        for name in ("RMSE1: root", "RMSE2: the same", "largest magnitude", "SSE: its mean"):
            assert text.count(name) == 1
    assert seen[600.0] == (False, 1) and seen[90.0] == (True, 1)
    assert seen[88.9][0] and 1 < seen[88.9][1] < seen[60.0][1]
    other = [[Cell("a", "key"), *row[1:]] for row in rows]
    assert "Condition" in paper_table(replace(sheet, rows=other), "t"), "a name of its own says more"


def test_every_work_that_an_effect_cites_is_an_entry() -> None:
    effects = load_effects()
    for name, effect in effects.items():
        source = sources_of(effect)
        years = re.findall(r"\((1[89]\d\d|20\d\d)\)", source)
        assert sorted(years) == sorted(re.search(r"year = \{(\d+)\}", one)[1] for one in entries_of(source).values()), name  # type: ignore[index]
        assert source or "Source" not in inspect.getdoc(effect), name
    entries = bibliography(effects.values(), True)
    assert "thesis" in entries and len(entries) > 10
    for key, entry in entries.items():
        assert entry.count("{") == entry.count("}") and entry.startswith("@") and re.fullmatch(r"[a-z]+(\d{4})?", key), entry
    assert entries_of("x, e.g. Franklin, Powell & Emami-Naeini (2010), Feedback Control, 6th ed., section 5.6; thesis 3.") == {
        "franklin2010": "@book{franklin2010,\n  author = {Franklin and Powell and Emami-Naeini},\n  year = {2010},\n"
        "  title = {{Feedback Control}},\n  edition = {6th},\n  note = {section 5.6},\n}\n"
    }


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "one"
    log = make_log("ramp_pos", "pid", 4, 1.5, ("+effects.stribeck_friction={}",), condition="other")
    for number, one in enumerate([*(make_log("ramp_pos", "pid", repetition, 1.5) for repetition in (1, 2, 3)), log]):
        write_log(folder / "logs" / f"{number}.mcap", one)
    return folder


ANSWERS = {
    "models.json": {
        "schema": "hjcamp.comparison/1", "where": [],
        "models": [{"name": "my_model", "tests": 3, "error": {"arm_deg": {"rms": 0.5, "floor": 0.1, "r2": 0.9}}, "score": 1.5}],
    },
    "cal.json": {
        "schema": "hjcamp.calibration/1", "plant": "pump_joint", "tests": 7, "hardware": {}, "notes": [],
        "calibration": {"line_stiffness": {"published": 2.57e13, "value": 2.6e13, "unit": "Pa/m^3", "ci95": [2.5e13, 2.7e13]}},
    },
    "found.json": {
        "schema": "hjcamp.diagnosis/1", "verdict": "effect", "effects": ["cross_leakage"], "calibration": {},
        "candidates": [{"effect": "cross_leakage", "posterior": 0.98, "heldout_error_ratio": 0.4,
                        "parameters": {"conductance": {"value": 1e-15, "unit": "m^3/(s*Pa)", "ci95": [0.9e-15, 1.1e-15]}}}],
    },
}  # fmt: skip


@pytest.mark.parametrize(
    ("style", "document", "sources"),
    [
        ("plain", r"\documentclass{article}", "plain"),
        ("ieee", r"\documentclass[journal]{IEEEtran}", "IEEEtran"),
        ("elsevier", r"\documentclass[final,5p,times,twocolumn]{elsarticle}", "elsarticle-num"),
        ("springer", r"\documentclass{article}", "plain"),
        ("thesis", r"\documentclass{article}", "plain"),
    ],
)
def test_each_style_has_the_class_of_its_journal(tmp_path: Path, style: str, document: str, sources: str) -> None:
    main = _main(Paper(tmp_path, STYLES[style])).splitlines()
    assert document in main and rf"\bibliographystyle{{{sources}}}" in main


def test_the_folder_of_a_run_and_answers(run: Path, tmp_path: Path) -> None:
    for name, answer in ANSWERS.items():
        (tmp_path / name).write_text(json.dumps(answer))
    out = tmp_path / "text"
    paper([run, *(tmp_path / name for name in ANSWERS)], out, "ieee", 80.0, "pdf,svg", json=tmp_path / "made.json")
    made = json.loads((tmp_path / "made.json").read_text())
    assert all((out / name).stat().st_size for name in [*made["tables"], *made["figures"], "numbers.tex", "main.tex"])
    numbers = (out / "numbers.tex").read_text()
    values = np.array([1.6, 1.7, 1.8])
    u = values.std(ddof=1) / np.sqrt(3)
    assert made["numbers"]["RampPosPidRmseOne"]["uncertainty"] == pytest.approx(u, rel=1e-6)
    assert r"\newcommand{\RampPosPidRmseOne}{\SI{1.700(58)}{\degree}}" in numbers and round(u, 3) == 0.058
    assert r"\newcommand{\CalLineStiffness}" in numbers and r"\newcommand{\FoundCrossLeakageConductance}" in numbers
    assert {"thesis", "merritt1967", "armstronghelouvry1994"} <= set(made["cite"])
    svg = (out / "figures" / "means.svg").read_text()
    assert f'width="{80.0 / 25.4 * 72:.3f}'[:12] in svg and "ramp positive, PID" in svg
    assert r"my model & arm angle (deg) & 0.5 & 0.1 & 1.50 \\" in (out / "tables" / "models.tex").read_text()
    main = (out / "main.tex").read_text()
    assert re.search(
        r"\\caption\{RMSE1, .* of every condition: mean and sample standard deviation of the tests \(n = 1 to 3\)", main
    )
    assert r"\documentclass[journal]{IEEEtran}" in main and r"\bibliographystyle{IEEEtran}" in main and "@" not in main
    assert set(made["captions"]) == {*made["tables"], *made["figures"]} and all(made["captions"].values())
    assert main.count(r"\begin{figure}") == main.count(r"\caption{") == 3 and r"\label{fig:ramp-pos--pid}" in main
    # A main file that was worked on stays; the rest is written again, byte for byte.
    (out / "main.tex").write_text("mine")
    before = {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    paper([run, *(tmp_path / name for name in ANSWERS)], out, "ieee", 80.0, "pdf,svg")
    assert {path: path.read_bytes() for path in out.rglob("*") if path.is_file()} == before


def test_bad_calls_are_one_message_and_write_nothing(run: Path, tmp_path: Path) -> None:
    out = tmp_path / "text"
    wrong = {
        r"unknown figure style 'iee' in --style; did you mean 'ieee'.*Allowed: elsevier, ieee, plain": {"style": "iee"},
        r"--width 5: give 40 to 400 mm": {"width": 5.0},
        r"unknown figure format 'png' in --formats": {"formats": "png"},
        r"--formats: name at least one": {"formats": ","},
    }
    for said, words in wrong.items():
        with pytest.raises(UsageError, match=said):
            paper([run], out, **words)  # type: ignore[arg-type]
    with pytest.raises(UsageError, match="there is no such run"):
        paper([tmp_path / "nowhere"], out)
    for name, text, said in (
        ("a.json", "{", "this is no JSON"),
        ("b.json", '{"schema": "hjcamp.plan/1"}', "unknown schema"),
    ):
        (tmp_path / name).write_text(text)
        with pytest.raises(UsageError, match=said):
            paper([tmp_path / name], out)
    (tmp_path / "c.json").write_text('{"schema": "hjcamp.comparison/1", "models": [{}]}')
    with pytest.raises(UsageError, match="is not what its schema"):
        paper([tmp_path / "c.json"], out)
    assert not list(out.rglob("*.tex"))


def test_only_the_figures_that_are_wanted_are_drawn(run: Path, tmp_path: Path) -> None:
    paper([run], tmp_path / "text", formats="svg", only="means, other", json=tmp_path / "made.json")
    made = json.loads((tmp_path / "made.json").read_text())
    assert made["figures"] == ["figures/means.svg", "figures/other.svg"] and made["numbers"]
    with pytest.raises(UsageError, match=r"unknown figure 'mean' in --only; did you mean 'means'"):
        paper([run], tmp_path / "refused", formats="svg", only="mean")


def test_a_call_that_is_refused_writes_nothing(run: Path, tmp_path: Path) -> None:
    (tmp_path / "b").mkdir()
    answers = [tmp_path / "a.json", tmp_path / "b" / "a.json"]
    for path in answers:
        path.write_text(json.dumps(ANSWERS["found.json"]))
    with pytest.raises(UsageError, match=r"two of the answers are named a\.json"):
        paper([run, *answers], tmp_path / "refused")
    with pytest.raises(UsageError, match="unknown figure"):
        paper([run], tmp_path / "refused", only="PUBLISHED")
    with pytest.raises(UsageError):
        paper([run, tmp_path / "b"], tmp_path / "refused")
    assert not (tmp_path / "refused").exists()


def test_pgf_is_refused_without_a_latex(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    assert formats_of(None) == ["pdf", "svg"] and style_of("springer", None).width_mm == 84.0
    with pytest.raises(UsageError, match=r"--formats pgf: pdflatex is needed.*without it: pdf,svg"):
        formats_of("pgf")


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="pdflatex is not installed")
def test_latex_compiles_the_folder(run: Path, tmp_path: Path) -> None:
    for name, answer in ANSWERS.items():
        (tmp_path / name).write_text(json.dumps(answer))
    out = tmp_path / "text"
    paper([run, *(tmp_path / name for name in ANSWERS)], out, "elsevier", None, "pdf,pgf")
    assert r"\begin{pgfpicture}" in (out / "figures" / "means.pgf").read_text()
    done = subprocess.run(
        ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "main"],
        cwd=out,
        capture_output=True,
        text=True,
        timeout=300,
    )
    if "siunitx.sty' not found" in done.stdout:
        pytest.skip("this LaTeX has no siunitx")
    assert done.returncode == 0, done.stdout[-2000:]
    assert (out / "main.pdf").read_bytes().startswith(b"%PDF") and "Undefined control sequence" not in done.stdout
    assert "Overfull" not in done.stdout and "Font shape" not in done.stdout


def test_a_deviation_is_printed_with_its_own_digits_and_said_to_be_one() -> None:
    sheet = plain_sheet("a", "A", ("name", "published"), [("x", "1.8 ± 0.04"), ("y", "5.7 ± 1.08"), ("z", "12")])
    text = paper_table(sheet, "a")
    for row in (r"x & 1.8 & $\pm$ 0.04 \\", r"y & 5.7 & $\pm$ 1.08 \\", "z & 12 & ", "table-format=2.1]", DEVIATION[-30:]):
        assert row in text
