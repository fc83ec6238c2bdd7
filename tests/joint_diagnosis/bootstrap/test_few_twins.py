"""Twins are stopped early only where more of them would not change what they say, and the level of a p-value stays."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hjcamp.plants.pump_joint.diagnosis import diagnose
from hjcamp.plants.pump_joint.diagnosis.bootstrap.early_stopping import APART, FAR, FIRST, is_clear, is_far
from hjcamp.plants.pump_joint.diagnosis.bootstrap.null_distribution import Null
from hjcamp.plants.pump_joint.diagnosis.diagnose import _Search
from hjcamp.plants.pump_joint.diagnosis.levels import CERTAIN

TWINS, RIGS, CHANNELS = 60, 20_000, 5
LAWS: dict[str, Callable[[np.random.Generator, tuple[int, int]], Any]] = {
    "exponential": lambda generator, shape: generator.exponential(1.0, shape),
    "gumbel": lambda generator, shape: np.maximum(generator.gumbel(1.0, 1.0, shape), 0.0),
    "largest of 22": lambda generator, shape: generator.chisquare(1.0, (*shape, 22)).max(axis=-1),
    "log-normal": lambda generator, shape: generator.lognormal(0.0, 1.0, shape),
}


def p_values(gains: np.ndarray, count: int) -> np.ndarray:
    """The p-value of the first column of gains (rigs, 1 + twins) among ``count`` twins."""
    return (1 + (gains[:, 1 : 1 + count] >= gains[:, :1]).sum(axis=1)) / (1 + count)


def stopped(gains: np.ndarray) -> np.ndarray:
    """Where few twins are enough for the first column of gains."""
    return np.array([is_clear(row[0], row[1 : 1 + FIRST]) for row in gains])


@pytest.mark.parametrize("law", LAWS)
def test_where_nothing_is_missing_p_values_keep_their_level(law: str) -> None:
    # 4000 rigs for the slow draw are enough: three standard errors are allowed
    rigs = 4000 if law == "largest of 22" else RIGS
    gains = LAWS[law](np.random.default_rng(7), (rigs, 1 + TWINS))
    whole, early = p_values(gains, TWINS), stopped(gains)
    p = np.where(early, p_values(gains, FIRST), whole)
    assert np.all(p[early] == 1 / (1 + FIRST))
    for level in (0.041, CERTAIN, 0.1, 0.25, 0.5, 0.9):
        share = np.mean(p < level)
        assert share <= level + 3.0 * np.sqrt(level * (1.0 - level) / rigs)
        assert share >= np.mean(whole < level) - 0.001, "a level that is never used up finds less"
    assert np.mean((p < CERTAIN) != (whole < CERTAIN)) < 0.002
    assert abs(float(np.mean(p)) - 0.5) < 0.02


@pytest.mark.parametrize("effect", [2.0, 6.0, 20.0])
def test_an_effect_is_found_as_often_as_with_all_twins(effect: float) -> None:
    gains = np.random.default_rng(8).exponential(1.0, (RIGS, 1 + TWINS))
    gains[:, 0] += effect
    whole, early = p_values(gains, TWINS), stopped(gains)
    p = np.where(early, p_values(gains, FIRST), whole)
    assert np.mean((p < CERTAIN) != (whole < CERTAIN)) < 0.003
    assert effect < 20.0 or early.mean() > 0.9, "a large gain is clear from few twins"


def test_without_any_gain_in_the_twins_nothing_is_clear() -> None:
    assert not is_clear(100.0, np.zeros(FIRST))
    assert not is_clear(100.0, np.ones(FIRST - 1))
    assert is_clear(FAR + 0.1, np.ones(FIRST)) and not is_clear(FAR, np.ones(FIRST))


def null_with(excess: float, generator: np.random.Generator, replicates: int = TWINS, spread: float = 0.12) -> tuple[Null, Any]:
    """Twins of 30 tests, and the mean square of a model that leaves ``excess`` times what the twins' law allows."""
    tests = 30
    logarithms = spread * np.sqrt(tests) * generator.standard_normal((replicates, tests, CHANNELS))
    null = Null(np.zeros(replicates), logarithms, np.ones((tests, CHANNELS), dtype=bool), np.zeros(CHANNELS))
    limit = np.exp(1.645 * 0.5 * spread) * 1.15
    return null, np.full((tests, CHANNELS), (excess * limit) ** 2)


def few(null: Null) -> Null:
    return Null(null.gains[:FIRST], null.logarithms[:FIRST], null.says, null.least)


@pytest.mark.parametrize("excess", [0.7, 0.85, 0.95, 1.0, 1.1, 1.3, 2.0])
def test_what_few_twins_say_of_an_error_all_of_them_say(excess: float) -> None:
    generator = np.random.default_rng(9)
    early, other = 0, 0
    for _ in range(150):
        null, mean_square = null_with(excess, generator)
        part = few(null)
        left = part.excess(mean_square, mean_square, 0.0)
        if is_far(left, part.spread()):
            early += 1
            other += bool(np.any(left > 1.0)) != bool(np.any(null.excess(mean_square, mean_square, 0.0) > 1.0))
    assert other <= 1
    assert excess not in (0.7, 2.0) or early > 140
    assert excess != 1.0 or early < 30


