"""Declared tables: aggregation, order, published values beside, arrows, formats."""

from __future__ import annotations

from pathlib import Path

import polars as pl
import pytest
from report_samples import make_log, make_logs

from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.published.values import measured_indicators
from hjcamp.report.runs.varied import indicators_frame
from hjcamp.report.tables.aggregation import against_published, aggregate, build_table, by_condition
from hjcamp.report.tables.declared import declared_tables, read_definition
from hjcamp.report.tables.formats import escape_latex, to_latex, to_markdown
from hjcamp.report.tables.sheet import arrange, arrange_conditions

NAMES = ["table_5_4_1", "table_5_4_2", "table_5_5_1", "table_5_5_2", "table_5_5_3", "table_5_6_1", "table_6_3_1"]


def table(name: str, indicators: pl.DataFrame, against: str | None = "published") -> pl.DataFrame:
    return build_table(indicators, declared_tables([name])[0], against)


def test_the_declared_tables() -> None:
    assert [definition.name for definition in declared_tables()] == NAMES
    assert declared_tables(["table_5_3_2"])[0].only_if_asked
    with pytest.raises(UsageError, match="did you mean 'table_5_4_1'"):
        declared_tables(["table_5_41"])


def test_mean_and_sample_deviation() -> None:
    made = table("table_5_4_1", indicators_frame(make_logs(3)), against=None)
    assert made.columns[2:] == [f"{n}_deg_{v}" for n in ("rmse1", "rmse2", "e_max") for v in ("mean", "std")] + ["n"]
    row = made.row(0, named=True)
    assert (row["trajectory"], row["controller"], row["n"]) == ("ramp_pos", "pid", 3)
    assert row["rmse1_deg_mean"] == pytest.approx(1.7)
    assert row["rmse1_deg_std"] == pytest.approx(0.1)  # 1.6, 1.7, 1.8 divided by n - 1
    single = table("table_5_4_1", indicators_frame(make_logs(1)), against=None)
    assert single["rmse1_deg_std"].null_count() == single.height


def test_rows_follow_the_declared_order_and_only_what_was_tested_is_there() -> None:
    logs = [make_log("cycloid_pos", "ffwd_pid"), make_log("cycloid_pos", "pid"), make_log("ramp_pos", "ffwd_pid")]
    made = table("table_5_4_1", indicators_frame(logs))
    order = [("ramp_pos", "ffwd_pid"), ("cycloid_pos", "pid"), ("cycloid_pos", "ffwd_pid")]
    assert made.select("trajectory", "controller").rows() == order
    assert table("table_5_6_1", indicators_frame(logs)).height == 0
    assert table("table_5_4_1", indicators_frame([])).height == 0


def test_different_conditions_are_never_averaged() -> None:
    low = [make_log("ramp_pos", repetition=number, amplifier="low_gain") for number in (1, 2)]
    high = [make_log("ramp_pos", repetition=number) for number in (1, 2)]
    assert table("table_5_4_1", indicators_frame(low + high))["n"].to_list() == [2, 2]
    gains = [make_log("ramp_pos", repetition=number, condition=f"gain_{number}") for number in (1, 2)]
    made = table("table_5_4_1", indicators_frame(gains))
    assert made["condition"].to_list() == ["gain_1", "gain_2"]
    assert aggregate(indicators_frame(gains), ["trajectory"])["n"].to_list() == [1, 1]


def test_published_values_beside() -> None:
    row = table("table_5_4_1", indicators_frame(make_logs(3))).row(0, named=True)
    assert (row["rmse1_deg_published_mean"], row["rmse1_deg_published_std"]) == (1.7, 0.17)
    assert row["rmse1_deg_difference"] == pytest.approx(0.0)
    assert row["e_max_deg_difference"] == pytest.approx(1.7 - 5.1)
    assert row["e_max_deg_difference_in_std"] == pytest.approx((1.7 - 5.1) / 0.34)


def test_steady_state_errors_keep_their_sign_but_are_printed_as_magnitudes() -> None:
    logs = [make_log("cycloid_pos", "pid", 1, error_deg=-0.3), make_log("cycloid_pos", "ffwd_pid", 1, error_deg=-0.3)]
    made = table("table_6_3_1", indicators_frame(logs)).row(0, named=True)
    assert made["sse_deg_mean"] == pytest.approx(-0.2)
    assert made["sse_deg_published_mean"] == -0.2
    assert made["sse_deg_difference"] == pytest.approx(0.0)
    definition = declared_tables(["table_6_3_1"])[0]
    text = to_markdown(arrange(table("table_6_3_1", indicators_frame(logs)), definition))
    assert "| cycloid_pos | 0.20 | 0.2 ± 0.12 | 0.20 | 0.2 ± 0.07 | 0.41 | 0.77 | 0.85 |" in text


