"""Machines in open loop of which little is known: what swings undamped is held by no loop, constant levels are no switch."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from hjcamp.commands.any_plant.next_answer import _left_out, _prediction, no_campaign, sentences
from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.design.menu import menu
from hjcamp.diagnosis.design.truth import held_by_loop
from hjcamp.records.log import TestLog

PLANT = '''"""A weight on a spring."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, sensor


class Swing(Plant):
    """A weight on a spring, pushed, without any loss."""

    place = State("m", typical=1.0)
    speed = State("m/s", typical=3.0)
    push = Input("N", typical=1.0)
    mass = Parameter("kg", 1.0, (0.1, 10.0), "log-uniform", base=True)
    stiffness = Parameter("N/m", {stiffness})
    period = 0.02
    place_m = Measured("ruler", of="place")

    @staticmethod
    def equations(state, parameter, drive, rate):
        rate.place = state.speed
        rate.speed = (drive.push - parameter.stiffness * state.place) / parameter.mass
        ruler = sensor(state.place)
'''


@pytest.fixture
def plants(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    return tmp_path / "plants" / "swing.py"


def logs_of(stiffness: float, pushes: tuple[float, ...], samples: int = 600) -> list[TestLog]:
    """Constant pushes from rest, in closed form."""
    generator, time = np.random.default_rng(7), 0.02 * np.arange(samples)
    found = []
    for number, push in enumerate(pushes):
        way = push / stiffness * (1.0 - np.cos(np.sqrt(stiffness) * time)) if stiffness else 0.5 * push * time**2
        columns = {"time_s": time, "place_m": way + 1e-3 * generator.standard_normal(samples), "push_n": np.full(samples, push)}
        found.append(TestLog(columns, {"plant": "swing", "period_s": "0.02", "condition": str(number)}))
    return found


@pytest.mark.parametrize(("stiffness", "held"), [(9.0, False), (0.0, True)])
def test_what_swings_back_for_ever_is_held_by_no_loop_and_what_stays_displaced_is(
    plants: Path, stiffness: float, held: bool
) -> None:
    plants.write_text(PLANT.format(stiffness=stiffness))
    analysis = calibrated(measured_tests(logs_of(stiffness, (1.0, 1.4))), {}, unknowns=False)
    assert held_by_loop(analysis) is held


def test_an_input_that_keeps_one_value_in_each_test_is_no_switch(plants: Path) -> None:
    plants.write_text(PLANT.format(stiffness=9.0))
    levels = {one.name: one for one in menu(measured_tests(logs_of(9.0, (1.0, 1.4))), 300, by_motion=False)}
    assert np.all(levels["push_at_50"].inputs[:, 0] == pytest.approx(1.2))
    assert "0_half" in levels and np.all(levels["0_half"].inputs[:, 0] == 0.5)
    switched = logs_of(9.0, (1.0, 1.4))
    switched[0].columns["push_n"][:100] = 1.4
    assert "push_at_50" not in {one.name for one in menu(measured_tests(switched), 300, by_motion=False)}


def test_sets_that_are_not_told_apart_and_a_campaign_that_is_not_written_are_said() -> None:
    sets = [["spring"], ["leak", "stop"], ["drag"], ["lag"], ["offset"]]
    rivals = [SimpleNamespace(name=name) for name in ("spring", "leak + stop", "drag", "lag")]
    done = SimpleNamespace(
        diagnosis={"confidence_set": sets}, proposal=SimpleNamespace(question=SimpleNamespace(rivals=rivals), by_motion=True)
    )
    assert _left_out(done) == [  # type: ignore[arg-type]
        "The tests do not rule out offset either; 4 are distinguished at once: --rivals A,B names others."
    ]
    done.diagnosis = {"confidence_set": sets[:4]}
    assert _left_out(done) == []  # type: ignore[arg-type]
    assert "a loop outside the plant's equations" in no_campaign(done.proposal)  # type: ignore[arg-type]


def test_where_a_rival_runs_away_in_every_test_that_is_said() -> None:
    rivals = [SimpleNamespace(name=name, fitted=True) for name in ("cubic_spring", "spring")]
    proposal = SimpleNamespace(question=SimpleNamespace(rivals=rivals), tried=0, chosen=0, tests=(), together={})
    done = SimpleNamespace(
        diagnosis={"unknowns": []}, proposal=proposal, analysis=SimpleNamespace(search=SimpleNamespace(library={}))
    )
    rivals[0].names, rivals[1].names = (), ()
    assert sentences(done) == [  # type: ignore[arg-type]
        "Every test generated from these logs makes a rival diverge, or goes far beyond what the logs visited."
    ]


def test_values_of_a_rival_that_run_away_do_not_spoil_its_band() -> None:
    def drawn(reading: float) -> SimpleNamespace:
        layout = SimpleNamespace(
            of_test=np.array([0]), width=3, readings=np.full((3, 1), reading), time=np.arange(3.0), measured=None
        )
        return SimpleNamespace(layout=layout)

    proposal = SimpleNamespace(
        question=SimpleNamespace(rivals=[SimpleNamespace(name="spring")]),
        truths=[[drawn(2.0), drawn(1.0), drawn(np.inf), drawn(3.0)]],
    )
    sensors = [SimpleNamespace(scale=1.0)]
    done = SimpleNamespace(proposal=proposal, analysis=SimpleNamespace(measured=SimpleNamespace(sensors=sensors)))
    found = _prediction(done, SimpleNamespace(place=0, wanted=SimpleNamespace(text="a test")))  # type: ignore[arg-type]
    assert found.means["spring"][0, 0] == 2.0 and found.spreads["spring"][0, 0] == 1.0
