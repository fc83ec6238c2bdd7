"""The tables and notes of compare, diagnose, add and calibrate for any plant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.commands.any_plant.head_words import print_head
from hjcamp.commands.any_plant.remarks.bound_words import held_by_bounds
from hjcamp.diagnosis.levels import DELTA
from hjcamp.model.declare.base_values import DELAY
from hjcamp.report.wording.units import plain, told, told_all, told_estimate, told_interval, told_like

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.diagnosis.calibration.analysis import Analysis
    from hjcamp.diagnosis.results.addition import Addition

#: Of all channels and shapes together: no quotient of the errors printed beside it, so it is named for what it is.
NORMALISED = "normalised error"
NOISE_FLOORS = {
    "repetitions": "noise floor: repeatability, what repetitions do not share",
    "near_replicates": "noise floor: repeatability estimated from near-replicates (Gamma test; no test was repeated), an upper bound",
    "sensor": "noise floor unknown: no repetitions and too few near-replicates; the sensor's noise in that part is "
    "shown, a lower bound",
}


def noise_floor_note(analysis: Analysis) -> str:
    """Return in words what the noise floor is; without repetitions with the sensors' own noise, which may be far below it."""
    from hjcamp.diagnosis.results.channel_rows import noise_floor_rows
    from hjcamp.report.wording.channels import channel_label

    source = analysis.noise_floor.source
    if source != "near_replicates":
        return f"{NOISE_FLOORS[source]}."
    noise = ", ".join(
        f"{channel_label(name)} {told(row['low'], row['unit'])}" for name, row in noise_floor_rows(analysis).items()
    )
    return f"{NOISE_FLOORS[source]}. The sensors' own noise in that part (third differences): {noise}."


def channel_table(
    rows: Mapping[str, Mapping[str, Any]], whole: Mapping[str, Mapping[str, Any]] | None = None
) -> list[list[str]]:
    """Rows of a channel's error: before, after, noise floor, with the unit; then those of ``whole`` tests, where they are looked at."""
    from hjcamp.report.wording.channels import channel_label

    of_windows = [
        [channel_label(name), *told_all([row[key] for key in ("baseline", "augmented", "floor")], row["unit"])]
        for name, row in rows.items()
    ]
    return of_windows + [
        [f"{channel_label(name)}, whole tests", *(told(row[key]["whole_rms"], row["unit"]) for key in COMPARED), ""]
        for name, row in (whole or {}).items()
    ]


def calibration_table(
    rows: Mapping[str, Mapping[str, Any]], fitted_with: Mapping[str, Mapping[str, Any]] | None = None
) -> list[list[str]]:
    """Rows of a base parameter: declared, here, 95 %, and its value ``beside`` what was found, where something was."""
    from hjcamp.diagnosis.estimation.intervals import limited

    return [
        [
            name.replace("_", " ").replace(DELAY, "delay of "),
            told_like(row["published"], row),
            told_estimate(row),
            told_interval(row) + ("  at its bound" if limited(row) else ""),
            *([_found(fitted_with[name], row) if name in fitted_with else ""] if fitted_with else []),
        ]
        for name, row in rows.items()
    ]


def _found(row: Mapping[str, Any], alone: Mapping[str, Any]) -> str:
    """Return a base parameter with what was found, and whether a bound stops it."""
    from hjcamp.diagnosis.estimation.intervals import limited

    return (told_estimate(row) if row.get("ci95") else told_like(row["value"], alone)) + (
        "  at its bound" if limited(row) else ""
    )


def calibrated(fitted_with: object) -> tuple[str, ...]:
    """Return the headings of that table, with what was found or without."""
    return (*CALIBRATED, "with what was found") if fitted_with else CALIBRATED


def divergence_words(content: Mapping[str, Any]) -> list[str]:
    """Say which of two models diverges where the tests are simulated through, and the other does not, and what errs by more there."""
    which = {"baseline": "The calibrated model", "augmented": "The model with what was found"}
    rows = [(name, *(one[key]["whole_rms"] for key in COMPARED), one["unit"]) for name, one in content["whole_tests"].items()]
    grown = [
        f"{name.replace('_', ' ')} ({plain(before, 3)} -> {plain(after, 3)} {unit})"
        for name, before, after, unit in rows
        if before <= (1.0 - DELTA) * after
    ]
    more = "With what was found the error of whole tests grows: {}. It may stand for something else, that acts slowly."
    return [
        f"{which[one]} {DIVERGES} in free simulation of these tests: it is valid near the measured states only."
        for one in content["runs_away"]
    ] + [more.format(one) for one in grown]