def test_one_channel_that_is_surely_above_is_enough_but_all_have_to_be_below() -> None:
    spread = np.full(3, 0.1)
    away = np.exp(APART * 0.1) * 1.01
    assert is_far(np.array([1.0, away, 0.5]), spread)
    assert is_far(np.array([1.0, 0.9, 0.5]) / away, spread)
    assert not is_far(np.array([1.0, 0.5, 0.5]), spread)


@pytest.fixture
def search(monkeypatch: pytest.MonkeyPatch) -> Any:
    """A search whose twins are their seeds, and whose gains are below 3 in the first twins and below 9 in all."""
    found: Any = _Search.__new__(_Search)
    found.work, found.least_gain, found.lacking = SimpleNamespace(replicates=TWINS, forward=2), lambda name: 10.0, ()
    found.second_gain, found.nulls = 15.0, []
    found.effects, found.fitter, found.crew, found.seed = (), None, None, 4
    found.twins_of, found.replicates, found.scatter = None, [], None
    found.report, found._match = lambda *given: None, lambda current: None
    found.drawn = []

    def simulate(fitter: Any, fit: Any, scatter: Any, seeds: list[int], tick: Any) -> list[int]:
        found.drawn += seeds
        return seeds

    def null_of(fitter: Any, screening: Any, replicates: list[int]) -> Null:
        gains = np.where(np.arange(len(replicates)) < FIRST, 2.9, 8.9)
        logarithms = np.random.default_rng(1).standard_normal((TWINS, 30, CHANNELS))[: len(replicates)]
        return Null(gains, logarithms, np.ones((30, CHANNELS), dtype=bool), np.zeros(CHANNELS))

    def screen(fitter: Any, about: Any, effects: Any, names: Any) -> Any:
        gains = {} if names is not None else about.promises
        return SimpleNamespace(about=about, gains=gains, ranked=dict.fromkeys(gains))

    monkeypatch.setattr(diagnose, "simulate_twins", simulate)
    monkeypatch.setattr(diagnose, "null_of", null_of)
    monkeypatch.setattr(diagnose, "screen", screen)
    return found


def model(left: float = 1.0, **promises: float) -> Any:
    return SimpleNamespace(promises=promises, mean_square=np.full((30, CHANNELS), left))


def taken(**given: Any) -> Any:
    return SimpleNamespace(best="leakage", screening=SimpleNamespace(about=model(9.0)), **given)


def test_a_clear_promise_needs_few_twins(search: Any) -> None:
    _, null = search._look(model(leakage=40.0), 0, True)
    assert len(null.gains) == len(search.drawn) == FIRST


@pytest.mark.parametrize("promise", [0.5, 9.9, 5.8])
def test_what_does_not_promise_enough_or_not_clearly_is_asked_of_all(search: Any, promise: float) -> None:
    search.least_gain = lambda name: 5.0
    _, null = search._look(model(leakage=promise), 0, True)
    clear = promise >= 5.0 and promise > FAR * 2.9
    assert (len(null.gains) == FIRST) == clear
    assert search.drawn == [400_000 + index for index in range(len(null.gains))]


def test_a_gain_less_clear_than_its_promise_is_asked_of_all_from_the_same_seeds(search: Any) -> None:
    screening, null = search._look(model(leakage=40.0), 0, True)
    step = diagnose.Step(screening, {"leakage": SimpleNamespace(loss=-5.0)}, {"leakage": 1.0}, 0.04, null.gains)
    screening.about.loss = 0.0
    after, whole = search._certain(step, null)
    assert len(whole.gains) == len(after.null_gains) == TWINS
    assert after.p_value == whole.p_value(5.0) > CERTAIN > 1 / (1 + FIRST)
    assert search.drawn == [400_000 + index for index in range(TWINS)]
    step = diagnose.Step(screening, {"leakage": SimpleNamespace(loss=-30.0)}, {"leakage": 1.0}, 0.04, null.gains)
    search.replicates = search.replicates[:FIRST]
    assert search._certain(step, null) == (step, null)


@pytest.mark.parametrize(
    ("left", "promise", "steps", "enough"),
    [(1.0, 1.0, 1, True), (90.0, 1.0, 1, True), (1.3, 1.0, 1, False), (1.0, 6.0, 1, False), (1.0, 1.0, 2, False)],
)
def test_after_the_first_effect_few_twins_tell_what_is_far_from_the_limit(
    search: Any, left: float, promise: float, steps: int, enough: bool
) -> None:
    _, null = search._look(model(left, presliding=promise), 1, True, [taken()] * steps)
    assert (len(null.gains) == FIRST) == enough


def test_few_twins_that_were_asked_for_are_no_other_than_all(search: Any) -> None:
    search.work.replicates = FIRST
    _, null = search._look(model(leakage=0.1), 0, True)
    assert len(null.gains) == len(search.drawn) == FIRST
