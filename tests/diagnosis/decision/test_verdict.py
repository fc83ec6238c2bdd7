"""The decision by two numbers on linear toys whose truth is known; nothing is simulated."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from toys import BLOCKS, Toy, all_features, search_of

from hjcamp.diagnosis.data.repeatability import Repeatability
from hjcamp.diagnosis.decision import verdict
from hjcamp.diagnosis.decision.verdict import CANNOT_TELL, EFFECT, NOTHING, ONE_OF, OUTSIDE, Decision, Verdict, decided
from hjcamp.diagnosis.estimation.gauss_newton import Free
from hjcamp.diagnosis.estimation.likelihood import size
from hjcamp.diagnosis.levels import ALPHA, DELTA
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.diagnosis.validation.channels import Channels
from hjcamp.model.declare.candidate import Candidate

# 95 % of counts at the level of 5 % of 200 are no more
DRAWS, MOST = 200, 15


@pytest.fixture(autouse=True)
def enough(monkeypatch: pytest.MonkeyPatch) -> None:
    """Toys have blocks and motion enough."""
    monkeypatch.setattr(verdict, "what_lacks", lambda measured, layout: [])


def said(models: Any, alpha: float = ALPHA, delta: float = DELTA) -> Verdict:
    return Decision(models, alpha, delta).verdict()


def library_of(toy: Toy, names: int = 20) -> Toy:
    toy.library |= {f"effect_{k}": toy.response() for k in range(names)}
    return toy


@pytest.mark.parametrize(("repetitions", "scatter"), [(3, 10.0), (1, 1.0)])
def test_where_nothing_is_missing_the_gate_holds_its_level(repetitions: int, scatter: float) -> None:
    passed = claimed = 0
    for seed in range(DRAWS):
        models = library_of(Toy(seed, repetitions, scatter), 12).models([("effect_0", "effect_1")])
        found = said(models)
        passed += found.gate.p_value <= ALPHA
        claimed += found.word not in (NOTHING, CANNOT_TELL)
    assert passed <= MOST and claimed <= MOST


@pytest.mark.parametrize("share", [0.3, 0.6, 1.0])
@pytest.mark.parametrize("scatter", [1.0, 20.0])
def test_an_effect_is_named_with_its_share_of_the_error_above_repeatability(scatter: float, share: float) -> None:
    for seed in range(10):
        toy = library_of(Toy(seed, scatter=scatter))
        toy.acts(toy.library["effect_3"], 2.0 * np.sqrt(share))
        toy.acts(toy.response(), 2.0 * np.sqrt(1.0 - share))  # of which the library has nothing
        found = said(toy.models())
        assert (found.word, found.effects, found.confidence_set) == (EFFECT, ("effect_3",), (("effect_3",),))
        assert found.gate.p_value <= ALPHA and found.gate.gain == pytest.approx(share, abs=0.15)
        assert found.gate.gain <= found.gate.upper


@pytest.mark.parametrize("sameness", [0.5, 3.0, 10.0])
def test_the_truth_is_seldom_lost_and_what_does_the_same_is_kept_with_it(sameness: float) -> None:
    lost, words = 0, []
    for seed in range(60):
        toy = Toy(seed, windows=24)
        common = toy.response()
        toy.library |= {name: toy.response((sameness, common)) for name in ("true", "other", "third")}
        toy.acts(toy.library["true"], 1.0 / sameness)
        found = said(toy.models())
        words.append(found.word)
        lost += found.word in (EFFECT, ONE_OF, OUTSIDE) and ("true",) not in found.confidence_set
    assert lost <= 6  # 95 % of counts at 5 % of 60
    assert words.count(ONE_OF if sameness > 5.0 else EFFECT) >= (57 if sameness != 3.0 else 30)


def test_two_effects_are_found_together_where_neither_suffices() -> None:
    toy = library_of(Toy(4))
    for name in ("effect_2", "effect_7"):
        toy.acts(toy.library[name], 1.0)
    pairs = [("effect_2", "effect_7"), ("effect_2", "effect_5"), ("effect_1", "effect_7")]
    found = said(toy.models(pairs))
    assert (found.word, found.effects) == (EFFECT, ("effect_2", "effect_7"))
    # an effect that explains nothing in addition is no part of the answer
    toy = library_of(Toy(4))
    toy.acts(toy.library["effect_2"], 1.0)
    assert said(toy.models(pairs)).effects == ("effect_2",)


def bent(only: int, seed: int = 3) -> Toy:
    """A law that a name has most of; the rest, which a non-parametric term has, acts in so many blocks."""
    toy = Toy(seed, repetitions=3)
    name, rest = toy.response(), toy.response()
    rest[toy.blocks[: toy.windows] >= only] = 0.0
    toy.library |= {"name": name, "idle": toy.response()}
    toy.terms |= {"term": np.concatenate([name, rest, *(toy.response() for _ in range(3))], axis=2)}
    toy.acts(name, 1.0)
    toy.acts(rest, 0.7 * np.sqrt(BLOCKS / only))
    return toy


def test_names_that_a_term_does_not_rule_out_are_said_with_what_is_outside() -> None:
    # everywhere: no name suffices, and all are ruled out
    found = said(bent(BLOCKS).models())
    assert (found.word, found.outside, found.confidence_set, found.effects) == (OUTSIDE, True, (), ())
    assert found.term is not None and found.term.names == ("term",) and found.shown is found.term
    # in two blocks, which are too few to rule out the name
    found = said(bent(2).models())
    assert (found.word, found.outside, found.confidence_set, found.effects) == (OUTSIDE, True, (("name",),), ())
    assert found.term is not None and 0.0 < found.law_left < 1.0


def test_nothing_is_said_where_no_more_than_the_smallest_share_could_be_explained() -> None:
    toy = library_of(Toy(6))
    toy.acts(toy.response(), 2.0)  # far above repeatability, and no candidate explains any of it
    found = said(toy.models())
    assert (found.word, found.gate.upper < DELTA) == (NOTHING, True)


def test_what_tests_are_too_few_to_show_is_not_called_nothing() -> None:
    words = []
    for seed in range(40):
        toy = library_of(Toy(seed, repetitions=2, windows=BLOCKS), 3)
        toy.acts(toy.library["effect_0"], 0.6)
        found = said(toy.models())
        words.append(found.word)
        assert found.word != NOTHING or found.gate.upper < DELTA
        if found.word == CANNOT_TELL:
            assert found.gate.p_value > ALPHA and found.gate.upper >= DELTA and "could be explained" in found.lacking[0]
        assert not found.effects or "effect_0" in found.effects
    assert words.count(CANNOT_TELL) >= 5 and words.count(EFFECT) >= 5


def test_what_is_not_above_repeatability_by_more_than_that_is_unsure_explains_nothing() -> None:
    toy = library_of(Toy(8, windows=240))
    toy.acts(toy.library["effect_0"], 0.25)  # 6 % of the square of the scatter
    found = said(toy.models())
    assert (found.word, found.gate.gain, found.gate.upper) == (NOTHING, 0.0, 0.0) and found.gate.p_value < 0.01
    toy.acts(toy.library["effect_0"], 0.35)
    assert said(toy.models()).effects == ("effect_0",)


@pytest.mark.parametrize(("mass", "word"), [(1.0, CANNOT_TELL), (2.0, CANNOT_TELL), (3.0, EFFECT), (8.0, EFFECT)])
def test_nothing_is_said_of_a_base_that_a_bound_holds_with_what_was_found_too(
    mass: float, word: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    toy = library_of(Toy(9))
    toy.acts(toy.library["effect_0"], 1.0)
    models = toy.models(free=[Free("", "mass", 1.0, 1.0, 9.0)])
    # the base stands at 1 where 4 is declared; a model that is nearer to 1 is held as well
    models.analysis.held, models.analysis.search = ("mass",), SimpleNamespace(declared={"mass": 4.0})
    models.base.fitted.candidate = Candidate({"mass": 1.0}, {})
    for one in models.all:
        one.scored.fitted.free, one.scored.fitted.candidate = models.base.fitted.free, Candidate({"mass": mass}, {})
    monkeypatch.setattr(verdict, "Models", lambda analysis, delta: models)
    monkeypatch.setattr(verdict, "contradicted", lambda *_: "")
    found = decided(models.analysis)
    held = word == CANNOT_TELL
    assert (found.word, found.effects) == (word, () if held else ("effect_0",))
    assert not held or found.lacking[-1].startswith("mass was driven to its bound, far from what is declared")
    # nothing of what would have been said without the bound is left
    assert not held or (found.confidence_set, found.outside, found.rivals, found.term) == (((),), False, (), None)


@pytest.mark.parametrize("grown", ["", "angle (0.37 -> 0.42 rad)"])
def test_no_name_is_said_with_which_whole_tests_are_explained_less(grown: str, monkeypatch: pytest.MonkeyPatch) -> None:
    toy = library_of(Toy(9))
    toy.acts(toy.library["effect_0"], 1.0)
    models = toy.models()
    models.analysis.held = ()
    monkeypatch.setattr(verdict, "Models", lambda analysis, delta: models)
    asked: list[object] = []
    monkeypatch.setattr(verdict, "contradicted", lambda analysis, model, delta: asked.append(model) or grown)
    found = decided(models.analysis)
    assert len(asked) == 1
    assert (found.word, found.effects) == ((CANNOT_TELL, ()) if grown else (EFFECT, ("effect_0",)))
    assert not grown or found.lacking == (
        f"with effect 0 the error of whole tests grows: {grown}; it may stand for something that acts slowly",
    )


def stored(name: str) -> Any:
    """Return what `Decision` asks of models, of features that `write_features.py` has written."""
    with np.load(Path(__file__).parent / f"features_{name}.npz") as file:
        kept = {key: file[key] for key in file.files}
    names: list[tuple[str, ...]] = [(), *(tuple(str(one).split("+")) for one in kept["names"])]
    fits = []
    for own, features, fitted in zip(names, kept["features"].astype(float), kept["fitted"].astype(float), strict=True):
        fit: Any = SimpleNamespace(features=fitted, free=())
        fits.append(Scored(own, fit, features, size(features), None))  # type: ignore[arg-type]
    terms = {str(one): None for one in kept["terms"]}
    columns = tuple(slice(*one) for one in kept["ends"].tolist())
    channels = Channels(tuple(map(str, range(len(columns)))), columns, Repeatability(kept["squares"], kept["unsure"]))
    chosen = [frozenset(np.flatnonzero(one).tolist()) for one in kept["chosen"]]
    ones = sorted((one for one in fits if len(one.names) == 1), key=lambda one: one.left_out)
    analysis = SimpleNamespace(channels=channels, measured=None, windows=SimpleNamespace(layout=None), base=fits[0])
    return SimpleNamespace(
        analysis=analysis,
        base=fits[0],
        blocks=kept["blocks"],
        names=np.unique(kept["blocks"]),
        compared=all_features,
        terms=terms,
        search=search_of(kept["blocks"]),
        all=tuple(SimpleNamespace(scored=one, blocks=own) for one, own in zip(fits[1:], chosen, strict=True)),
        named=[one for one in ones if one.names[0] not in terms],
        non_parametric=[one for one in ones if one.names[0] in terms],
    )


@pytest.mark.parametrize(
    ("name", "word", "effects"), [("nothing", NOTHING, ()), ("effect", EFFECT, ("constant_force",)), ("outside", OUTSIDE, ())]
)
def test_both_numbers_may_be_half_or_twice_as_large_and_no_word_changes(name: str, word: str, effects: tuple[str, ...]) -> None:
    models = stored(name)
    for alpha in (0.01, 0.025, 0.05, 0.1):
        for delta in (0.05, 0.075, 0.1, 0.15):
            found = said(models, alpha, delta)
            assert (found.word, found.effects) == (word, effects), (alpha, delta)
