"""Published values stand beside tests of the published configuration alone, and the indicators say what was varied."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import polars as pl
import pytest
import yaml
from report_samples import as_planned, make_log, write_plan
from report_samples import make_plan as make_sample_plan

from hjcamp.campaign.plan.planning import make_plan
from hjcamp.configuration.composer import Composer
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.published.configurations import (
    CAMPAIGNS,
    UNKNOWN,
    choices_of,
    conditions_of,
    difference,
    standing,
)
from hjcamp.plants.pump_joint.published.values import cell_key, published_cells
from hjcamp.records.log import TestLog
from hjcamp.records.read import read_log
from hjcamp.records.write import write_log
from hjcamp.report.build import Report, build_report, verdict
from hjcamp.report.check import check
from hjcamp.report.runs.indicators import COLUMNS, FURTHER
from hjcamp.report.runs.varied import indicators_frame, labels_of
from hjcamp.report.tables.aggregation import against_published, by_condition
from hjcamp.report.tables.declared import declared_tables
from hjcamp.report.tables.formats import to_latex
from hjcamp.report.tables.sheet import arrange_conditions

SOFT = "controller.positive.kp=0.7"
SOFTER = "controller.positive.kp is 0.7 instead of 1.05"


def run_of(folder: Path, logs: Sequence[TestLog], axes: dict[str, list[str]] | None = None) -> Report:
    names = list(dict.fromkeys(log.metadata["condition"] for log in logs))
    repetitions = max(int(log.metadata["repetition"]) for log in logs)
    plan = make_sample_plan(names, repetitions, ["table_5_4_1"], campaign=logs[0].metadata["campaign"])
    for log in logs:
        path = folder / "logs" / log.metadata["condition"] / f"rep_{int(log.metadata['repetition']):02d}.mcap"
        path.parent.mkdir(parents=True, exist_ok=True)
        write_log(path, as_planned(log, plan))
    write_plan(folder, replace(plan, axes=axes or {}))
    return build_report(folder, against="published")


def two_gains(repetitions: int = 2, apart_deg: float = 0.0) -> list[TestLog]:
    return [
        make_log("ramp_pos", "pid", number, 1.5 + apart_deg * place, overrides, condition=f"ramp_pos__kp-{kp}", seed=seed)
        for place, (kp, overrides) in enumerate({"0.7": (SOFT,), "1.05": ()}.items())
        for number in range(1, repetitions + 1)
        for seed in [str(100 * number + place)]
    ]


def test_a_log_from_before_a_parameter_was_known_stands_beside_the_published_value() -> None:
    log = make_log("ramp_pos", "pid", 1, 1.5, (), condition="ramp_pos__pid", seed="1")
    config = yaml.safe_load(log.attachments["config.yaml"])
    cell = cell_key({"trajectory": "ramp_pos", "controller": "pid", "payload": "none", "orientation": "horizontal"})
    assert config["controller"].pop("bumpless") == 0
    assert {one["differs"] for one in standing(config, cell)} == {""}
    config["controller"]["bumpless"] = 1.0
    assert all("controller.bumpless is 1 instead of 0" in one["differs"] for one in standing(config, cell))


def test_the_indicators_tell_two_gains_apart(tmp_path: Path) -> None:
    axes = {"trajectory": ["ramp_pos"], "controller.positive.kp": ["kp-0.7", "kp-1.05"]}
    run_of(tmp_path, two_gains(apart_deg=1.0), axes)
    for frame in (
        pl.read_csv(tmp_path / "tables/indicators.csv"),
        pl.read_parquet(tmp_path / "tables/indicators.parquet"),
    ):
        assert tuple(frame.columns) == (*COLUMNS, "condition", "seed", "log", *FURTHER, "controller.positive.kp")
        assert frame["controller.positive.kp"].to_list() == [0.7, 0.7, 1.05, 1.05]
        kept = [read_log(path) for path in sorted((tmp_path / "logs").rglob("*.mcap"))]
        assert frame["seed"].to_list() == [int(log.metadata["seed"]) for log in kept]
        assert frame["log"].to_list()[0] == "logs/ramp_pos__kp-0.7/rep_01.mcap"
        assert all((tmp_path / name).is_file() for name in frame["log"])


def test_what_varies_is_seen_without_a_plan_and_what_a_choice_brings_is_not() -> None:
    frame = indicators_frame(two_gains())
    assert frame["controller.positive.kp"].to_list() == [0.7, 0.7, 1.05, 1.05]
    choices = [make_log("ramp_pos", "pid"), make_log("cycloid_pos", "ffwd_pid", payload="brass_8p5g")]
    assert indicators_frame(choices).columns == indicators_frame(choices[:1]).columns
    effects = [make_log("ramp_pos", overrides=o, condition=str(o)) for o in ((), ("++effects.leakage.conductance=1e-13",))]
    assert indicators_frame(effects)["effects.leakage.conductance"].to_list() == [None, 1e-13]


def test_an_axis_of_cases_has_its_label_and_what_the_cases_set() -> None:
    logs = [
        make_log("ramp_pos", "pid", overrides=("controller.dither.amplitude_v=0.0",), condition="plain__ramp_pos"),
        make_log("ramp_pos", "pid", condition="with_dither__ramp_pos"),
    ]
    frame = indicators_frame(logs, {"step": ["plain", "with_dither"], "trajectory": ["ramp_pos"]})
    assert frame["step"].to_list() == ["plain", "with_dither"]
    assert frame["controller.dither.amplitude_v"].to_list() == [0.0, 1.2]
    assert (
        indicators_frame(logs, {"seed": ["plain", "with_dither"], "trajectory": ["ramp_pos"]})["axis_seed"].to_list()[0]
        == "plain"
    )


def test_labels_that_hold_the_separator_are_still_found() -> None:
    axes = {"case": ["a", "a__b"], "trajectory": ["b__c", "c"]}
    assert labels_of("a__b__c", axes) == {"case": "a", "trajectory": "b__c"}
    assert labels_of("a__b__b__c", axes) == {"case": "a__b", "trajectory": "b__c"}
    assert labels_of("elsewhere", axes) == {}


def test_every_published_cell_belongs_to_a_condition_of_its_campaign() -> None:
    conditions = {name: {choices_of(one) for one in conditions_of(name)} for names in CAMPAIGNS.values() for name in names}
    checked = 0
    for cell in published_cells().filter(pl.col("table") != "6.3.1").iter_rows(named=True):
        assert any(cell_key(cell) in conditions[name] for name in CAMPAIGNS[cell["table"]]), cell
        checked += 1
    assert checked == 96 + 4 + 18


@pytest.mark.parametrize(
    ("campaign", "condition"),
    [
        ("controllers", "mixed__ffwd_pid"),
        ("robustness_vertical", "mixed__pid"),
        ("friction_compliance", "sine_0p5hz__reduced_compliance"),
        ("feedforward_simulation", "sine_1hz"),
        ("previous_work", "ramp_pos__pid"),
    ],
)
def test_a_shipped_campaign_as_it_is_has_its_published_values(composer: Composer, campaign: str, condition: str) -> None:
    lines = [f"campaign={campaign}", f"conditions={condition}"]
    (planned,) = make_plan(composer.compose(lines).config, campaign, lines, composer).conditions
    assert "" in [one["differs"] for one in standing(planned.config, cell_key(planned.choices))]


@pytest.mark.parametrize(
    ("overrides", "metadata", "why"),
    [
        ((SOFT,), {}, SOFTER),
        (("+model.parameters.pump_area=1e-5",), {}, "model.parameters.pump_area is 1e-05 instead of absent"),
        (("+effects.leakage.conductance=1e-13",), {}, "effects.leakage.conductance is 1e-13 instead of absent"),
        (("procedure.preload_mpa=0.3",), {}, "procedure.preload_mpa is 0.3 instead of 0.26"),
        (("trajectory.amplitude_deg=80",), {}, "trajectory.amplitude_deg is 80 instead of 120"),
        ((), {"pump": "pump1", "amplifier": "low_gain"}, "pump is pump1 instead of pump2, and 7 more"),
        (("controller.positive.ki=60", SOFT), {}, "controller.positive.kp is 0.7 instead of 1.05, and 1 more"),
    ],
)
def test_another_configuration_has_a_dash_and_the_reason(
    tmp_path: Path, overrides: tuple[str, ...], metadata: dict[str, str], why: str
) -> None:
    report = run_of(tmp_path, [make_log("ramp_pos", "pid", 1, 1.5, overrides, **metadata)])
    assert list(report.differs) == [why] and report.comparison.height == 0
    frame = pl.read_csv(tmp_path / "tables" / "table_5_4_1.csv")
    assert frame["published_differs"].to_list() == [why]
    assert frame["rmse1_deg_published_mean"].to_list() == [None]
    markdown = (tmp_path / "tables" / "table_5_4_1.md").read_text(encoding="utf-8")
    assert "1.60 | – |" in markdown and why in markdown and "▲" not in markdown
    page = report.page.read_text(encoding="utf-8")
    assert why in page and 'class="far"' not in page
    assert "controller" in to_latex(report.sheets[0]) and " -- &" in to_latex(report.sheets[0])
    with pytest.raises(UsageError, match="nothing to check") as refusal:
        check(report.comparison, "default", report.differs)
    assert why in str(refusal.value)


def test_what_was_measured_stands_beside_another_model_of_the_joint(tmp_path: Path) -> None:
    report = run_of(tmp_path, [make_log("ramp_pos", "pid", 1, 1.5, ("model=refit",))])
    assert not report.differs and report.comparison.height > 0
    # its errors are not those of the printed constants
    assert 'id="refitted"' not in report.page.read_text(encoding="utf-8")
    # what was simulated with the printed constants stands beside these alone
    own = ("controller/gains=simulation", "controller/feedforward=design")
    for model, missing in ((), 0), (("model=refit",), 1):
        frame = by_condition(indicators_frame([make_log("ramp_pos", "ffwd_pid", overrides=(*own, *model))]))
        assert frame["rmse1_deg_published_mean"].null_count() == missing


@pytest.mark.parametrize(
    "overrides",
    [("rig.scatter.friction_between=0.0",), ("rig.sensors.pressure_noise_mpa=0.001",), ("backend=nidaqmx",)],
)
def test_rig_and_draws_do_not_matter(overrides: tuple[str, ...]) -> None:
    log = make_log("ramp_pos", "pid", 1, 1.5, overrides)
    assert by_condition(indicators_frame([log]))["published_differs"].to_list() == [None]


def test_an_equal_model_of_another_name_is_the_published_one() -> None:
    log = make_log("ramp_pos", "pid")
    config = yaml.safe_load(log.attachments["config.yaml"])
    published = yaml.safe_load(log.attachments["config.yaml"])
    config["model"]["name"] = "mine"
    assert difference(config, published) == []
    config["model"]["effects"] = {"leakage": {"conductance": 1e-13}}
    assert difference(config, published) == ["model is mine instead of published"]
    del config["procedure"]["rest_ms"]
    assert "procedure.rest_ms is absent instead of 200" in difference(config, published)


def test_a_log_without_its_configuration_cannot_be_set_beside() -> None:
    log = make_log("ramp_pos", "pid")
    table = by_condition(indicators_frame([TestLog(log.columns, log.metadata)]))
    assert table["published_differs"].to_list() == [UNKNOWN]
    assert table["rmse1_deg_published_mean"].to_list() == [None]


def test_each_of_two_gain_sets_is_judged_by_itself() -> None:
    logs = [
        *two_gains(1),
        make_log("ramp_pos", "pid", 1, 30.0, ("rig.scatter.friction_within=0.1",), condition="ramp_pos__scattered"),
    ]
    frame = indicators_frame(logs)
    comparison = against_published(frame, declared_tables(["table_5_4_1", "table_5_5_3"]))
    rmse1 = comparison.filter(pl.col("indicator") == "rmse1_deg")
    assert sorted(set(rmse1["condition"])) == ["ramp_pos__kp-1.05", "ramp_pos__scattered"]
    assert verdict(comparison, {SOFTER: ["ramp_pos__kp-0.7"]}) == (
        "1 of 6 means within 2 published standard deviations of the published mean, 5 outside."
        " Not judged: 1 of another configuration."
    )


def test_runs_whose_conditions_have_equal_names_are_kept_apart() -> None:
    logs = [make_log("ramp_pos", "pid", number, 1.5, overrides) for overrides in ((SOFT,), ()) for number in (1, 2)]
    sheet = arrange_conditions(by_condition(indicators_frame(logs)))
    assert sheet.headers[:3] == ["condition", "controller.positive.kp", "n"]
    assert [[cell.text for cell in row[1:3]] for row in sheet.rows] == [["0.7", "2"], ["1.05", "2"]]
    assert f"No published value is shown next to ramp_pos__pid: {SOFTER}." in sheet.notes


def test_simulated_values_of_5_3_2_stand_beside_their_own_gains_alone() -> None:
    own = make_log("ramp_pos", "ffwd_pid", overrides=("controller/gains=simulation", "controller/feedforward=design"))
    assert by_condition(indicators_frame([own]))["rmse1_deg_published_std"].to_list() == [None]
    assert by_condition(indicators_frame([own]))["rmse1_deg_published_mean"].null_count() == 0
    measured = by_condition(indicators_frame([make_log("ramp_pos", "ffwd_pid")]))
    assert measured["rmse1_deg_published_std"].null_count() == 0
