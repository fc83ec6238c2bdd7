"""The worth of a test: what a refit can take up is worth nothing, and what is already apart gains nothing more."""

from __future__ import annotations

import numpy as np
import pytest

from hjcamp.plants.pump_joint.diagnosis.design.campaign_file import allowed_by, campaign_content
from hjcamp.plants.pump_joint.diagnosis.design.menu import Choice, menu
from hjcamp.plants.pump_joint.diagnosis.design.responses import Products
from hjcamp.plants.pump_joint.diagnosis.design.separation import Arena, Contest, choose

LEAST = np.array([0.1])


def contest(deviations: np.ndarray, responses: np.ndarray, old: Products | None = None) -> Contest:
    """Return a contest on tests (tests, n) of one channel with the responses (tests, k, n) of the refitted rival."""
    n = deviations.shape[1]
    products = (responses @ responses.transpose(0, 2, 1) / n)[:, None]
    cross = (responses @ deviations[:, :, None])[:, None, :, 0] / n
    square = (deviations**2).mean(axis=1)[:, None]
    new = Products(products, cross, square, np.zeros(responses.shape[1]))
    noise = np.full(len(deviations), np.log(0.01 + 0.01))
    return Contest(0, 1, 1.0, new, noise, old)


@pytest.fixture
def waves() -> tuple[np.ndarray, np.ndarray]:
    """Two orthogonal signals of unit mean square."""
    phase = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    return np.sqrt(2) * np.sin(phase), np.sqrt(2) * np.cos(phase)


def test_what_a_refit_takes_up_separates_nothing(waves: tuple[np.ndarray, np.ndarray]) -> None:
    one, other = waves
    arena = Arena([contest(np.stack([one, other]), np.stack([one[None], one[None]]))], LEAST, 1, 3)
    assert arena.separation(0, [0]) == 0.0
    assert arena.separation(0, [1]) > 3.0


def test_two_tests_bind_the_same_unknown(waves: tuple[np.ndarray, np.ndarray]) -> None:
    # Alone each test is refitted away; together they want opposite moves of one unknown.
    one, _ = waves
    arena = Arena([contest(np.stack([one, -one]), np.stack([one[None], one[None]]))], LEAST, 1, 3)
    assert arena.separation(0, [0]) == arena.separation(0, [1]) == 0.0
    assert arena.separation(0, [0, 1]) > 3.0


def test_what_is_measured_binds_the_refit(waves: tuple[np.ndarray, np.ndarray]) -> None:
    one, _ = waves
    known = contest(np.zeros((8, 200)), np.tile(one[None], (8, 1, 1))).new
    free = contest(np.stack([one]), np.stack([one[None]]))
    bound = Contest(0, 1, 1.0, free.new, free.true_loss, known)
    assert Arena([free], LEAST, 1, 3).separation(0, [0]) == 0.0
    assert Arena([bound], LEAST, 1, 3).separation(0, [0]) > 3.0


def test_the_second_choice_serves_the_pair_that_is_still_alike(waves: tuple[np.ndarray, np.ndarray]) -> None:
    one, other = waves
    blind = np.zeros((3, 1, 200))
    quiet = 0.1 * one
    first = contest(np.stack([2 * other, 1.9 * other, quiet]), blind + 1e-6)
    second = contest(np.stack([quiet, quiet, 0.5 * other]), blind + 1e-6)
    arena = Arena([first, second], LEAST, 1, 3)
    assert choose(arena, [1.0, 1.0, 1.0], 2) == [0, 2]
    assert choose(arena, [1.5, 1.0, 1.0], 2) == [1, 2]


def test_a_menu_without_worth_proposes_nothing() -> None:
    arena = Arena([contest(np.zeros((2, 200)), np.zeros((2, 1, 200)) + 1e-6)], LEAST, 1, 3)
    assert choose(arena, [1.0, 1.0], 3) == []


def test_names_and_settings_of_the_menu_are_different() -> None:
    choices = menu()
    assert len({one.name for one in choices}) == len(choices) > 30
    assert len({repr(sorted(one.settings.items(), key=str)) for one in choices}) == len(choices)


def test_what_the_user_fixes_narrows_the_menu() -> None:
    assert {one.settings["procedure.preload_mpa"] for one in allowed_by(menu(), {"procedure.preload_mpa": 0.4})} == {0.4}
    assert all(one.settings.get("payload", "none") == "none" for one in allowed_by(menu(), {"payload": "none"}))
    assert len(allowed_by(menu(), {"pump": "pump1"})) == len(menu())


def test_a_key_that_a_test_sets_is_not_fixed_as_well() -> None:
    choices = [Choice("a", "", {"payload": "brass_8p5g"}), Choice("b", "", {"controller": "pid"})]
    content = campaign_content("n", "", {"pump": "pump1", "payload": "brass_8p5g"}, choices, 3)
    assert content["fixed"] == {"pump": "pump1"}
    assert content["vary"]["test"]["b"] == {"payload": "brass_8p5g", "controller": "pid"}
