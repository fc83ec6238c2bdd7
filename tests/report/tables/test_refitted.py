"""Printed, refitted and measured side by side; a report of one repetition."""

import json

import polars as pl
import pytest
from report_samples import make_logs

from hjcamp.commands.runs.report import of_repetition
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.published import refitted
from hjcamp.records.write import write_log
from hjcamp.report.build import build_report
from hjcamp.report.pages.page import build_page
from hjcamp.report.tables.terminal import refitted_table

PLACE = {"trajectory": "mixed", "controller": "pid", "payload": "brass_8p5g", "orientation": "vertical"}
NAMES = ("rmse1_deg", "rmse2_deg", "e_max_deg")


@pytest.fixture
def shipped(tmp_path, monkeypatch):
    values = tmp_path / "refit.json"
    rows = [
        {"choices": PLACE, "indicator": name, "simulated": {"published": 9.0, "accepted": 2.0 + place}}
        for place, name in enumerate(NAMES)
    ]
    fitted = {"drop_positive": (1.37, 1.9), "viscous_positive": (23.5, 116.9), "feedforward_gain": (1.0, 0.47)}
    quantities = {name: {"published": before, "value": after} for name, (before, after) in fitted.items()}
    models = {"published": {}, "accepted": {"quantities": quantities}}
    found = {"tables": ["5.4.1", "5.4.2"], "models": models, "cells": [], "cells_held_out": rows}
    values.write_text(json.dumps(found), encoding="utf-8")
    monkeypatch.setattr(refitted, "VALUES", values)
    refitted.refitted_means.cache_clear()
    yield
    refitted.refitted_means.cache_clear()


def conditions(measured):
    row = {"condition": "mixed__pid", **PLACE, "friction": "bidirectional", "tubing": "ldpe_300mm"}
    for place, name in enumerate(NAMES):
        row |= {f"{name}_mean": 20.0 + place, f"{name}_published_mean": measured}
    return pl.DataFrame([row])


def test_each_condition_stands_with_its_three_values(shipped):
    sheet = refitted.against_refit(conditions(1.8))
    [row] = sheet.rows
    assert [cell.text for cell in row] == [
        "mixed__pid",
        "20.00",
        "2.00",
        "1.8",
        "21.00",
        "3.00",
        "1.8",
        "22.00",
        "4.00",
        "1.8",
    ]
    assert "Table 5.4.1 and Table 5.4.2" in sheet.notes[0]


def test_why_is_said_in_the_numbers_of_the_fit_and_of_the_run(shipped):
    why = refitted.against_refit(conditions(1.8)).notes[1]
    assert "1.4 times Coulomb friction" in why and "viscous friction of 24 N s/m" in why
    assert "117 N s/m and 0.47 of the feedforward" in why
    assert "off by 18.20 deg on average as printed and by 0.20 deg refitted, which is nearer in 1 of 1 conditions." in why


def test_the_terminal_shows_the_first_indicator_in_three_columns(shipped):
    table = refitted_table(refitted.against_refit(conditions(1.8))).sheet
    assert table.headers == ["condition", "RMSE1 as printed", "refitted", "measured"]
    assert [[cell.text for cell in row] for row in table.rows] == [["mixed__pid", "20.00", "2.00", "1.8"]]


def test_the_picture_of_all_conditions_comes_before_the_table(shipped):
    """The report begins with the dot plot (a picture first)."""
    page = "".join(
        build_page(title="a", facts=[], verdict="", overview='<svg viewBox="0 0 9 9"></svg>', sheets=[], pictures={}, origin=[],
                   command="", configuration="", open_sheet=refitted.against_refit(conditions(1.8)),
                   further={"Gain of output over input": ('<svg viewBox="0 0 9 9"></svg>', "-3 dB at 20.7 Hz")})
    )  # fmt: skip
    # what the campaign is for comes before what every campaign has
    assert page.index("-3 dB at 20.7 Hz") < page.index("every condition: mean")
    assert page.index("every condition: mean") < page.index('id="refitted"') < page.index('id="tables"')
    assert "`" not in page[page.index('id="refitted"') : page.index('id="tables"')]


def test_nothing_stands_beside_what_was_not_measured_or_not_refitted(shipped, tmp_path, monkeypatch):
    assert refitted.against_refit(conditions(None)) is None
    monkeypatch.setattr(refitted, "VALUES", tmp_path / "none.json")
    refitted.refitted_means.cache_clear()
    assert refitted.against_refit(conditions(1.8)) is None


def test_one_repetition_is_read_alone_and_one_that_is_not_there_is_refused(tmp_path):
    logs = make_logs()
    for number, log in enumerate(logs):
        write_log(tmp_path / f"{number}.mcap", log)
    chosen = logs[0].metadata["repetition"]
    expected = sum(log.metadata["repetition"] == chosen for log in logs)
    assert 0 < len(of_repetition(tmp_path, int(chosen))) == expected < len(logs)
    for number in ("1", "2"):
        alone = [log for log in logs if log.metadata["repetition"] == number]
        build_report(tmp_path, output=tmp_path / number, logs=alone)
        said = "repetition 2 alone" in (tmp_path / number / "report.html").read_text(encoding="utf-8")
        assert alone and said == (number == "2")
    with pytest.raises(UsageError, match="--repetition 99: no log"):
        of_repetition(tmp_path, 99)
