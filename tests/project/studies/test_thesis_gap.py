"""The reference's own case: page, model and shipped means are what the committed answer says."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml

from hjcamp.plants.pump_joint.published import refitted
from hjcamp.plants.pump_joint.published.values import cell_key
from hjcamp.plants.pump_joint.tables.page import PICTURE, page

ROOT = Path(__file__).parents[3]
ANSWER = json.loads((ROOT / "docs" / "thesis_gap.json").read_text(encoding="utf-8"))


def test_the_page_is_what_the_committed_answer_says() -> None:
    told = (ROOT / "docs" / "thesis_gap.md").read_text(encoding="utf-8")
    assert told == page(ANSWER).replace(f"({PICTURE})", "(images/thesis_gap.png)")
    assert [len(ANSWER[key]) for key in ("cells", "cells_held_out")] == [46, 50]
    assert {row["choices"]["payload"] for row in ANSWER["cells"]} == {"none"}
    assert {row["choices"]["payload"] for row in ANSWER["cells_held_out"]} == {"brass_8p5g"}


def test_the_shipped_model_is_the_last_of_the_answer() -> None:
    model = yaml.safe_load((ROOT / "conf" / "model" / "refit.yaml").read_text(encoding="utf-8"))
    settings = list(ANSWER["models"].values())[-1]["settings"]
    assert {key: model[key] for key in settings} == {
        key: given if key == "effects" else pytest.approx(given, rel=1e-6) for key, given in settings.items()
    }
    assert model["provenance"]["tables"] == ["5.4.1", "5.4.2"] and model["provenance"]["command"] == ANSWER["command"]


def test_the_means_beside_a_report_are_those_of_the_answer() -> None:
    assert json.loads(refitted.VALUES.read_text(encoding="utf-8")) == ANSWER
    refitted.refitted_means.cache_clear()
    last = list(ANSWER["models"])[-1]
    for row in ANSWER["cells_held_out"]:
        found = refitted.refitted_means()[(*cell_key(row["choices"]), row["indicator"])]
        assert found == row["simulated"][last]


def test_the_ramps_alone_ask_for_a_stronger_integral() -> None:
    # a mean error of 120 / (Ki k) is never above RMSE2, which is printed to 0.1 deg
    rows = {(row["condition"], row["indicator"]): row["measured"] for row in ANSWER["cells"]}
    for trajectory, gain, least in (("ramp_pos", 70.0, 1.27), ("ramp_neg", 90.0, 1.40)):
        printed = rows[f"{trajectory} pid none horizontal", "rmse2_deg"]
        assert 120.0 / (gain * (printed + 0.05)) == pytest.approx(least, abs=0.01)