COMPARED = ("baseline", "augmented")
CHANNELS = ("channel", "calibrated", "with what was found", "noise floor")
WHOLE = "each test simulated from its first sample on, begun where it fits best"
SLOW = "Windows judge; what grows slowly, and what windows hardly determine of the parameters, shows in whole tests alone."
WHOLE_NOTE = f"Whole tests: {WHOLE}. {SLOW}"
DIVERGES = "diverges or never forgets its initial state"
CALIBRATED = ("parameter", "declared", "here", "95 %")


def end_words(rows: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Return in words where sensors end, and what that means for a model."""
    from hjcamp.report.wording.channels import channel_label

    return [
        f"{channel_label(name)} reads no {word} than {told(row[key], row['unit'])}: predictions are held there, and "
        f"{plain(100.0 * row['share'], 2)} % of its samples, which read an end, are left out of every fit and score."
        for name, row in rows.items()
        for key, word in (("low", "lower"), ("high", "higher"))
        if row[key] is not None
    ]


def still_words(rows: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Return in words which inputs do not move in any test, and what that leaves open."""
    from hjcamp.report.wording.channels import channel_label

    return [
        f"{channel_label(name)} keeps one value, {told(row['value'], row['unit'])}, in all tests: its effect cannot be identified "
        "from them, nor anything that depends on it."
        for name, row in rows.items()
    ]


def print_addition(console: Console, found: Addition, names: Sequence[str], path: Path) -> None:
    """Print what was fitted and how the error fell."""
    from hjcamp.commands.shared.wrapped import print_wrapped
    from hjcamp.diagnosis.results.addition import answer

    content = answer(found, path.stem, str(path))
    print_head(console, found.analysis)
    rows = [
        [name, parameter.replace("_", " "), told_estimate(row), told_interval(row) + bound_word(row)]
        for name in names
        for parameter, row in content["parameters"].get(name, {}).items()
    ]
    table(console, ("effect", "parameter", "value", "95 %"), rows)
    whole, error = content["whole_tests"], content["error"]
    table(console, CHANNELS, channel_table(content["channels"], whole))
    said = f"Normalised error on held-out blocks: {error['before']:.2f} -> {error['after']:.2f}."
    slow = [WHOLE_NOTE] if whole else []
    print_wrapped(console, [said, *helped(found, content), *divergence_words(content), *slow, *end_words(content["ends"])], 8)
    console.print(f"model   {path}", markup=False)


def bound_word(row: Mapping[str, Any]) -> str:
    """Return that a value stands at a bound, behind its interval, where it does."""
    return "  at its bound" if row["at_bound"] else ""


def helped(found: Addition, content: Mapping[str, Any]) -> list[str]:
    """Return in words that a model explains the tests no better, where it is not shown to; or whole tests alone."""
    from hjcamp.diagnosis.validation.blocks import critical

    if found.helps:
        return []
    search, base = found.analysis.search, found.analysis.base
    if found.gain < DELTA:
        whole = content["whole_tests"].values()
        if content["runs_away"] == ["baseline"]:
            return [
                "The error of windows does not fall by a relevant share; but over whole tests this model follows the measurement, "
                "where the calibrated one does not."
            ]
        if any(row["augmented"]["whole_rms"] <= (1.0 - DELTA) * row["baseline"]["whole_rms"] for row in whole):
            return ["The error of windows does not fall by a relevant share; that of whole tests does."]
        return ["The error does not fall by a relevant share: this model explains these tests no better."]
    t, blocks = search.t(found.model, base)
    how = f"not block by block (t = {t:.1f} over {blocks:.1f} blocks, {critical(blocks):.1f} needed)"
    # of less than two no spread is known
    how = how if blocks >= 2.0 else "in too few parts of the tests to be shown"
    return [f"The error falls, but {how}: more tests would show whether this model is better."]


def print_calibration(console: Console, analysis: Analysis, rows: Mapping[str, Mapping[str, Any]]) -> None:
    """Print the base parameters as declared and as fitted."""
    from hjcamp.commands.shared.wrapped import print_wrapped

    print_head(console, analysis)
    table(console, CALIBRATED, calibration_table(rows))
    print_wrapped(console, held_by_bounds(rows), 8)


def table(console: Console, headings: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a plain table."""
    from rich.table import Table
    from rich.text import Text

    found = Table(box=None, pad_edge=False, header_style="dim")
    for index, heading in enumerate(headings):
        found.add_column(
            f"  {heading}" if index == 0 else heading, justify="left" if index == 0 else "right", no_wrap=index == 0
        )
    for row in rows:
        found.add_row(*(Text(f"  {cell}" if index == 0 else cell) for index, cell in enumerate(row)))
    console.print(found)
