"""What moves while its contact only gives way is no sliding: a slow creep under a growing push, which then falls."""

from __future__ import annotations

import numpy as np

from hjcamp.plants.pump_joint.diagnosis.measured.signals import (
    CREEPS,
    FALLS_TO,
    FALLS_WITHIN,
    MOST_TRAVEL,
    ONSET,
    PERIOD,
    SLIDING_MARGIN,
    yielding,
)

REST, CREEP, SLIDE = 50, 40, 100


def run(peak: float, direction: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Return velocity and push of an arm that rests, creeps while the push grows to ``peak``, and slides at a push of 5."""
    velocity = np.concatenate([np.zeros(REST), np.full(CREEP, 0.005), np.full(SLIDE, 0.02)])
    push = np.concatenate([np.linspace(0.0, 4.0, REST), np.linspace(4.0, peak, CREEP), np.full(SLIDE, 5.0)])
    return direction * velocity, direction * push


def test_the_creep_before_the_push_falls_is_no_sliding() -> None:
    for direction in (1.0, -1.0):
        marked = np.flatnonzero(yielding(*run(7.0, direction)))
        assert marked[0] == REST
        assert marked[-1] == REST + CREEP - 1 + SLIDING_MARGIN


def test_a_push_that_does_not_fall_marks_nothing() -> None:
    assert not yielding(*run(5.2)).any()


def test_a_place_that_holds_an_arm_in_full_motion_is_sliding() -> None:
    velocity, push = run(7.0)
    velocity[REST : REST + CREEP // 2] = 0.02
    assert not yielding(velocity, push).any()


def test_a_place_more_than_a_millimetre_away_is_sliding() -> None:
    velocity, push = run(7.0)
    assert yielding(velocity, push).any()
    assert not yielding(1.5 * velocity, push).any()


def test_each_run_of_motion_is_looked_at_by_itself() -> None:
    up, down = run(7.0), run(5.2, -1.0)
    marked = yielding(np.concatenate([up[0], down[0], up[0]]), np.concatenate([up[1], down[1], up[1]]))
    length = REST + CREEP + SLIDE
    assert marked[:length].any() and not marked[length : 2 * length].any() and marked[2 * length :].any()
    assert np.array_equal(marked[:length], marked[2 * length :])


def plainly(velocity: np.ndarray, push: np.ndarray) -> np.ndarray:
    """The same, run by run, with numpy."""
    sign = np.sign(velocity)
    begins = np.flatnonzero((np.diff(sign, prepend=0.0) != 0.0) & (sign != 0.0))
    ends = np.append(np.flatnonzero(np.diff(sign) != 0.0) + 1, len(sign))
    found = np.zeros(len(sign), dtype=bool)
    for begin, end in zip(begins, ends[np.searchsorted(ends, begins, side="right")], strict=True):
        ahead, speed = push[begin:end] * sign[begin], np.abs(velocity[begin:end])
        peak = int(np.argmax(ahead[:ONSET]))
        after = slice(peak, peak + FALLS_WITHIN)
        slow = speed[: max(peak - SLIDING_MARGIN, 1)].max() < CREEPS * speed[after].max()
        creeps = slow and PERIOD * speed[: peak + 1].sum() < MOST_TRAVEL
        if creeps and ahead[peak] > 0.0 and ahead[after].min() < FALLS_TO * ahead[peak]:
            found[begin : begin + peak + SLIDING_MARGIN + 1] = True
    return found


def test_it_is_what_the_formula_says_of_any_motion() -> None:
    generator = np.random.default_rng(4)
    marked = 0
    for _ in range(300):
        velocity = np.repeat(generator.choice([-0.02, -0.005, 0.0, 0.004, 0.02], 60), generator.integers(1, 30, 60))
        push = np.cumsum(generator.standard_normal(len(velocity))) + 40.0 * np.sign(velocity)
        found = yielding(velocity, push)
        assert np.array_equal(found, plainly(velocity, push))
        marked += int(found.sum())
    assert marked > 1000
