"""Hidden forces on a carriage that shares no code with the program: named, outside, or nothing."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import gauge
import numpy as np
import pytest
from carriage import measured_log, nothing
from threadpoolctl import threadpool_info, threadpool_limits

from hjcamp.commands.any_plant.next_commands import next_commands
from hjcamp.commands.any_plant.remarks.remaining_words import most_remains, over_noise
from hjcamp.commands.any_plant.verdict_words import Words
from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.data.repeatability import NoiseFloor
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.decision import doubts, rivals, verdict
from hjcamp.diagnosis.decision.verdict import Verdict, agreed, judged
from hjcamp.diagnosis.estimation.intervals import Interval
from hjcamp.diagnosis.results.answer import _beyond_law, answer
from hjcamp.diagnosis.selection.claims import Claims
from hjcamp.diagnosis.selection.scored import Follows
from hjcamp.effects import load_effects
from hjcamp.model.declare.candidate import Candidate

LIBRARY = ("constant_force", "quadratic_drag", "spring")
HIDDEN = {
    "spring": lambda x, v: -150.0 * (x - 0.03),
    "quadratic_drag": lambda x, v: -900.0 * v * abs(v),
    # two waves along the travel: no law of the library has that
    "outside": lambda x, v: 8.0 * np.sin(2.0 * np.pi * x / 0.06),
    "nothing": nothing,
}


def both(x: float, v: float) -> float:
    """A force that no law of one quantity has, nor one that is so many times another."""
    return -2500.0 * x * abs(v)


def asked(force) -> dict:  # type: ignore[no-untyped-def, type-arg]
    measured = measured_tests([measured_log(force, seconds=16.0)])
    library = load_effects(plant=measured.plant)
    chosen = {name: library[name] for name in LIBRARY}
    found = agreed(calibrated(measured, chosen), lambda width: calibrated(measured, chosen, width=width))
    return json.loads(json.dumps(answer(*found, 0.0), allow_nan=False))


@pytest.mark.parametrize("name", ["spring", pytest.param("quadratic_drag", marks=pytest.mark.study)])
def test_the_hidden_effect_is_named(axis: Path, name: str) -> None:
    found = asked(HIDDEN[name])
    assert (found["verdict"], found["effects"]) == ("effect", [name])
    assert found["error"]["augmented"] < 0.5 * found["error"]["baseline"]
    if name == "spring":
        row = found["candidates"][0]["parameters"]["stiffness"]
        assert row["value"] == pytest.approx(150.0, rel=0.01)
        assert row["ci95"][1] - row["ci95"][0] < 0.1 * 150.0


def test_nothing_is_missing(axis: Path) -> None:
    found = asked(HIDDEN["nothing"])
    assert found["verdict"] == "nothing_missing" and found["effects"] == [] and found["unknowns"] == []
    assert found["follows_motion"] == {"share": 0.0, "quantities": [], "beside_law": 0.0}


def test_what_no_law_has_is_outside_and_its_curve_is_drawn(axis: Path) -> None:
    found = asked(HIDDEN["outside"])
    assert found["verdict"] == "outside_library"
    assert found["drivers"][0] in ("velocity_position", "friction_travel")
    curve = found["unknowns"][0]["curve"]
    assert len(curve["x"]) == len(curve["y"]) and curve["x_unit"] == "m" and curve["y_unit"] == "N"
    # the law takes all that can be told
    assert found["follows_motion"]["beside_law"] == 0.0


def test_what_can_be_told_beside_a_free_law_is_in_the_answer() -> None:
    base, law = SimpleNamespace(), SimpleNamespace()
    search = SimpleNamespace(follows_motion=lambda model: Follows(0.4 if model is law else 0.9, 1.0))
    analysis = SimpleNamespace(search=search, base=base)

    def asked_of(unknown: object, effects: tuple[str, ...]) -> float:
        return _beyond_law(analysis, SimpleNamespace(unknown=unknown, effects=effects))  # type: ignore[arg-type]

    assert (asked_of(law, ()), asked_of(law, ("spring",)), asked_of(None, ())) == (0.4, 0.0, 0.0)


def test_a_force_that_repeats_many_times_along_the_travel_is_outside(axis: Path) -> None:
    measured = measured_tests([measured_log(lambda x, v: 12.0 * np.sin(2.0 * np.pi * x / 0.013), seconds=9.0)])
    library = load_effects(plant=measured.plant)
    analysis = calibrated(measured, {name: library[name] for name in LIBRARY})
    found = answer(analysis, judged(analysis), 0.0)
    assert (found["verdict"], found["drivers"][0]) == ("outside_library", "velocity_position")
    assert found["unknowns"][0]["quantity"] == "force" and found["unknowns"][0]["left"] < 0.7


def test_what_depends_on_two_quantities_is_outside_though_no_law_of_one_takes_it(axis: Path) -> None:
    found = asked(both)
    assert (found["verdict"], found["effects"], found["drivers"]) == ("outside_library", [], [])
    follows = found["follows_motion"]
    assert follows["share"] > 0.5 and "position" in " ".join(follows["quantities"])


def test_what_is_so_many_times_a_speed_depending_on_the_place_is_a_damping_over_it(axis: Path) -> None:
    found = asked(lambda x, v: -2500.0 * x * v)
    row = found["unknowns"][0]
    assert found["verdict"] == "outside_library"
    assert (row["quantity"], row["port"], row["driver"]) == ("damping", "friction", "friction_travel")
    x, y = np.array(row["curve"]["x"]), np.array(row["curve"]["y"])
    # in N s/m
    assert np.polyfit(x, y, 1)[0] == pytest.approx(2500.0, rel=0.15)


@pytest.mark.study
def test_a_name_that_takes_less_than_a_regression_still_finds_is_no_answer(axis: Path) -> None:
    # a spring is there, and beside it what no law of the library has: three times as much
    found = asked(lambda x, v: -50.0 * (x - 0.03) + both(x, v))
    assert (found["verdict"], found["effects"]) == ("outside_library", [])
    assert found["law_left"] > 0.5 and found["follows_motion"]["share"] > 0.5


@pytest.mark.parametrize(("beside", "little"), [(0.0, False), (2500.0, True)])
def test_what_longer_windows_name_must_take_most_of_what_follows_from_the_motion(
    axis: Path, beside: float, little: bool
) -> None:
    measured = measured_tests([measured_log(lambda x, v: -50.0 * (x - 0.03) - beside * x * v, seconds=16.0)])
    analysis = calibrated(measured, {"spring": load_effects(plant=measured.plant)["spring"]}, unknowns=False)
    spring = {"stiffness": 50.0, "rest_position": 0.03}
    base = analysis.base.fitted
    model = replace(
        analysis.base, names=("spring",), fitted=replace(base, candidate=base.candidate.with_effect("spring", spring))
    )
    longer = Verdict("effect", ("spring",), model, 0.001, (("spring",),), 0.0, None, ())
    assert verdict._takes_too_little(analysis, longer) is little


def test_few_tests_cannot_tell(axis: Path) -> None:
    measured = measured_tests([measured_log(seconds=0.6)])
    library = load_effects(plant=measured.plant)
    analysis = calibrated(measured, {"spring": library["spring"]}, unknowns=False)
    found = answer(analysis, judged(analysis), 0.0)
    assert found["verdict"] == "cannot_tell" and found["lacking"]


@pytest.mark.parametrize(
    ("first", "longer", "width", "word"),
    [
        ("nothing_missing", "outside_library", 200, "outside_library"),
        ("nothing_missing", "nothing_missing", 100, "nothing_missing"),
        ("nothing_missing", "cannot_tell", 100, "nothing_missing"),
        # what only a regression sees does not end the search for a law
        ("follows", "effect", 200, "effect"),
        ("follows", "nothing_missing", 100, "outside_library"),
        ("nothing_missing", "follows", 200, "outside_library"),
        # names that take less than a regression still finds in short windows are not given by long ones
        ("refused", "effect", 100, "outside_library"),
        ("follows", "another", 100, "outside_library"),
    ],
)
def test_where_nothing_is_seen_longer_windows_are_looked_at(
    monkeypatch: pytest.MonkeyPatch, first: str, longer: str, width: int, word: str
) -> None:
    def of(samples: int):  # type: ignore[no-untyped-def]
        tests = [SimpleNamespace(samples=200)]
        windows, search = SimpleNamespace(layout=SimpleNamespace(width=samples, memory=0)), SimpleNamespace(claims=0.05)
        measured = SimpleNamespace(tests=tests, repeated=False)
        return SimpleNamespace(
            windows=windows, search=search, measured=measured, noise_floor=SimpleNamespace(source="repetitions")
        )

    said, levels = {100: first, 200: longer}, []

    def judged(one):  # type: ignore[no-untyped-def]
        levels.append(one.search.claims)
        word = said[one.windows.layout.width]
        follows, refused = word in ("follows", "refused"), ("spring",) if word == "refused" else ()
        effects = {"effect": ("spring",), "another": ("cubic_spring",)}.get(word, ())
        word = "outside_library" if follows else "effect" if effects else word
        return SimpleNamespace(word=word, follows=0.5 * follows, effects=effects, refused=refused)

    monkeypatch.setattr(verdict, "judged", judged)
    monkeypatch.setattr(verdict, "_doubted", lambda analysis, said: said)
    monkeypatch.setattr(verdict, "_of_no_constant", lambda analysis, said: said)
    monkeypatch.setattr(verdict, "_swinging", lambda analysis, said: said)
    monkeypatch.setattr(verdict, "_beside_a_course", lambda analysis, said: said)
    monkeypatch.setattr(verdict, "_of_other_base", lambda analysis, said: said)
    monkeypatch.setattr(verdict, "_takes_too_little", lambda analysis, other: other.effects == ("cubic_spring",))
    analysis, found = verdict.agreed(of(100), of)
    assert (analysis.windows.layout.width, found.word) == (width, word)
    # these two and the look at parameters that are no constants claim something by chance half as often as the first, together
    assert levels == [0.05, pytest.approx(0.05 / 6.0)]


def test_nothing_is_missing_is_not_said_of_a_base_that_its_bounds_hold(axis: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = axis / "plants" / "axis.py"
    file.write_text(file.read_text().replace("(1.0, 1e3)", "(90.0, 1e3)"))  # 80 kg is right
    analysis = calibrated(measured_tests([measured_log()]), {}, unknowns=False)
    nothing = Verdict("nothing_missing", (), analysis.base, 1.0, ((),), 0.0, None, ())
    monkeypatch.setattr(verdict, "judged", lambda one: nothing)
    found = verdict.agreed(analysis, lambda width: analysis)[1]
    assert found.word == "cannot_tell" and found.lacking[0].startswith(
        "mass was driven to its bound, far from what is declared"
    )


@pytest.mark.parametrize(
    ("at_bound", "told", "pushed"),
    [(True, False, False), (True, True, False), (False, False, False), (True, True, True), (False, True, True)],
)
def test_a_name_at_a_bound_that_no_test_tells_is_not_said(
    axis: Path, monkeypatch: pytest.MonkeyPatch, at_bound: bool, told: bool, pushed: bool
) -> None:
    measured = measured_tests([measured_log(seconds=4.0)])
    library = load_effects(plant=measured.plant)
    analysis = calibrated(measured, {name: library[name] for name in LIBRARY})
    row = Interval("spring", "stiffness", 1e3, 0.0, 1e3, at_bound, told)
    # a base parameter that was pushed to a bound, where the tests tell nothing of it
    base = Interval("", "viscous", 1e-3, 0.0, 1.0, pushed, not pushed)
    monkeypatch.setattr(doubts, "intervals", lambda fitted, blocks: [row, base])
    said = doubts.doubt_of_names(analysis, analysis.base, ("spring",))
    assert ("was fitted at its bound" in said) == (at_bound and (pushed or not told))
    # so too where a bound holds a base parameter that the tests tell
    analysis.__dict__["held"] = ("viscous",)
    assert ("was fitted at its bound" in doubts.doubt_of_names(analysis, analysis.base, ("spring",))) == at_bound


@pytest.mark.parametrize(
    ("longer", "said"),
    [
        (("command_delay", "quadratic_drag"), ("command_delay", "quadratic_drag")),
        # another set of names is no more than was found, and no news of it
        (("quadratic_drag", "spring"), ("command_delay",)),
        (("command_delay",), ("command_delay",)),
    ],
)
def test_longer_windows_are_believed_where_they_show_more(
    monkeypatch: pytest.MonkeyPatch, longer: tuple[str, ...], said: tuple[str, ...]
) -> None:
    def at(width: int) -> SimpleNamespace:
        tests = (SimpleNamespace(samples=400),)
        measured = SimpleNamespace(tests=tests, repeated=True)
        windows = SimpleNamespace(layout=SimpleNamespace(width=width, memory=0))
        return SimpleNamespace(windows=windows, measured=measured, search=SimpleNamespace(claims=0.05))

    def judging(one: SimpleNamespace) -> Verdict:
        names = ("command_delay",) if one.windows.layout.width == 24 else longer
        assert one.windows.layout.width == 24 or one.search.claims == pytest.approx(0.025)
        return Verdict("effect", names, SimpleNamespace(), 0.01, (names,), 0.0, None, ())  # type: ignore[arg-type]

    monkeypatch.setattr(verdict, "judged", judging)
    found, answered = verdict._looked_at(at(24), at)  # type: ignore[arg-type]
    assert answered.effects == said and found.windows.layout.width == (48 if len(said) > 1 else 24)


def test_a_rival_that_errs_less_in_each_sensor_is_not_ruled_out() -> None:
    # scores rule out by single windows; what errs less on the whole may only know its starts less well
    layout = SimpleNamespace(measured=SimpleNamespace(sensors=("a", "b")))
    model = SimpleNamespace(features=np.array([[1.0, 1.0], [1.0, 1.0]]))
    for rival, beaten, ruled_out in ((0.5, True, False), (2.0, True, True), (2.0, False, False)):
        search = SimpleNamespace(windows=SimpleNamespace(layout=layout), beats=lambda one, other, beaten=beaten: beaten)
        other = SimpleNamespace(features=rival * model.features)
        assert Claims.ruled_out(search, other, model) == ruled_out  # type: ignore[arg-type]
    mixed = SimpleNamespace(features=np.array([[0.5, 2.0], [0.5, 2.0]]))
    search = SimpleNamespace(windows=SimpleNamespace(layout=layout), beats=lambda one, other: True)
    assert Claims.ruled_out(search, mixed, model)  # type: ignore[arg-type]


def test_any_number_of_threads_gives_the_same(axis: Path) -> None:
    measured = measured_tests([measured_log(HIDDEN["spring"])])
    library = load_effects(plant=measured.plant)
    chosen = {name: library[name] for name in LIBRARY}
    looks = []
    for workers in (1, 3):
        analysis = calibrated(measured, chosen, workers=workers)
        step = analysis.search.look(analysis.base)
        looks.append([(one.names, one.left_out, one.fitted.candidate.effects) for one in step.named])
    assert looks[0] == looks[1] and len(looks[0]) >= 2


def diagnosed(brim: float, samples: int) -> tuple[dict, Words]:  # type: ignore[type-arg]
    measured = measured_tests([gauge.measured_log(brim=brim, seed=2, samples=samples)])
    library = load_effects(plant=measured.plant)
    chosen = {name: library[name] for name in ("flow_exponent_at_outflow", "overflow_at_upper", "spill_over")}
    found = agreed(calibrated(measured, chosen), lambda width: calibrated(measured, chosen, width=width))
    content = answer(*found, 0.0)
    return content, Words(*found, content)


@pytest.mark.study
def test_an_error_far_above_noise_that_nothing_takes_is_not_called_nothing(tanks: Path) -> None:
    # too short to name the spill: no test is repeated, and no moments are alike
    found, words = diagnosed(7.0, 700)
    assert (found["verdict"], found["effects"], found["floor"]["level_v"]["value"]) == ("cannot_tell", [], None)
    [lacking] = found["lacking"]
    assert "times its own noise (third differences), which is more than chance" in lacking and "29 windows" in lacking
    assert words.title == "CANNOT TELL" and lacking[1:] in words.sentences()[0]
    # long enough, and nothing hidden
    found, words = diagnosed(np.inf, 1600)
    assert (found["verdict"], words.title, words.far_off) == ("nothing_missing", "NOTHING MISSING", None)


@pytest.mark.study
def test_nothing_is_said_with_what_is_left(tanks: Path) -> None:
    found, words = diagnosed(np.inf, 1600)
    row = {**found["floor"]["level_v"], "value": 0.1, "low": 0.05, "high": 0.3}
    verdict = replace(words.verdict, p_value=0.005)
    words = Words(words.analysis, verdict, {**found, "floor": {"level_v": row}})
    assert words.title == "NOTHING IDENTIFIED  level still errs by 0.3 V, 3 times its noise floor"
    said = " ".join(words.sentences())
    assert (
        "level still errs by 0.3 V, 3 times its noise floor, and more than chance (p = 0.005)" in said
        and "repeated test" in said
    )
    small = Words(words.analysis, verdict, {**words.content, "floor": {"level_v": {**row, "high": 0.15}}})
    assert small.title == "NOTHING IDENTIFIED  the residual exceeds chance (p = 0.005)"
    words = Words(
        words.analysis, replace(verdict, p_value=0.5), {**words.content, "floor": {"level_v": {**row, "value": None}}}
    )
    said = " ".join(words.sentences())
    assert "6 times its own noise (third differences), though the library explains no more of it than chance (p = 0.5)" in said


def test_a_group_beside_a_free_law_is_told_how_to_go_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Words, "beyond_names", property(lambda self: True))
    said: Any = SimpleNamespace(word="one_of", effects=("spring", "drag"), confidence_set=(("spring",), ("drag",)))
    words = Words(SimpleNamespace(), said, {"unknowns": [{"apart_s": 0.0}]})  # type: ignore[arg-type]
    steps = next_commands(words, "logs", "published")
    assert steps[0] == "hjcamp next logs" and steps[-1].startswith("hjcamp effects new MY_EFFECT --from diagnose")


@pytest.mark.parametrize(
    ("augmented", "noise_floor", "law_left", "said"),
    [
        (0.8, 0.1, 0.0, "level errs by 0.8 V instead of 1 V, 8 times its own noise (third differences)"),
        (0.5, 0.1, 0.0, "level still errs by 0.5 V, 5 times its own noise (third differences)"),
        (0.5, 0.1, 0.2, "level still errs by 0.5 V, 5 times its own noise (third differences)."),  # why is said before
        (0.15, 0.1, 0.0, ""),
        (0.8, 0.7, 0.0, ""),
    ],
)
def test_that_much_of_the_error_is_left_beside_a_name_is_said(
    augmented: float, noise_floor: float, law_left: float, said: str
) -> None:
    rows = {
        "level_v": {"baseline": 1.0, "augmented": augmented, "floor": noise_floor, "unit": "V"},
        "flow_m3_per_s": {"baseline": 0.5, "augmented": 0.5, "floor": 0.4, "unit": "m^3/s"},
    }
    verdict: Any = SimpleNamespace(word="effect", law_left=law_left)
    found = most_remains({"channels": rows}, verdict, "sensor")
    assert bool(found) == bool(said)
    assert not said or said in found[0]


@pytest.mark.parametrize(
    ("source", "errs", "said"), [("near_replicates", 0.3, True), ("near_replicates", 0.09, False), ("sensor", 0.3, False)]
)
def test_that_alike_moments_differ_by_more_than_the_noise_is_said(source: str, errs: float, said: bool) -> None:
    content = {
        "channels": {"level_v": {"augmented": errs}, "flow_v": {"augmented": 0.05}},
        "floor": {"level_v": {"low": 0.05, "value": 0.28, "unit": "V"}, "flow_v": {"low": 0.04, "value": 0.05, "unit": "V"}},
    }
    found = over_noise(content, source)
    assert bool(found) == said
    begins = "level errs by 0.3 V, 6 times its own noise (third differences). Near-replicates differ by 0.28 V: "
    assert not said or found[0].startswith(begins)


def scored(name: str, left: float, law: str = "") -> Any:
    """Return a stand-in for a model with one effect, and a free law, that leaves so much."""
    effects = {name: {"size": 1.0}} | ({law: {"knot_0": 1.0}} if law else {})
    names = tuple(one for one in (name, law) if one)
    return SimpleNamespace(
        names=names,
        left_out=left,
        fitted=SimpleNamespace(candidate=Candidate({}, {k: v for k, v in effects.items() if k})),
        beyond=lambda other: tuple(one for one in names if one not in other.names),
    )


@pytest.mark.parametrize(("better", "sets"), [(False, 2), (True, 1)])
def test_a_free_law_speaks_for_a_name_that_beats_its_rival_alone(
    better: bool, sets: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    base, law = scored("", 1.0), "unknown_command"
    band, gain = scored("dead_band", 0.73), scored("sensor_gain", 0.74)
    best = scored("dead_band", 0.5, law)
    step = SimpleNamespace(named=(band, gain), before=base)

    def beats(model: Any, other: Any) -> bool:
        return model is best or (better and model is band)

    search = SimpleNamespace(
        unknowns={law: "law"}, library={"dead_band": "band", "sensor_gain": "gain"}, steps=[step], beats=beats,
        of_same_law=lambda name, model: [], error_ratio=lambda one, other: one.left_out / other.left_out,
        of_no_memory=lambda one, other: False, fitted=lambda candidate: scored("sensor_gain", 0.51, law), other_lags=lambda *_: [],
    )  # fmt: skip
    monkeypatch.setattr(rivals, "equivalent_laws", lambda free, own: own == "band")
    # the free law rules out all that has another name, but what stands beside it
    monkeypatch.setattr(rivals, "ruled_out", lambda analysis, one, held, before: held is best and law not in one.names)
    analysis: Any = SimpleNamespace(search=search, base=base)
    assert len(rivals.confidence_set(analysis, band, ("dead_band",), best)) == sets


def test_what_was_found_beside_a_name_is_marked() -> None:
    rows = [
        {"effect": "spring", "t": 9.0, "heldout_error_ratio": 0.5, "parameters": {}, "beside": []},
        {"effect": "drag", "t": 4.0, "heldout_error_ratio": 0.8, "parameters": {}, "beside": ["spring"]},
    ]
    for one in rows:
        one["parameters"] = {"size": {"value": 1.0, "unit": "1", "ci95": [0.9, 1.1], "at_bound": False, "told": True}}
    words = Words(SimpleNamespace(), SimpleNamespace(), {"candidates": rows})  # type: ignore[arg-type]
    assert [row[0] for row in words.candidates()] == ["spring", "+ drag"]
    assert words.added_note == ["+: added after spring; compared with the model that includes it."]
    assert Words(SimpleNamespace(), SimpleNamespace(), {"candidates": rows[:1]}).added_note == []  # type: ignore[arg-type]


def test_linear_algebra_takes_one_thread(axis: Path) -> None:
    measured = measured_tests([measured_log(seconds=0.6)])
    with threadpool_limits(2, user_api="blas"):
        calibrated(measured, {}, unknowns=False)
        assert {row["num_threads"] for row in threadpool_info() if row["user_api"] == "blas"} == {1}


@pytest.mark.parametrize(("left", "least", "hardly"), [(0.9, 0.1, True), (0.5, 0.1, False), (0.9, 0.46, False)])
def test_names_that_take_little_of_what_alike_moments_do_not_share_are_not_the_answer(
    left: float, least: float, hardly: bool
) -> None:
    measured = SimpleNamespace(sensors=("a", "b"), noise=np.array([1.0, 1e-3]))
    windows = SimpleNamespace(layout=SimpleNamespace(measured=measured, width=4))
    base = SimpleNamespace(features=np.tile([20.0, 10.0, 30.0, 10.0], (9, 1)))
    model = SimpleNamespace(features=left * base.features)
    squares = np.diag((least * base.features[0]) ** 2)
    for source in ("near_replicates", "sensor", "repetitions"):
        analysis = SimpleNamespace(windows=windows, noise_floor=NoiseFloor(source, squares), base=base)
        assert verdict._hardly_touched(analysis, model) == (hardly and source == "near_replicates")  # type: ignore[arg-type]
    # a sensor in which nothing is missing has no say
    squares = np.diag(([least, least, 0.95, 0.95] * base.features[0]) ** 2)
    analysis = SimpleNamespace(windows=windows, noise_floor=NoiseFloor("near_replicates", squares), base=base)
    assert verdict._hardly_touched(analysis, model) == hardly  # type: ignore[arg-type]
    # one sensor in which most of it is gone is enough
    analysis = SimpleNamespace(
        windows=windows, noise_floor=NoiseFloor("near_replicates", np.diag((least * base.features[0]) ** 2)), base=base
    )
    model.features[:, 2:] *= 0.1
    assert not verdict._hardly_touched(analysis, model)  # type: ignore[arg-type]
