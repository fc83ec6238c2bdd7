"""Print the answer of a diagnosis of any plant."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hjcamp.commands.any_plant.head_words import over_windows, print_head
from hjcamp.commands.any_plant.verdict_words import CANDIDATES, Words
from hjcamp.commands.any_plant.words import (
    CHANNELS,
    WHOLE_NOTE,
    calibrated,
    calibration_table,
    channel_table,
    noise_floor_note,
    table,
)

if TYPE_CHECKING:
    from rich.console import Console

STYLES = {"nothing_missing": "green", "effect": "bold", "one_of": "bold"}


def print_diagnosis(console: Console, words: Words) -> None:
    """Print the answer."""
    from hjcamp.commands.shared.wrapped import print_wrapped

    analysis = words.analysis
    print_head(console, analysis)
    fitted_with = words.fitted_with
    table(console, calibrated(fitted_with), calibration_table(words.content["calibration"], fitted_with))
    style = "yellow" if words.far_off and words.verdict.word == "nothing_missing" else STYLES.get(words.verdict.word, "yellow")
    console.print(words.title, style=style, markup=False, highlight=False)
    print_wrapped(console, words.sentences(), 8)
    if rows := words.candidates():
        table(console, CANDIDATES, rows)
        print_wrapped(console, words.added_note, 8)
    console.print(f"error   {over_windows(analysis)}", markup=False)
    whole = words.content["whole_tests"]
    table(console, CHANNELS, channel_table(words.content["channels"], whole))
    print_wrapped(console, [noise_floor_note(analysis), *([WHOLE_NOTE] if whole else [])], 8)
    print_wrapped(console, words.where(), 8, "where")
    print_wrapped(console, words.worst(), 8, "worst")
