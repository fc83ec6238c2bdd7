"""A user's own table: what is read, and what is refused with its line and column."""

import math

import pytest

from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.tables.printed import check_names, printed_cells
from hjcamp.plants.pump_joint.tables.question import asked, held_out
from hjcamp.plants.pump_joint.tables.table_file import read_table

HEAD = "trajectory,controller,tests,rmse1_deg,rmse1_deg_deviation,sse_deg,sse_deg_deviation\n"
ROW = "ramp_pos,pid,4,1.7,0.2,,\n"


def written(tmp_path, text):
    path = tmp_path / "table.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_means_and_standard_errors_are_read(tmp_path):
    cells = read_table(written(tmp_path, HEAD + ROW + "cycloid_pos,pid,4,1.3,0.4,-0.2,0.1\n"))
    assert cells.means.tolist() == [1.7, 1.3, -0.2]
    assert cells.error_of_mean.tolist() == pytest.approx([0.1, 0.2, 0.05])
    # 10 % for the form of the model beside 0.1 of 1.7; 0.1 deg beside 0.05 deg; five simulated tests scatter as much
    assert cells.sigma[0] == pytest.approx(math.hypot(0.1 / 1.7, 0.2 / math.sqrt(5) / 1.7, 0.10))
    assert cells.sigma[2] == pytest.approx(math.hypot(0.05, 0.1 / math.sqrt(5), 0.10))
    assert cells.errors(cells.means * math.e)[0] == pytest.approx(1.0 / cells.sigma[0])


def test_a_table_of_a_run_is_read_as_it_is(tmp_path):
    head = "trajectory,controller,rmse1_deg_mean,rmse1_deg_std,n,payload,rmse1_deg_published_mean,rmse1_deg_published_std,"
    head += "rmse1_deg_difference,rmse1_deg_difference_in_std,published_differs\n"
    cells = read_table(written(tmp_path, head + "ramp_pos,pid,1.5,0.2,4,none,1.7,0.18,-0.2,-1.1,\n"))
    assert cells.means.tolist() == [1.5] and cells.error_of_mean.tolist() == pytest.approx([0.1])
    assert cells.conditions == [{"trajectory": "ramp_pos", "controller": "pid", "payload": "none"}]
    with pytest.raises(UsageError, match="'rmse1_deg' stands there twice"):
        read_table(written(tmp_path, HEAD.replace("sse_deg,", "rmse1_deg_mean,") + ROW))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (HEAD + "ramp_pos,pid,4,1.7,,,\n", "line 2, column rmse1_deg_deviation: empty"),
        (HEAD + "ramp_pos,pid,4,,0.2,,\n", "line 2, column rmse1_deg: empty"),
        (HEAD + "ramp_pos,pid,4,1.7\n", "line 2: 4 cells"),
        (HEAD + "ramp_pos,,4,1.7,0.2,,\n", "column controller: empty"),
        (HEAD + ROW + ROW, "line 3: the condition ramp_pos pid stands in an earlier line"),
        (HEAD + "ramp_pos,pid,1,1.7,0.2,,\n", "column tests: 1"),
        (HEAD + "ramp_pos,pid,4,much,0.2,,\n", "column rmse1_deg: 'much' is no number"),
        (
            HEAD + "\n" + ROW + ",,,,,,\nmixed,pid,4,NA,NA,,\n",
            "line 5, column rmse1_deg: 'NA' is no number; what was not measured",
        ),
        (HEAD + "ramp_pos,pid,4,-1.7,0.2,,\n", "neither can be so"),
        (HEAD.replace("rmse1_deg", "rmse1_rad") + ROW, "its unit is rad; give degrees, as rmse1_deg"),
        (HEAD.replace("rmse1_deg_deviation", "rmse1_deg_spread") + ROW, "no column rmse1_deg_deviation"),
        (HEAD.replace("tests", "test_count") + ROW, "column tests is missing"),
        ("trajectory,tests,rise_time_ms\nramp_pos,4,3\n", "unknown indicator 'rise_time_ms'"),
        (HEAD, "one line for each condition"),
        (HEAD.replace(",", ";") + ROW.replace(",", ";"), "parted by semicolons"),
        (
            HEAD.replace("sse", "e_max") + "mixed,pid,4,1.7,0.2,0.05,0.01\n",
            "1.7 is above the largest error, e_max_deg 0.05",
        ),
    ],
)
def test_bad_tables_are_refused_with_their_place(tmp_path, text, said):
    with pytest.raises(UsageError) as refused:
        read_table(written(tmp_path, text))
    assert said in str(refused.value)


def test_rows_are_matched_with_the_conditions_of_the_campaign(tmp_path):
    question = asked([str(written(tmp_path, HEAD + ROW)), "campaign=controllers"])
    assert [one.name for one in question.conditions] == ["ramp_pos__pid"]
    assert held_out(question) is None
    assert any("at least" in one for one in question.lacking)
    with pytest.raises(UsageError, match="did you mean 'ramp_pos pid'"):
        asked([str(written(tmp_path, HEAD + ROW.replace("ramp_pos", "ramp_poss"))), "campaign=controllers"])


@pytest.mark.parametrize(
    ("head", "row", "said"),
    [
        ("trajectory,rise_time_ms,", "ramp_pos,30,", "unknown column 'rise_time_ms'"),
        (
            "trajectory,controller,",
            "ramp_poss,pid,",
            "condition ramp_poss pid: unknown trajectory 'ramp_poss'; did you mean",
        ),
    ],
)
def test_a_row_that_cannot_be_composed_says_where(tmp_path, head, row, said):
    text = f"{head}tests,rmse1_deg,rmse1_deg_deviation\n{row}4,1.7,0.2\n"
    with pytest.raises(UsageError) as refused:
        asked([str(written(tmp_path, text))])
    assert "table " in str(refused.value) and "table.csv" in str(refused.value) and said in str(refused.value)


def test_printed_tables_hold_every_measured_cell_once():
    assert [len(printed_cells([table])) for table in ("5.4.1", "5.4.2", "5.5.1", "5.5.2")] == [42, 4, 42, 8]


def test_unknown_tables_and_doubled_ones_are_refused():
    with pytest.raises(UsageError, match=r"5\.4\.1"):
        check_names(["5.4.11"])
    with pytest.raises(UsageError, match="each table once"):
        check_names(["5.4.1", "5.4.1"])
