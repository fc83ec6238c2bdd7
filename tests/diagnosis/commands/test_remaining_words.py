"""What is said of the error that remains, and how to go on."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from hjcamp.commands.any_plant.next_commands import next_commands
from hjcamp.commands.any_plant.remarks.remaining_words import most_remains, over_noise
from hjcamp.commands.any_plant.verdict_words import Words


@pytest.mark.parametrize("word", ["one_of", "outside_library"])
def test_names_that_are_not_ruled_out_are_told_how_to_go_on(word: str) -> None:
    sets = (("spring",), ("drag",))
    said: Any = SimpleNamespace(word=word, effects=("spring", "drag"), confidence_set=sets, outside=word != "one_of")
    words = Words(SimpleNamespace(), said, {"unknowns": []})  # type: ignore[arg-type]
    assert words.or_outside == (word != "one_of")
    assert not words.or_outside or words.title == "ONE OF THESE, OR OUTSIDE  spring; drag"
    steps = next_commands(words, "logs", "published")
    assert steps == ["hjcamp next logs", *(f"hjcamp add {one} logs --as with_{one}" for (one,) in sets)]


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
def test_that_much_of_the_error_remains_with_a_name_is_said(
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
