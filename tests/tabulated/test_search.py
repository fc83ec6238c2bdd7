"""The search on a rig whose answers are written down here: a hidden factor is found, and nothing where nothing is hidden."""

import math
from dataclasses import replace

import numpy as np
import pytest

from hjcamp.plants.pump_joint.tables.cells import Cells, robust
from hjcamp.plants.pump_joint.tables.diagnosis import EFFECT, NOTHING, verdict_of
from hjcamp.plants.pump_joint.tables.fit import Fit, fit
from hjcamp.plants.pump_joint.tables.ledger import Ledger
from hjcamp.plants.pump_joint.tables.probes import Probe, looked_at
from hjcamp.plants.pump_joint.tables.quantities import candidate_quantities
from hjcamp.plants.pump_joint.tables.search import EFFORTS, Effort, Search, Step, chance, different
from hjcamp.workers.pool import Crew

CONDITIONS = 14
ACTS = ("coulomb_positive", "viscous_negative", "line_stiffness", "controller_scale", "pump_bandwidth", "head_start")
PRINTED = {"coulomb_positive": 5.27, "viscous_negative": 17.2, "line_stiffness": 2.57e13}


class LogLinearRig:
    """Indicators that answer to the logarithm of each quantity by a fixed random matrix."""

    def __init__(self):
        generator = np.random.default_rng(4)
        self.usual = generator.uniform(0.5, 2.0, (CONDITIONS, 1, 4))
        self.answers = {name: generator.normal(0.0, 0.8, (CONDITIONS, 1, 4)) for name in ACTS}
        self.calls = 0

    def repeated(self, _count):
        return self

    def indicators(self, settings):
        self.calls += 1
        change = sum(
            math.log(max(settings.get(name, PRINTED.get(name, 1.0)), 1.0) / PRINTED.get(name, 1.0)) * answer
            for name, answer in self.answers.items()
        )
        return self.usual * np.exp(change)


class ScatteringRig(LogLinearRig):
    """The same, with tests of one condition that differ by 20 %."""

    def __init__(self, count=5):
        super().__init__()
        self.scatter = np.exp(0.2 * np.random.default_rng(5).standard_normal((CONDITIONS, count, 4)))

    def repeated(self, count):
        return ScatteringRig(count)

    def indicators(self, settings):
        return super().indicators(settings) * self.scatter


def measured(rig, settings, seed=0):
    means = rig.indicators(settings)[:, 0, :3].ravel()
    means = means * np.exp(0.05 * np.random.default_rng(seed).standard_normal(len(means)))
    rows, columns = np.divmod(np.arange(3 * CONDITIONS), 3)
    conditions = [{"trajectory": str(number)} for number in range(CONDITIONS)]
    return Cells(("t",) * len(means), conditions, rows, columns, means, 0.02 * means, 0.0)


def searched(rig, cells, ledger):
    effort = Effort(base=150, short=60, polish=80, refitted=2, replicates=5, steps=2)
    names = ("controller_scale", "pump_bandwidth", "head_start")
    return Search(rig, cells, names, effort, 1, Crew(1), ledger, lambda text, share: None)


def test_a_hidden_factor_is_named_with_its_size():
    rig = LogLinearRig()
    cells = measured(rig, {"pump_bandwidth": 2.0, "coulomb_positive": 6.5})
    model, steps, _ = searched(rig, cells, Ledger(None, "")).run()
    assert model.names == ("pump_bandwidth",)
    assert model.settings["pump_bandwidth"] == pytest.approx(2.0, rel=0.15)
    assert model.settings["coulomb_positive"] == pytest.approx(6.5, rel=0.15)
    assert steps[0].p_value < 0.01 < steps[-1].p_value
    assert verdict_of(model, steps, 0.5) == (EFFECT, ("pump_bandwidth",))


def test_nothing_is_named_where_only_the_base_differs():
    rig = LogLinearRig()
    model, steps, _ = searched(rig, measured(rig, {"coulomb_positive": 6.5}), Ledger(None, "")).run()
    assert model.names == () and len(steps) == 1 and steps[0].p_value > 0.05
    assert verdict_of(model, steps, 0.5)[0] == NOTHING
    assert verdict_of(model, steps, 0.005)[0] == "outside_library"


