"""What repetitions share of an error is told without what they differ by, and which conditions err most is said."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hjcamp.diagnosis.data.repeatability import shared
from hjcamp.plants.pump_joint.diagnosis.answer_rows import confidence_set, worst
from hjcamp.plants.pump_joint.diagnosis.scale import Judged, Scale, shared_by
from hjcamp.report.wording.repeatability import worst_table, worst_words


def test_scatter_cancels_and_what_is_shared_stays() -> None:
    generator = np.random.default_rng(4)
    course = np.sin(np.linspace(0.0, 20.0, 4000))
    noisy = [0.3 * course + generator.normal(0.0, 0.5, 4000) for _ in range(4)]
    assert shared_by(noisy) == pytest.approx(0.3 / np.sqrt(2.0), abs=0.015)
    # by hand: (1 * 3 + 2 * 1) / 2 for two repetitions of two samples, the longer one cut
    assert shared_by([np.array([1.0, 2.0]), np.array([3.0, 1.0, 9.0])]) == pytest.approx(np.sqrt(2.5))
    # what is of opposite sign is not shared at all
    assert shared_by([course, -course]) == 0.0
    assert np.isnan(shared_by([course]))


def test_windows_of_repetitions_share_what_their_features_share() -> None:
    # two sensors with two coefficients each; three windows in the first two tests, two in the third
    layout: Any = SimpleNamespace(
        of_test=np.array([0, 0, 0, 1, 1, 1, 2, 2]),
        width=4,
        measured=SimpleNamespace(sensors=("a", "b"), noise=np.array([0.1, 10.0])),
        predictions=lambda one: one,
    )
    features = np.zeros((8, 4))
    features[:, 0], features[:3, 2], features[3:6, 2] = 2.0, 1.0, -1.0
    found = shared(layout, features, [0, 1])
    assert found is not None and found == pytest.approx([0.1 * np.sqrt(4.0 / 4.0), 0.0])
    assert shared(layout, features, [2]) is None
    layout.of_test = np.array([0, 0, 0, 0, 0, 0, 2, 2])
    assert shared(layout, features, [0, 1]) is None


def test_the_worst_conditions_are_told_over_their_floor() -> None:
    evidence: Any = SimpleNamespace(tests=[SimpleNamespace(condition=name) for name in ("slow", "fast", "slow", "fast")])
    scale = Scale({"arm_deg": 0.5, "pressure1_mpa": 0.01, "pressure2_mpa": None}, {"pressure2_mpa": 0.02})
    after = Judged(
        {}, 1.0, (), (0, 2, 3), {"arm_deg": (1.0, 2.0, 0.5), "pressure1_mpa": (0.01,) * 3, "pressure2_mpa": (0.02,) * 3},
        {"arm_deg": {"slow": 1.2, "fast": float("nan")}, **{f"pressure{k}_mpa": {"slow": 0.0, "fast": float("nan")} for k in (1, 2)}},
    )  # fmt: skip
    rows = worst(evidence, scale, after)
    assert [(row["condition"], row["channel"]) for row in rows[:1]] == [("slow", "arm_deg")]
    assert rows[0]["over_floor"] == pytest.approx(np.sqrt(2.5) / 0.5) and (rows[0]["shared"], rows[0]["unit"]) == (1.2, "deg")
    assert next(row for row in rows if row["condition"] == "fast")["shared"] is None
    [said] = worst_words(rows, "the noise floor")
    assert said.startswith("slow 3.2 x the noise floor in arm angle, 1.2 deg of it shared by repetitions; ")
    assert said.endswith("; fast 1 x the noise floor in arm angle.")
    headings, table = worst_table(rows)
    assert headings[-1] == "shared by repetitions" and table[0] == ["slow", "arm angle", "3.16", "1.2 deg"]
    headings, table = worst_table([row | {"shared": None} for row in rows])
    assert (
        headings[-1] == "error / noise floor"
        and table[0] == ["slow", "arm angle", "3.16"]
        and worst_words([], "the noise floor") == []
    )


@pytest.mark.parametrize(
    ("verdict", "effects", "undecided", "taken", "sets"),
    [
        ("nothing_missing", [], (), [], [[]]),
        ("effect", ["leakage", "presliding"], (), ["leakage", "presliding"], [["leakage", "presliding"]]),
        ("effect", ["leakage"], ("encoder_lag", "presliding"), ["leakage", "encoder_lag"],
         [["leakage", "encoder_lag"], ["leakage", "presliding"]]),
        ("one_of", ["gravity_load", "leakage"], ("gravity_load", "leakage"), ["gravity_load", "presliding"],
         [["presliding", "gravity_load"], ["presliding", "leakage"]]),
        ("outside_library", [], (), ["gravity_load"], []),
        ("cannot_tell", [], (), [], []),
    ],
)  # fmt: skip
def test_the_sets_that_the_tests_do_not_rule_out(
    verdict: str, effects: list[str], undecided: tuple[str, ...], taken: list[str], sets: list[list[str]]
) -> None:
    found: Any = SimpleNamespace(
        verdict=verdict, effects=effects, undecided=undecided, taken=[SimpleNamespace(best=name) for name in taken]
    )
    assert confidence_set(found) == sets
