"""Courses of one input become a campaign that `hjcamp run` can make."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from carriage import PERIOD, measured_log

from hjcamp.analyses.data import Data
from hjcamp.backends.plant_simulation import reference_of
from hjcamp.campaign.plan.campaign_file import read_campaign
from hjcamp.commands.any_plant.next_answer import no_campaign
from hjcamp.commands.any_plant.next_campaign import written_campaign
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.design.menu import menu

SAMPLES = 1000


def test_a_course_of_an_input_is_a_campaign(axis: Path) -> None:
    measured = measured_tests([measured_log(seconds=3.0)])
    names = ("voltage_steps", "voltage_at_75")
    wanted = {one.name: one for one in menu(measured, SAMPLES, by_motion=False)}
    tests = [SimpleNamespace(wanted=wanted[name], repetitions=2, place=k) for k, name in enumerate(names)]
    drawn = SimpleNamespace(starts=np.array([[0.01, 0.0], [0.02, 0.1]]), layout=SimpleNamespace(of_test=np.array([0, 1])))
    rivals = [SimpleNamespace(name="spring"), SimpleNamespace(name="nothing")]
    proposal = SimpleNamespace(tests=tests, chosen=2, truths=[[drawn]], question=SimpleNamespace(rivals=rivals))
    done = SimpleNamespace(proposal=proposal, analysis=SimpleNamespace(measured=measured))
    path = written_campaign(done, SimpleNamespace(paths=[Path("logs")]), None)  # type: ignore[arg-type]
    assert path == Path("campaigns/next_1.yaml")
    content = yaml.safe_load(path.read_text(encoding="utf-8"))
    read_campaign(content, "next_1")
    # `hjcamp run` gives the plant what was simulated; a jump may take the sample at which it is
    for name in names:
        trajectory = {"kind": "segments", "segments": content["vary"]["test"][name]["trajectory.segments"]}
        config = {
            "plant": {"name": "axis"},
            "controller": {"name": "given", "input": "voltage"},
            "trajectory": trajectory,
        }
        every = round(PERIOD / measured.plant.period)
        reference = reference_of(config, measured.plant)[0][::every, 0]
        assert len(reference) == SAMPLES
        assert np.mean(np.abs(reference - wanted[name].inputs[:, 0]) > 1e-6) < 0.02
    said = path.read_text(encoding="utf-8")
    assert "start.position: 0.02" in said and "set apart spring and nothing" in said
    # the pieces of a course are as long as the test
    assert sum(seconds for _, seconds in wanted["voltage_steps"].pieces) == pytest.approx(SAMPLES * PERIOD)


def test_a_measured_test_made_smaller_is_no_campaign(axis: Path) -> None:
    measured = measured_tests([measured_log(seconds=3.0)])
    half = next(one for one in menu(measured, SAMPLES, by_motion=False) if one.name.endswith("_half"))
    proposal = SimpleNamespace(tests=[SimpleNamespace(wanted=half, repetitions=1, place=0)], chosen=1)
    done = SimpleNamespace(proposal=proposal, analysis=SimpleNamespace(measured=measured))
    assert written_campaign(done, Data.__new__(Data), None) is None  # type: ignore[arg-type]
    assert not Path("campaigns").exists()
    proposal.by_motion = False
    assert f"'{half.text}' is a measured test that is changed" in no_campaign(proposal)  # type: ignore[arg-type]
