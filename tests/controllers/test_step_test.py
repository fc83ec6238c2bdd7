"""Gains by a step test: SIMC's rules as printed, lags that a response has by construction, and the command for a user's plant."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from answer_schemas import check_answer
from plant_texts import SLAB
from scipy.signal import TransferFunction, lsim

from hjcamp.campaign.tuning.step_test import Lags, fitted_lags, simc, step_test
from hjcamp.cli import run
from hjcamp.commands.shared.plant_template import TEMPLATE
from hjcamp.configuration.composer import Composer

PERIOD = 1e-9


@pytest.fixture
def carriage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("plants").mkdir()
    Path("plants/carriage.py").write_text(TEMPLATE.format(title="Carriage"), encoding="utf-8")


@pytest.mark.parametrize(
    ("slope", "leak", "lag", "delay", "series"),
    [
        (0.5, 0.05, 0.0, 1.0, (1.0, 8.0, 0.0)),  # k' = 0.5, tau_1 = 20: Kc = 1 / (0.5 * 2), tau_I = 8 theta
        (0.5, 0.5, 0.0, 1.0, (1.0, 2.0, 0.0)),  # tau_1 = 2 below 8 theta: it is the integral time
        (1.0, 0.0, 0.0, 1.0, (0.5, 8.0, 0.0)),  # integrating: Kc = 0.5 / theta
        (1.0, 0.0, 2.0, 1.0, (0.5, 8.0, 2.0)),  # integrating with lag
        (100.0, 0.0, 100.0, 1.0, (0.0625, 8.0, 8.0)),  # double integrating, k'' = 1: Kc = 0.0625 / theta^2
        (1.0, 0.0, 0.8, 0.6, (0.5 / 0.6 * 1.0, 4.8, 0.8)),
        (1.0, 0.0, 0.5, 0.75, (0.5, 8.0, 0.0)),  # a lag below the delay: half of it is delay
    ],
)
def test_the_rules_are_those_that_are_printed(
    slope: float, leak: float, lag: float, delay: float, series: tuple[float, float, float]
) -> None:
    time, gains = simc(Lags(slope, leak, lag, delay, 0.0), PERIOD, 0.0)
    gain, integral, derivative = series
    found = {"kp": gain * (1.0 + derivative / integral), "ki": gain / integral, "kd": gain * derivative}
    assert gains == pytest.approx(found, rel=1e-3)
    assert time == pytest.approx(delay + (0.5 * lag if lag <= delay else 0.0), rel=1e-6)
    slower, _ = simc(Lags(slope, leak, lag, delay, 0.0), PERIOD, 0.0, 5.0)
    assert slower == 5.0


@pytest.mark.parametrize(
    ("leak", "lag", "delay", "seconds"),
    [(0.5, 0.1, 0.0, 12.0), (0.0, 0.4, 0.3, 4.0), (2.0, 0.25, 0.2, 6.0), (0.0, 3.0, 0.0, 14.0)],
)
def test_lags_of_a_response_are_found_again(leak: float, lag: float, delay: float, seconds: float) -> None:
    period = seconds / 800
    time = np.arange(800) * period
    _, response, _ = lsim(TransferFunction([-3.0], [lag, 1.0 + leak * lag, leak]), np.ones(800), time)
    late = round(delay / period)
    response = np.concatenate([np.zeros(late), response])[:800]
    found = fitted_lags(response, period)
    assert found is not None and found.left < 1e-3
    assert (found.slope, found.leak) == pytest.approx((-3.0, leak), rel=0.01, abs=1e-9)
    assert found.lag == pytest.approx(lag, rel=0.02) and found.delay == pytest.approx(delay, abs=0.01 * seconds)


def test_what_stays_or_is_no_number_has_no_lags() -> None:
    assert fitted_lags(np.zeros(50), 0.1) is None and fitted_lags(np.full(50, math.nan), 0.1) is None


@pytest.mark.parametrize("coulomb", [2.0, 20.0, 90.0])
def test_dry_friction_is_no_part_of_what_the_carriage_shows(carriage: None, coulomb: float) -> None:
    config = Composer().compose(["plant=carriage", "controller=given", f"+parameters.coulomb={coulomb}"]).config
    found = step_test(config, "plain_pid")
    assert found.response.lag == pytest.approx(95.0 / 200.0, rel=1e-3) and found.response.leak == 0.0
    assert found.response.slope == pytest.approx(35.0 / 200.0, rel=1e-3)
    # its lag is beyond 4 (tau_c + theta) of 1.5 samples and half of the five over which the derivative is taken
    both = 2.0 * 4e-3
    assert found.gains["kp"] == pytest.approx(2.0 * 95.0 / 35.0 / (4.0 * both**2), rel=0.01)
    assert found.gains["kd"] == pytest.approx(95.0 / 35.0 / both, rel=0.01) and 0.0 < found.overshoot < 0.4


def test_gains_are_kept_and_close_the_loop_of_a_run(carriage: None, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["tune", "plant=carriage", "--as", "mine", "--time-ms", "20", "--json", "a.json"]) == 0
    answer = json.loads(Path("a.json").read_text())
    check_answer(answer)
    [case] = answer["cases"]
    assert (
        case["method"] == "step"
        and case["closed_s"] == pytest.approx(0.02)
        and case["file"] == "conf/controller/gains/mine.yaml"
    )
    assert "use controller=plain_pid +controller/gains=mine" in capsys.readouterr().out.replace("\n", " ")
    config = Composer().compose(["plant=carriage", "controller=plain_pid", "+controller/gains=mine"]).config
    assert {key: config["controller"][key] for key in case["gains"]} == pytest.approx(case["gains"], rel=1e-3)
    assert run(["tune", "plant=carriage", "--as", "mine"]) == 2
    assert "exists" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["plant=carriage", "--step", "0.1"], "a step of 'voltage' to 0.1 (V) moves nothing; give a larger --step"),
        (["plant=carriage", "--step", "nan"], "--step nan: a finite number other than 0 is needed"),
        (["plant=carriage", "--step", "0"], "--step 0: a finite number other than 0 is needed"),
        (["plant=carriage", "--time-ms", "inf"], "--time-ms inf: a finite number other than 0 is needed"),
        (["plant=carriage", "controller=given"], "a step test gives the gains of a PID: controller=plain_pid"),
        (["plant=carrage"], "did you mean 'carriage'"),
        (["plant=valve_joint"], "say which with controller.input=NAME"),
        (["--step", "3"], "add plant=NAME"),
        (["campaign=leakage", "--time-ms", "3"], "leave the campaign out"),
        (["plant=swing"], "neither settles without swinging nor rises steadily"),
    ],
)
def test_what_has_no_step_test_is_refused_in_a_line(
    carriage: None, words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    swing = SLAB.replace("class Slab", "class Swing").replace(
        "    power =", '    rate_of = State("K/s", typical=20.0)\n    power ='
    )
    swing = swing.replace(
        "rate.warmth = (drive.power - parameter.loss * state.warmth) / parameter.capacity",
        (
            "rate.warmth = state.rate_of\n"
            "        rate.rate_of = (drive.power - parameter.loss * state.warmth) / parameter.capacity / parameter.second"
        ),
    ).replace("    loss =", '    second = Parameter("s", 1.0)\n    loss =')
    Path("plants/swing.py").write_text(swing, encoding="utf-8")
    assert run(["tune", *words]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1
