"""A parameter that is no constant is outside the library: what it depends on is said, its curve drawn, and a file begun from it."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from asked import asked
from scipy.integrate import solve_ivp

from hjcamp.commands.any_plant.law_words import described_term
from hjcamp.commands.shared.effect_from import begun_from
from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.candidates.nonparametric_terms import values_of
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.decision.free_curve import knots_of
from hjcamp.diagnosis.decision.verdict import Verdict
from hjcamp.diagnosis.design.rivals import question_of
from hjcamp.diagnosis.estimation.gauss_newton import Free
from hjcamp.diagnosis.results.answer import answer
from hjcamp.diagnosis.selection.search import Search
from hjcamp.effects import load_effects
from hjcamp.effects._curve_template import curve_template
from hjcamp.errors import UsageError
from hjcamp.known_plants import find_plant
from hjcamp.model.checks.place_checks import PlaceBench, PlainModel
from hjcamp.model.compile.compose import Composition
from hjcamp.model.compile.kernel import kernel_source
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.model.language.effect_units import check_units
from hjcamp.records.log import TestLog

AREA, OUTFLOW, HEAT, LOWEST = 0.5, 5e-3, 4.2e6, 0.05
PLANT = '''"""A heated tank that runs out through a long pipe."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, sensor


class Kettle(Plant):
    r"""A heated tank."""

    level = State("m", typical=0.3, low=0.0)
    warmth = State("K", typical=15.0)
    inflow = Input("m^3/s", typical=1e-3)
    power = Input("W", typical=3e4)
    area = Parameter("m^2", 0.4, (0.05, 4.0), "log-uniform", base=True)
    outflow = Parameter("m^2/s", 4e-3, (1e-4, 0.1), "log-uniform", base=True)
    heat = Parameter("J/(m^3*K)", 4.2e6)
    lowest = Parameter("m", 0.05)
    period = 2.0
    level_m = Measured("gauge", of="level")
    warmth_k = Measured("probe", of="warmth")

    @staticmethod
    def equations(state, parameter, drive, rate):
        rate.level = (drive.inflow - parameter.outflow * state.level) / parameter.area
        rate.warmth = (drive.power / parameter.heat - drive.inflow * state.warmth) / (parameter.area * (state.level + parameter.lowest))
        gauge = sensor(state.level)
        probe = sensor(state.warmth)