def test_a_model_is_fitted_to_the_tests_that_it_is_judged_with():
    rig = ScatteringRig()
    cells = measured(LogLinearRig(), {"coulomb_positive": 6.5})
    model = searched(rig, cells, Ledger(None, "")).bases()[0]
    judged = robust(cells.errors(cells.of(rig.indicators(model.settings)))).sum()
    assert model.loss - model.surprise == pytest.approx(judged)
    one = robust(cells.errors(cells.of(rig.repeated(1).indicators(model.settings)))).sum()
    assert one > 1.5 * judged


def test_tables_of_a_model_scatter_as_far_as_each_cell_is_known():
    rig = ScatteringRig()
    cells = measured(LogLinearRig(), {})
    known = replace(cells, error_of_simulated=0.2 * cells.means / math.sqrt(5))
    own = cells.of(rig.indicators({}))
    drawn = [known.drawn(own, np.random.default_rng(seed)) for seed in range(400)]
    spread = np.std([np.log(one.means / own) for one in drawn], axis=0)
    assert spread == pytest.approx(np.sqrt(0.02**2 + 0.2**2 / 5 + 0.1**2), rel=0.15)
    # a table of the model's own is met as well as its cells are known, whatever its means are
    assert np.mean([robust(one.errors(own)).mean() for one in drawn]) == pytest.approx(0.9, abs=0.1)


def test_what_the_linear_prediction_promises_is_what_a_fit_then_gains():
    rig = LogLinearRig()
    cells = measured(rig, {"controller_scale": 1.3, "coulomb_positive": 6.5})
    search = searched(rig, cells, Ledger(None, ""))
    step = search.step(0, search.bases()[0])
    assert step.rivals[0].names == ("controller_scale",)
    assert step.predicted == pytest.approx(step.gain, rel=0.15)
    assert len(step.replicates) == search.effort.replicates and max(step.replicates) < step.gain


def test_a_gain_counts_by_the_less_of_what_was_promised_and_what_was_fitted():
    control, rival = Fit((), {}, 50.0), Fit(("pump_ratio",), {"pump_ratio": 0.1}, 30.0)
    replicates = [1.0, 3.0, 2.0, 6.0, 4.0]
    assert (
        Step(control, control, [rival], replicates, 40.0).p_value == Step(control, control, [rival], replicates).p_value < 0.01
    )
    assert Step(control, control, [rival], replicates, 3.0).p_value > 0.3
    # where nothing was refitted, what was promised
    assert Step(control, control, [], replicates, 3.0).p_value == Step(control, control, [rival], replicates, 3.0).p_value


def test_a_place_is_shared_from_where_its_candidate_does_nothing():
    for name, value, half in (
        ("leakage", 4e-15, 2e-15),
        ("controller_scale", 2.0, math.sqrt(2.0)),
        ("bumpless", 1.0, 0.5),
    ):
        more = candidate_quantities(name)
        places = np.array([one.start for one in more])
        places[0] = more[0].forth(value)
        shared = Probe(name, more, places, np.zeros(1)).shared(0.5)
        assert more[0].back(shared[more[0].name]) == pytest.approx(half)


def test_an_angle_is_looked_at_all_round_and_an_amplitude_weak_usual_and_strong():
    more = candidate_quantities("encoder_eccentricity")
    found = np.array(looked_at(more))
    cyclic = next(number for number, one in enumerate(more) if one.parameter.cyclic)
    assert len(found) == 3 * 4
    assert sorted(set(np.round(found[:, cyclic] * more[cyclic].unit, 3))) == pytest.approx(
        [-math.pi / 2, 0.0, math.pi / 2, math.pi], abs=1e-3
    )


def test_a_search_that_was_stopped_goes_on_and_ends_alike(tmp_path):
    rig = LogLinearRig()
    cells = measured(rig, {})
    path = tmp_path / "fits.json"
    first = searched(rig, cells, Ledger(path, "asked")).bases()[0]
    calls = rig.calls
    assert searched(rig, cells, Ledger(path, "asked")).bases()[0] == first and rig.calls == calls
    assert Ledger(path, "asked otherwise").found == {}
    path.write_text("{ damaged", encoding="utf-8")
    assert Ledger(path, "asked").found == {}


def test_the_fit_pays_for_moves_away_from_what_is_known():
    rig = LogLinearRig()
    cells = measured(rig, {})
    found = fit(rig, cells, (), [{}], 60, 1)
    assert found.loss == pytest.approx(robust(cells.errors(cells.of(rig.indicators(found.settings)))).sum() + found.surprise)


