"""Where, in words: what is said first, no z, cuts that do not seem to add up."""

from __future__ import annotations

from typing import NamedTuple

import pytest

from hjcamp.plants.pump_joint.answers.where_words import grouped_bars, phrase, where_sentences
from hjcamp.report.wording.repeatability import worse_calibrated


class Place(NamedTuple):
    """A place with all that the sentences need."""

    subsystem: str
    variable: str
    bin: str
    share: float
    shown: int = 6
    conditions: int = 8
    total: int = 8


PLACES = [
    Place("joint", "all", "all", 0.9),
    Place("joint", "arm_velocity", "positive, 0 to 2 mm/s", 0.58),
    Place("joint", "direction", "positive", 0.5),
    Place("joint", "arm_velocity", "positive, 2 to 4 mm/s", 0.2),
    Place("lines", "all", "all", 0.1),
]


@pytest.mark.parametrize(
    ("variable", "label", "told"),
    [
        ("all", "all", ""),
        ("direction", "negative", "moving in the negative direction"),
        ("arm_velocity", "positive, 0 to 2 mm/s", "moving in the positive direction, below 2 mm/s"),
        ("arm_velocity", "positive, 2 to 4 mm/s", "moving in the positive direction, at 2 to 4 mm/s"),
        ("pressure_sum", "at rest, 0.9 to 1 MPa", "at rest, sum of the pressures 0.9 to 1 MPa"),
        ("time", "at rest, 2 to 4 s", "at rest, 2 to 4 s into the test"),
        ("repetition", "2", "repetition 2"),
    ],
)
def test_a_bin_in_words(variable: str, label: str, told: str) -> None:
    assert phrase(variable, label) == told


def test_the_sentences() -> None:
    said = where_sentences(PLACES, 6.0)
    assert said[0].startswith("90 % of the error above repeatability: joint (")
    assert said[1].startswith("10 % of the error above repeatability: lines (")
    strongest = "joint, moving in the positive direction, below 2 mm/s, in 6 of 8 conditions."
    assert said[2] == f"58 % of the error above repeatability: {strongest}"
    assert "same error, grouped differently" in said[3] and len(said) == 4


def test_conditions_without_such_moments_are_counted_apart() -> None:
    some = [PLACES[0], PLACES[1]._replace(shown=4, conditions=4)]
    assert where_sentences(some, 6.0)[1].endswith("below 2 mm/s, in 4 of 4 conditions with such moments (8 in all).")


def test_little_left_is_said_first() -> None:
    said = where_sentences(PLACES, 1.12)
    assert said == ["The error is 1.1 x the noise floor: nothing stands out (of that little, 90 % joint, 10 % lines)."]
    alone = where_sentences([])[0]
    assert alone.startswith("No test was repeated, so repeatability is unknown") and "repetitions=3" in alone
    assert "stands out" not in alone
    assert where_sentences([], 1.2)[0].startswith("The error is 1.2 x the noise floor: nothing stands out")


def test_a_calibration_that_makes_it_worse_is_said() -> None:
    [said] = worse_calibrated("published", 0.74, 1.10, "the fit looks elsewhere")
    assert said == "Calibrated, published is further off than as it stands (1.10 against 0.74): the fit looks elsewhere."
    assert worse_calibrated("published", 1.0, 1.01, "") == worse_calibrated("a", 6.0, 1.0, "") == []
    assert worse_calibrated("a", 1.0, float("nan"), "") == []


def test_repetitions_are_told_only_where_they_differ() -> None:
    even = [Place("lines", "all", "all", 0.9), *(Place("lines", "repetition", str(n), 0.3) for n in (1, 2, 3))]
    assert len(where_sentences(even)) == 1 and len(grouped_bars([place._asdict() for place in even])) == 1
    drifting = [
        Place("joint", "all", "all", 0.9),
        Place("joint", "repetition", "3", 0.7),
        Place("joint", "repetition", "1", 0.1),
    ]
    assert "joint, repetition 3, in 6 of 8 conditions" in where_sentences(drifting)[1]


def test_bars_are_in_groups() -> None:
    bars = grouped_bars([place._asdict() for place in PLACES])
    assert [one[:2] for one in bars] == [
        ("", "joint"),
        ("", "lines"),
        ("joint, by arm velocity", "positive, 0 to 2 mm/s"),
        ("joint, by arm velocity", "positive, 2 to 4 mm/s"),
        ("joint, by direction", "positive"),
    ]