'''


@pytest.fixture
def kettle(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "kettle.py").write_text(PLANT, encoding="utf-8")
    return tmp_path


def thins(warmth: Any) -> Any:
    """Return how much faster what is warm runs out."""
    return 1.0 + 0.25 * np.tanh(np.asarray(warmth) / 15.0)


def measured_log(seed: int, count: int, constant: bool = False) -> TestLog:
    """Return a log of the tank, solved by SciPy."""
    generator = np.random.default_rng(seed)
    inflow = np.repeat(generator.uniform(3e-4, 2.2e-3, count // 60 + 1), 60)[:count]
    power = np.repeat(generator.uniform(0.0, 9e4, count // 130 + 1), 130)[:count]

    def rates(time: float, x: np.ndarray) -> list[float]:
        k = min(int(time // 2.0), count - 1)
        flow = OUTFLOW * (1.0 if constant else float(thins(x[1]))) * x[0]
        return [(inflow[k] - flow) / AREA, (power[k] / HEAT - inflow[k] * x[1]) / (AREA * (x[0] + LOWEST))]

    time = 2.0 * np.arange(count)
    found = solve_ivp(rates, (0.0, time[-1]), [0.2, 8.0], t_eval=time, max_step=1.0, rtol=1e-7, atol=1e-9).y
    level, warmth = found + generator.standard_normal(found.shape) * [[5e-4], [0.05]]
    columns = {"time_s": time, "level_m": level, "warmth_k": warmth, "inflow_m3_per_s": inflow, "power_w": power}
    return TestLog(columns, {"plant": "kettle", "period_s": "2.0", "condition": f"train {seed}"})


def looked_at(log: TestLog) -> tuple[Analysis, Verdict]:
    return asked(measured_tests([log]))


def test_a_flow_that_warmth_makes_faster_is_outside_with_its_driver_and_its_curve(kettle: Path) -> None:
    analysis, verdict = looked_at(measured_log(1, 1500))
    assert (verdict.word, verdict.effects) == ("outside_library", ())
    content = answer(analysis, verdict, 1.0)
    json.dumps(content)
    row = content["unknowns"][0]
    assert (row["driver"], row["quantity"], row["port"], row["slots"]) == ("warmth", "value", "outflow", ["outflow"])
    assert described_term(row) == "value of outflow that depends on warmth"
    assert row["left"] < 0.4 and content["p_value"] <= 0.05 and content["drivers"][0] == "warmth"
    # the base takes a mean value: the curve is about that, and its band holds the true one
    x, y, low, high = (np.array(row["curve"][name]) for name in ("x", "y", "low", "high"))
    knots = np.array(row["knots"]["x"])
    true = thins(x) / thins(knots).mean() - 1.0
    assert np.abs(y - true).max() < 0.04 and np.mean((low - 0.01 <= true) & (true <= high + 0.01)) > 0.8
    assert np.median(high - low) < 0.1
    # the base that is printed, times the curve as it is printed, is the law
    printed = content["calibration_with_unknown"]["outflow"]
    for there, share in ((x, y), (knots, np.array(row["knots"]["y"]))):
        assert printed["value"] * (1.0 + share) == pytest.approx(OUTFLOW * thins(there), rel=0.04)
    mean = OUTFLOW * thins(knots).mean()
    assert printed["ci95"][0] - 0.01 * mean < mean < printed["ci95"][1] + 0.01 * mean
    assert printed["ci95"][1] - printed["ci95"][0] < 0.2 * mean
    # a file of one's own begins with the curve, and does the same
    begun = begun_from(content, Path("answer.json"))
    text = curve_template("thin", begun)
    scope: dict[str, Any] = {}
    exec(compile(text, "thin.py", "exec"), scope)
    assert "def outflow(warmth, outflow, amplitude, first, last):" in text and scope["Thin"].plant == "kettle"
    # it is a rival for the next test as well
    question = question_of(analysis, content, [])
    assert question.rivals[0].names == (row["law"],)


def test_where_the_flow_is_constant_nothing_is_missing(kettle: Path) -> None:
    analysis, verdict = looked_at(measured_log(2, 900, constant=True))
    assert verdict.word == "nothing_missing"
    # predictions and balances, over whole blocks too, are noise though the test is simulated through
    assert analysis.windows.layout.memory and verdict.gate.upper < 0.1
    found = np.sqrt(analysis.channels.of(np.mean(analysis.base.features**2, axis=0)))
    # a sum over a block is one number in each block, of which there are few
    few = np.array([name.endswith("_over_a_block") for name in analysis.channels.names])
    assert few.any() and found[~few] == pytest.approx(1.0, abs=0.25) and found[few] == pytest.approx(1.0, abs=0.5)


def thinner(folder: Path, argument: str = "warmth") -> type[Effect]:
    """Return an effect on a parameter that reads ``argument``, from a file of a user's."""
    (folder / "effects").mkdir()
    (folder / "effects" / "thinner.py").write_text(
        '"""The warmer, the faster."""\n\n'
        "from hjcamp.model.declare.effect import Effect\nfrom hjcamp.model.declare.parameter import Parameter\n\n\n"
        "class Thinner(Effect):\n"
        '    r"""The warmer, the faster.\n\n    .. math:: k = k_0 (1 + sT)\n\n    Seen as: a flow. Source: a test.\n    """\n\n'
        '    plant = "kettle"\n    subsystem = "parameter"\n    slope = Parameter("1/K", 0.01, (-0.05, 0.05), off=0.0)\n\n'
        f"    @staticmethod\n    def outflow(outflow, {argument}, slope):\n"
        f"        return outflow * (1.0 + slope * {argument})\n",
        encoding="utf-8",
    )
    return load_effects(plant=find_plant("kettle"))["thinner"]


def test_an_effect_may_act_on_a_parameter_as_on_a_slot(kettle: Path) -> None:
    plant, effect = find_plant("kettle"), thinner(kettle)
    check_units(effect, plant)
    place = {"level": 0.3, "warmth": 20.0, "inflow": 1e-3, "power": 0.0, "time": 0.0}
    plain, warm = PlainModel(plant), PlainModel(plant, (effect,))
    lost = 4e-3 * 0.3 * 0.01 * 20.0 / 0.4
    assert plain.rates(place)["level"] - warm.rates(place)["level"] == pytest.approx(lost)
    share, where = PlaceBench(effect, plant).apart({})
    assert where == "rate of level" and 0.01 < share < 1.0


@pytest.mark.parametrize(
    ("argument", "said"),
    [("gauge", "uses 'gauge', which is computed later than the parameter 'outflow'"), ("warmht", "did you mean 'warmth'")],
)
def test_it_may_read_what_is_known_before_the_first_line(kettle: Path, argument: str, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        thinner(kettle, argument)


def test_what_a_contact_rubs_with_has_laws_of_its_own_over_place_speed_and_time(axis: Path) -> None:
    ranges = {"position": (-0.1, 0.1), "velocity": (-0.3, 0.3), "voltage": (-5.0, 5.0), "time": (0.0, 9.0)}
    plant = find_plant("axis")
    found = values_of(plant, plant.base_parameters, ranges)
    assert {name for name in found if "coulomb" in name} == {"unknown_value_of_coulomb_over_voltage"}
    assert {one.driver for name, one in found.items() if "_of_mass_" in name} == {"position", "velocity", "voltage", "time"}
    still = values_of(plant, plant.base_parameters, {**ranges, "position": (0.1, 0.1)})
    assert not any(one.driver == "position" for one in still.values())


def test_what_no_reading_depends_on_is_as_beside_it(kettle: Path) -> None:
    name = "unknown_value_of_outflow_over_warmth"
    law = values_of(find_plant("kettle"), ["outflow"], {"warmth": (0.0, 10.0)})[name]
    free = tuple(Free(name, knot, 1.0, -1e3, 1e3) for knot in law.amplitudes)
    slopes = np.ones((5, 3, 6))
    slopes[:, :, 4:] = 0.0
    own = dict(zip(law.amplitudes, (0.1, 0.2, 0.3, 0.4, 0.0, 0.0), strict=True))
    fitted = SimpleNamespace(free=free, slopes=slopes, candidate=Candidate({}, {name: {**law.ends, **own}}))
    analysis: Any = SimpleNamespace(search=SimpleNamespace(unknowns={name: law}))
    model: Any = SimpleNamespace(fitted=fitted)
    found = knots_of(analysis, model, name)
    assert found["x"] == [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]
    shares = np.array([1.0 + law.amount(one) for one in (0.1, 0.2, 0.3, 0.4, 0.4, 0.4)])
    # about the mean over the knots, of which those beyond count as what is beside them
    assert found["y"] == pytest.approx(shares / shares.mean() - 1.0)


REACTOR = '''"""A stirred reactor whose reaction heats it."""