def test_arrows_compare_the_feedforward_with_pid() -> None:
    made = table("table_5_5_3", measured_indicators())
    assert made.height == 18
    arrows = {
        (row["trajectory"], row["payload"], row["orientation"]): row["e_max_deg_arrow"]
        for row in made.filter(pl.col("controller") == "ffwd_pid").iter_rows(named=True)
    }
    assert arrows[("sine_0p5hz", "none", "horizontal")] == "↓"
    assert arrows[("sine_0p5hz", "brass_8p5g", "vertical")] == "↑"
    assert [arrows["cycloid_pos", payload, place] for _, payload, place in list(arrows)[:3]] == ["↑"] * 3
    assert made.filter(pl.col("controller") == "pid")["e_max_deg_arrow"].null_count() == 9
    alone = table("table_5_5_3", indicators_frame([make_log("cycloid_pos", "ffwd_pid")]))
    assert alone["e_max_deg_arrow"].to_list() == [None]


def test_table_5_6_1_is_the_ramp_and_says_so() -> None:
    adjustment = ("procedure.adjustment.positive_mpa=0.0667", "procedure.adjustment.negative_mpa=0.0333")
    cases = [
        ("unidirectional", "ldpe_300mm", ("controller/gains=simulation",)),
        ("reduced", "ldpe_300mm", ("controller/gains=reduced_friction", *adjustment)),
        ("reduced", "hdpe_300mm", ("controller/gains=reduced_compliance", *adjustment, "procedure.preload_mpa=0.5")),
    ]
    logs = [
        make_log(
            "ramp_pos",
            "ffwd_pid",
            1,
            0.0,
            ("controller/feedforward=design", *more),
            friction=f,
            tubing=t,
            condition=f + t,
        )
        for f, t, more in cases
    ]
    made = table("table_5_6_1", indicators_frame(logs))
    assert made["rmse1_deg_published_mean"].to_list() == [0.20, 0.08, 0.09]
    assert made["rmse1_deg_difference_in_std"].null_count() == 3
    text = to_markdown(arrange(made, declared_tables(["table_5_6_1"])[0]))
    assert "Cycloid (+)" in text
    assert "| ramp_pos | 0.10 | 0.20 | 0.10 (+0 %) | 0.08 | 0.10 (+0 %) | 0.09 |" in text


def test_marks_show_what_is_far_off_and_not_what_rounding_explains() -> None:
    sheet = arrange(table("table_5_5_1", measured_indicators()), declared_tables(["table_5_5_1"])[0])
    assert not [cell for row in sheet.rows for cell in row if cell.mark]
    far = arrange(table("table_5_4_1", indicators_frame(make_logs(2))), declared_tables(["table_5_4_1"])[0])
    assert far.rows[0][7].mark == "▼"
    assert any("▲ ▼" in note for note in far.notes)


def test_conditions_show_the_choices_that_vary() -> None:
    sheet = arrange_conditions(by_condition(indicators_frame(make_logs(2))))
    assert sheet.headers[:3] == ["trajectory", "controller", "n"]
    same = [make_log("ramp_pos", condition="a"), make_log("ramp_pos", condition="b")]
    assert arrange_conditions(by_condition(indicators_frame(same))).headers[0] == "condition"
    assert "published" not in arrange_conditions(by_condition(indicators_frame(same), None)).headers


def test_every_published_cell_that_was_tested_is_compared_once() -> None:
    comparison = against_published(measured_indicators(), declared_tables(NAMES[:4]))
    assert comparison.height == 96
    assert comparison["difference"].abs().max() < 0.1  # type: ignore[operator]


def test_latex_is_escaped_and_whole() -> None:
    assert escape_latex("a_b 50 % ± \\x") == r"a\_b 50 \% $\pm$ \textbackslash{}x"
    text = to_latex(arrange(table("table_5_5_3", measured_indicators()), declared_tables(["table_5_5_3"])[0]))
    rows = [line for line in text.splitlines() if line.endswith("\\\\") and "multicolumn" not in line]
    assert {line.count("&") for line in rows} == {7}
    assert text.count("\\begin") == text.count("\\end") == 2
    assert text.isascii()


def test_a_users_table_comes_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "conf" / "table"
    folder.mkdir(parents=True)
    (folder / "table_5_4_1.yaml").write_text("title: mine\nindicators: [sse_deg]\nby: {trajectory: []}\nwhere: {}\n")
    monkeypatch.chdir(tmp_path)
    (definition,) = declared_tables(["table_5_4_1"])
    assert definition.title == "mine"
    assert build_table(indicators_frame(make_logs(2)), definition, "published")["n"].sum() == 4


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("- 1", "must hold names"),
        ("title: [", "bad.yaml"),
        ("title: a", "'indicators' is missing"),
        ("title: a\nindicators: [rmse1]\nby: {trajectory: []}", "did you mean 'rmse1_deg'"),
        ("title: a\nindicators: [sse_deg]\nby: {trajectry: []}", "did you mean 'trajectory'"),
        ("title: a\nindicators: [sse_deg]\nby: {trajectory: []}\nnote: x", "did you mean 'notes'"),
        ("title: a\nindicators: [sse_deg]\nby: {trajectory: []}\nacross: [{title: b}]", "'where' is missing"),
        ("title: a\nindicators: [sse_deg]\nby: {trajectory: []}\narrows: {group: controller}", "'of' is missing"),
        ("title: a\nindicators: [sse_deg]\nby: {trajectory: 3}", "a list"),
        ("title: a\nindicators: sse_deg\nby: {trajectory: []}", "a list"),
    ],
)
def test_a_bad_definition_is_refused(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(text)
    with pytest.raises(UsageError, match=message):
        read_definition(path)