def test_the_chance_of_a_gain_is_counted_and_beyond_all_twins_follows_their_tail():
    """Of an exponential law of gains the chance is known; one heavy twin alone makes no gain beyond it unlikely by itself."""
    gains = np.random.default_rng(5).exponential(2.0, 999)
    assert chance(0.0, gains) == 1.0
    assert chance(2.0, gains) == pytest.approx(math.exp(-1.0), abs=0.04)
    for gain in (8.0, 12.0, 20.0):
        assert math.log(chance(gain, gains)) == pytest.approx(-gain / 2.0, rel=0.25)
    heavy = [*np.random.default_rng(5).exponential(2.0, 198), 40.0]
    assert chance(20.0, heavy) == pytest.approx(2 / 200) and chance(41.0, heavy) > 1e-3
    told = [chance(gain, gains) for gain in np.linspace(0.0, 30.0, 200)]
    assert told == sorted(told, reverse=True)


def test_bottoms_of_nearly_one_depth_are_kept_once_each():
    bottoms = {"deep": (0.0, 0.0), "the same": (0.1, 0.0), "near": (1.0, 0.0), "shallow": (0.0, 3.0)}
    losses = {"deep": 100.0, "the same": 100.5, "near": 105.9, "shallow": 106.1}
    fits = {name: Fit((), dict(zip("ab", places, strict=True)), losses[name]) for name, places in bottoms.items()}
    assert different(list(fits.values())[::-1]) == [fits["deep"], fits["near"]]


@pytest.mark.parametrize(("effort", "accepted", "elsewhere"), [("standard", "leakage", 1), ("quick", "controller_scale", 0)])
def test_each_bottom_is_searched_from_and_what_is_met_best_is_accepted(monkeypatch, effort, accepted, elsewhere):
    # the deeper bottom of the base leads to a model that is met less well
    bases = [Fit((), {"a": 0.0}, 100.0), Fit((), {"a": 1.0}, 103.0)]
    ends = {0.0: Fit(("controller_scale",), {"a": 0.0}, 80.0), 1.0: Fit(("leakage",), {"a": 1.0}, 70.0)}
    monkeypatch.setattr(Search, "bases", lambda self: bases)
    monkeypatch.setattr(Search, "longer", lambda self, key, model: model)
    monkeypatch.setattr(Search, "forward", lambda self, model: (ends[model.places["a"]], [self.path]))
    monkeypatch.setattr(Fit, "settings", {})
    rig = LogLinearRig()
    search = replace(searched(rig, measured(rig, {}), Ledger(None, "")), effort=EFFORTS[effort])
    model, steps, others = search.run()
    assert model.names == (accepted,) and len(others) == elsewhere
    assert steps == ["bottom 1, " if accepted == "leakage" else ""]


def test_a_model_of_another_bottom_that_is_met_as_well_is_not_told_apart():
    model, rival = Fit(("leakage",), {}, 70.0), Fit(("controller_scale",), {}, 71.0)
    steps = [Step(Fit((), {}, 100.0), Fit((), {}, 100.0), [model], [1.0] * 20)]
    assert verdict_of(model, steps, 0.5) == (EFFECT, ("leakage",))
    assert verdict_of(model, steps, 0.5, [rival])[1] == ("leakage", "controller_scale")


def test_a_long_search_ends_within_bounds():
    rig = LogLinearRig()
    [scale] = candidate_quantities("controller_scale")
    beyond = 3.0 * scale.back(scale.ends[1])
    found = fit(rig, measured(rig, {"controller_scale": beyond}), ("controller_scale",), [{}], 60, 1, polish=400)
    assert found.places["controller_scale"] == pytest.approx(scale.ends[1])


def test_a_model_of_another_bottom_pays_for_no_more_than_it_has():
    base, control = Fit((), {}, 100.0), Fit(("pump_ratio",), {}, 80.0)
    model, rival = Fit(("pump_ratio", "controller_scale"), {}, 70.0), Fit(("bumpless",), {}, 77.0)
    steps = [Step(base, base, [control], [1.0] * 20), Step(control, control, [model], [1.0] * 20)]
    # 74 with two quantities against 79 with one; by the last step alone it would be 72 against 79
    assert verdict_of(model, steps, 0.5, [rival])[1] == ("pump_ratio", "controller_scale", "bumpless")