from math import exp

from hjcamp.plant import Input, Measured, Parameter, Plant, State, sensor


class Reactor(Plant):
    r"""A stirred reactor."""

    matter = State("mol/m^3", typical=500.0, low=0.0)
    warmth = State("K", typical=330.0, low=250.0)
    jacket = Input("K", typical=310.0)
    pace = Parameter("1/s", 8e-4, (1e-6, 1.0), base=True)
    activation = Parameter("K", 7000.0, (500.0, 3e4), base=True)
    known_at = Parameter("K", 340.0)
    fed = Parameter("1/s", 1e-3)
    strong = Parameter("mol/m^3", 1e3)
    cool = Parameter("K", 300.0)
    heat = Parameter("K*m^3/mol", 0.04, (1e-4, 1.0), base=True)
    cooling = Parameter("1/s", 1e-3, (1e-6, 1.0), base=True)
    period = 5.0
    warmth_k = Measured("probe", of="warmth")

    @staticmethod
    def equations(state, parameter, drive, rate):
        reaction = parameter.pace * exp(parameter.activation * (1.0 / parameter.known_at - 1.0 / state.warmth)) * state.matter
        rate.matter = parameter.fed * (parameter.strong - state.matter) - reaction
        given = parameter.fed * (parameter.cool - state.warmth) - parameter.cooling * (state.warmth - drive.jacket)
        rate.warmth = given + parameter.heat * reaction
        probe = sensor(state.warmth)
'''


def test_a_parameter_in_an_exponent_may_be_no_constant(kettle: Path) -> None:
    # a share of a thousand million would overflow before any law is fitted
    (kettle / "plants" / "reactor.py").write_text(REACTOR, encoding="utf-8")
    plant = find_plant("reactor")
    laws = values_of(plant, ["activation"], {"matter": (100.0, 900.0), "warmth": (310.0, 370.0), "time": (0.0, 1e4)})
    assert len(laws) == 3
    for one in laws.values():
        generated = kernel_source(Composition(plant, (one.effect,)))
        assert "interpolated(p, " in generated and f"{one.effect.name}" in generated


@pytest.mark.parametrize(("outflow", "kept"), [(5e-3, {"area", "outflow"}), (0.1, {"area"})])
def test_a_parameter_at_its_bound_has_no_law_of_its_own(kettle: Path, outflow: float, kept: set[str]) -> None:
    free = [Free("", "area", 0.4, 0.05, 4.0), Free("", "outflow", 4e-3, 1e-4, 0.1)]
    windows = SimpleNamespace(layout=SimpleNamespace(measured=SimpleNamespace(plant=find_plant("kettle"))))
    ranges = {"level": (0.1, 0.4), "warmth": (5.0, 30.0)}
    search: Any = SimpleNamespace(windows=windows, base_free=free, ranges=ranges, drifts=dict)
    before: Any = SimpleNamespace(fitted=SimpleNamespace(candidate=Candidate({"area": 0.5, "outflow": outflow}, {})))
    assert {one.place for one in Search.values(search, before).values()} == kept
    assert {one.place for one in Search.values(search).values()} == {"area", "outflow"}
