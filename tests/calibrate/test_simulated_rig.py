"""From the simulated rig to the report: campaigns run, constants come back, the figures of chapter 4 are drawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from random_rigs import draw_rig, run_campaign

from hjcamp.configuration.composer import Composer
from hjcamp.configuration.setups import configuration_for
from hjcamp.plants.pump_joint.calibrate.identify import identify
from hjcamp.plants.pump_joint.calibrate.validation import validate
from hjcamp.plants.pump_joint.studies.identification import identification_pictures


@pytest.fixture(autouse=True)
def empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("HJCAMP_CONF", raising=False)


def test_a_random_rig_is_recovered() -> None:
    rig, composer = draw_rig(4), Composer()
    # without its leak, which none of these tests reads: with it a kernel would be compiled for this test alone
    tight = [line for line in rig.overrides if "effects.leakage" not in line]
    asked = {
        "compliance": "",
        "pump_step": "",
        "friction": "[040_deg_per_s,160_deg_per_s,640_deg_per_s,1280_deg_per_s]",
    }
    logs = [log for name, some in asked.items() for log in run_campaign(name, tight, composer, 2, some)]
    found = identify(logs, configuration_for)
    allowed = {"viscous": 0.25, "static": 0.1, "coulomb": 0.1, "pump": 0.02, "line": 0.01}
    compared = 0
    for name, truth in rig.truth.items():
        if not name.startswith("leakage"):
            assert found.estimates[name].value == pytest.approx(truth, rel=allowed[name.partition("_")[0]]), name
            compared += 1
    assert compared == 12
    assert found.findings["pump_step"].facts["order chosen"] == "3"


def test_open_loop_validation_draws_model_against_measurement() -> None:
    logs = run_campaign("open_loop_validation", [], Composer(), 2)
    logs = [
        type(log)(log.columns, {**log.metadata, "trajectory": "sine_2hz_open_loop", "controller": "open_loop"}) for log in logs
    ]
    found = validate(logs, configuration_for)
    assert [chart.figure for chart in found.charts] == ["4.6.3", "4.6.4"]
    measured, model = (found.charts[0].series[number].y for number in (0, 1))
    assert 80 < np.ptp(measured) / 2 < 130
    assert float(found.facts["rms difference of arm_deg"]) < 3.0
    assert np.corrcoef(measured, model)[0, 1] > 0.99
    pictures = identification_pictures(logs)
    assert len(pictures) == 2 and all(svg.startswith("<svg") for svg, _ in pictures.values())


def test_other_campaigns_have_no_pictures_of_chapter_4() -> None:
    logs = run_campaign("open_loop_validation", [], Composer(), 1)
    assert identification_pictures([type(log)(log.columns, {"campaign": "controllers"}) for log in logs]) == {}
