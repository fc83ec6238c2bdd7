"""The tables and notes of compare, diagnose, add and calibrate for any plant."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.commands.any_plant.head_words import print_head
from hjcamp.commands.any_plant.plant_hints import far_states
from hjcamp.diagnosis.levels import MATTERS
from hjcamp.diagnosis.results.shares import left_of
from hjcamp.model.declare.base_values import DELAY
from hjcamp.report.wording.units import plain, told, told_all, told_estimate, told_interval, told_like

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.diagnosis.calibration.analysis import Analysis
    from hjcamp.diagnosis.results.addition import Addition
    from hjcamp.diagnosis.results.comparison import Comparison

#: Of all channels and shapes together: no quotient of the errors printed beside it, so it is named for what it is.
NORMALISED = "normalised error"
FLOORS = {
    "repetitions": "noise floor: repeatability, what repetitions do not share",
    "near_replicates": "noise floor: repeatability estimated from near-replicates (Gamma test; no test was repeated), an upper bound",
    "sensor": "noise floor unknown: no repetitions and too few near-replicates; the sensor's noise in that part is "
    "shown, a lower bound",
}


def floor_note(analysis: Analysis) -> str:
    """Return in words what the floor is; without repetitions with the sensors' own noise, which may be far below it."""
    from hjcamp.diagnosis.results.answer import floor_rows
    from hjcamp.report.wording.channels import channel_label

    source = analysis.floor.source
    if source != "near_replicates":
        return f"{FLOORS[source]}."
    noise = ", ".join(f"{channel_label(name)} {told(row['low'], row['unit'])}" for name, row in floor_rows(analysis).items())
    return f"{FLOORS[source]}. The sensors' own noise in that part (third differences): {noise}."


def channel_table(
    rows: Mapping[str, Mapping[str, Any]], whole: Mapping[str, Mapping[str, Any]] | None = None
) -> list[list[str]]:
    """Rows of a channel's error: before, after, floor, with the unit; then those of ``whole`` tests, where they are looked at."""
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
    rows: Mapping[str, Mapping[str, Any]], beside: Mapping[str, Mapping[str, Any]] | None = None
) -> list[list[str]]:
    """Rows of a base parameter: declared, here, 95 %, and its value ``beside`` what was found, where something was."""
    from hjcamp.diagnosis.estimation.intervals import limited

    return [
        [
            name.replace("_", " ").replace(DELAY, "delay of "),
            told_like(row["published"], row),
            told_estimate(row),
            told_interval(row) + ("  at its bound" if limited(row) else ""),
            *([_found(beside[name], row) if name in beside else ""] if beside else []),
        ]
        for name, row in rows.items()
    ]


def _found(row: Mapping[str, Any], alone: Mapping[str, Any]) -> str:
    """Return a base parameter beside what was found, and whether a bound stops it."""
    from hjcamp.diagnosis.estimation.intervals import limited

    return (told_estimate(row) if row.get("ci95") else told_like(row["value"], alone)) + (
        "  at its bound" if limited(row) else ""
    )


def calibrated(beside: object) -> tuple[str, ...]:
    """Return the headings of that table, with what was found or without."""
    return (*CALIBRATED, "with what was found") if beside else CALIBRATED


def held_by_bounds(rows: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Return a sentence for each base parameter at a bound that is far from what is declared, or of which the tests tell nothing."""
    from hjcamp.diagnosis.estimation.intervals import limited

    found = []
    for name, row in rows.items():
        said, value = name.replace("_", " "), told(row["value"], row["unit"])
        if row.get("held"):
            found.append(
                f"{said} is held by its bound, {value}, far from what is declared: is a sign or a unit wrong in the plant's file or in "
                "the import map? It may absorb the missing effect."
            )
        elif limited(row) and not row.get("told", True) and not name.startswith(DELAY):
            found.append(
                f"{said} stands at its bound, {value}, and these tests do not determine it: do they not excite it, or is a "
                "sign or a unit wrong?"
            )
    return found


def other_sizes(rows: Mapping[str, Mapping[str, Any]], candidates: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return in words which effects stand at bounds that follow from what the plant declares, where its base is far from that."""
    from hjcamp.diagnosis.estimation.intervals import limited

    near = [one for one in candidates if left_of(one) < 1.0]
    # a share has the same bounds on every plant
    held = [one["effect"] for one in near if any(limited(row) for row in one["parameters"].values() if row["unit"] != "1")]
    told_here = {name: row for name, row in rows.items() if row["published"] and row.get("told", True) and not row["at_bound"]}
    moved = {name: abs(row["value"] / row["published"]) for name, row in told_here.items()}
    far = [
        f"{name.replace('_', ' ')} is {ratio:.2g} times as large" for name, ratio in moved.items() if not 0.5 <= ratio <= 2.0
    ]
    if not held or not far:
        return []
    return [
        f"The bounds of effects follow from the plant's file, and here {', '.join(far)}: {', '.join(held)} may stand at a bound for "
        "that reason. Write the values that the table has into the file, and ask again."
    ]


def ends_of_laws(named: Sequence[str], candidates: Sequence[Mapping[str, Any]], library: Mapping[str, Any]) -> list[str]:
    """Return a sentence for each shape of a named law that the tests want farther than the law may have it."""
    return [
        f"{parameter.replace('_', ' ')} of {one['effect']} stands at the end of what this law may have, "
        f"{told(row['value'], row['unit'])}: another law of the same place may be what is missing."
        for one in candidates
        if one["effect"] in named
        for parameter, row in one["parameters"].items()
        if row["at_bound"] and row.get("told", True) and library[one["effect"]].parameters[parameter].shape
    ]


def late_inputs(rows: Mapping[str, Mapping[str, Any]], named: Sequence[str], period: float) -> list[str]:
    """Return what delays of the base say that stand at their bound, or are longer than a log may be off: one sample of ``period``."""
    late = {
        name.removeprefix(DELAY).replace("_", " "): row
        for name, row in rows.items()
        if name.startswith(DELAY) and row["value"] > 0.0
    }
    most = [name for name, row in late.items() if row["at_bound"]]
    longer = [name for name, row in late.items() if (row["ci95"][0] or 0.0) > period]
    if {"command_delay", "action_lag", "sensor_lag"} & {name.split("_at_")[0] for name in named}:
        own = [f"{name} by {late[name]['value']:.3g} s" for name in dict.fromkeys(most + longer)]
        return [f"Input delays were also fitted ({', '.join(own)}): the total lag is the sum."] if own else []
    if most:
        return [
            f"The delay of {' and '.join(most)} stands at the most that the base may have, {plain(late[most[0]]['value'], 3)} s: a "
            "longer one, or a lag, is an effect (command_delay, sensor_lag)."
        ]
    return [
        f"The {name} acts {plain(late[name]['value'], 3)} s late, more than the one sample by which a log may be off: the base "
        "absorbs so short a delay, and the cause may be another (command_delay, sensor_lag, second_store)."
        for name in longer
    ]


def run_away_words(content: Mapping[str, Any]) -> list[str]:
    """Say which of two models runs away where the tests are simulated through, and the other does not, and what errs by more there."""
    which = {"baseline": "The calibrated model", "augmented": "The model with what was found"}
    rows = [(name, *(one[key]["whole_rms"] for key in COMPARED), one["unit"]) for name, one in content["whole_tests"].items()]
    grown = [
        f"{name.replace('_', ' ')} ({plain(before, 3)} -> {plain(after, 3)} {unit})"
        for name, before, after, unit in rows
        if before <= (1.0 - MATTERS) * after
    ]
    more = "With what was found the error of whole tests grows: {}. It may stand for something else, that acts slowly."
    return [
        f"{which[one]} {RUNS_AWAY} in free simulation of these tests: it is valid near the measured states only."
        for one in content["runs_away"]
    ] + [more.format(one) for one in grown]


COMPARED = ("baseline", "augmented")
CHANNELS = ("channel", "calibrated", "with what was found", "noise floor")
WHOLE = "each test simulated from its first sample on, begun where it fits best"
SLOW = "Windows judge; what grows slowly, and what windows hardly determine of the parameters, shows in whole tests alone."
WHOLE_NOTE = f"Whole tests: {WHOLE}. {SLOW}"
RUNS_AWAY = "diverges or never forgets its initial state"
CALIBRATED = ("parameter", "declared", "here", "95 %")


def print_comparison(console: Console, found: Comparison) -> None:
    """Print the errors of the models."""
    from hjcamp.commands.shared.wrapped import print_wrapped
    from hjcamp.diagnosis.results.answer import calibration

    print_head(console, found.analysis)
    table(console, *comparison_table(found))
    print_wrapped(console, [floor_note(found.analysis)], 8)
    print_wrapped(console, notes_on(found), 8)
    worse = [one.name for one in (*found.models, found.calibrated) if any(one.explained < 0.0)]
    if worse:
        of = "test" if found.analysis.windows.layout.memory else "window"
        print_wrapped(console, [f"{', '.join(worse)}: worse than the mean of each {of} in a channel (explained below 0)."], 8)
    print_wrapped(console, held_by_bounds(calibration(found.analysis)), 8)
    if rows := whole_table(found):
        console.print(f"whole tests   {WHOLE}", markup=False)
        table(console, *rows)
        print_wrapped(console, [SLOW], 8)


def end_words(rows: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Return in words where sensors end, and what that means for a model."""
    from hjcamp.report.wording.channels import channel_label

    return [
        f"{channel_label(name)} reads no {word} than {told(row[key], row['unit'])}: predictions are held there, and "
        f"{100.0 * row['share']:.2g} % of its samples, which read an end, are left out of every fit and score."
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


def notes_on(found: Comparison) -> list[str]:
    """Return in words where sensors end, and where the last model is the worse for being calibrated."""
    from hjcamp.diagnosis.results.answer import end_rows

    windows = found.analysis.windows
    return [*end_words(end_rows(windows.layout)), *further_off(found), *far_states(windows)]


def further_off(found: Comparison) -> list[str]:
    """Return in words where the last model is the worse for being calibrated, and where one errs less in a channel than a nearer."""
    from hjcamp.report.wording.repeatability import worse_calibrated

    last, here = found.models[-1], found.calibrated
    why = "the fit gives less weight to what scatters more, this number weights all equally; use it as it stands"
    said = worse_calibrated(last.name, last.score, here.score, why)
    beside = [(here, "what is calibrated here"), *((one, one.name) for one in found.models)]
    better = [
        f"{one.name} errs less in {sensor.quantity.replace('_', ' ')} than {label}, though its normalised error is "
        "larger: that weights "
        "all shapes of the error in all channels equally, each by its noise; an rms is mostly its largest shape, of "
        "which a fit gives up "
        "some for the others where something is missing."
        for other, label in beside
        for k, sensor in enumerate(found.analysis.measured.sensors)
        for one in found.models
        if one.rms[k] < (1.0 - MATTERS) * other.rms[k] and one.score > other.score
    ]
    return said + better[:1]


def _share(explained: float) -> str:
    """Return a share in percent; of a model that runs away no number is worth reading."""
    return f"{100.0 * explained:.2f} %" if explained > -100.0 else "far below 0"


def _error(value: float, unit: str) -> str:
    """Return an error, or that there is none."""
    return told(value, unit) if math.isfinite(value) else "diverges"


def comparison_table(found: Comparison) -> tuple[tuple[str, ...], list[list[str]]]:
    """Return the head and rows of a comparison: model, each channel's rms with the share explained, over the floor."""
    from hjcamp.report.wording.channels import channel_label

    layout = found.analysis.windows.layout
    sensors = layout.measured.sensors
    head = (
        "model",
        *(channel_label(one.field) for one in sensors),
        *(f"{channel_label(one.field)} explained" for one in sensors),
        NORMALISED,
    )
    rows = [
        [
            one.name,
            *(_error(one.rms[k] * s.scale, s.unit) for k, s in enumerate(sensors)),
            *(_share(one.explained[k]) for k in range(len(sensors))),
            f"{one.score:.2f}" if math.isfinite(one.score) else "",
        ]
        for one in (*found.models, found.calibrated)
    ]
    floor = found.analysis.floor.of_sensors(layout)
    rows.append(
        [
            "noise floor",
            *(told(floor[k] * s.scale, s.unit) for k, s in enumerate(sensors)),
            *("" for _ in sensors),
            "1.00",
        ]
    )
    return head, rows


def whole_table(found: Comparison) -> tuple[tuple[str, ...], list[list[str]]] | None:
    """Return the head and rows of a comparison over whole tests, which of them run away; nothing where none is looked at so."""
    from hjcamp.report.wording.channels import channel_label

    sensors = found.analysis.measured.sensors
    labels = [channel_label(one.field) for one in sensors]
    models = (*found.models, found.calibrated)
    rows = [
        [
            one.name,
            *(told(one.whole.rms[k] * s.scale, s.unit) for k, s in enumerate(sensors)),
            *map(_share, one.whole.explained),
        ]
        if one.whole
        else [one.name, RUNS_AWAY, *[""] * (2 * len(sensors) - 1)]
        for one in models
    ]
    return (("model", *labels, *(f"{label} explained" for label in labels)), rows) if any(one.whole for one in models) else None


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
    print_wrapped(console, [said, *helped(found, content), *run_away_words(content), *slow, *end_words(content["ends"])], 8)
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
    if search.error_ratio(found.model, base) > 1.0 - MATTERS:
        whole = content["whole_tests"].values()
        if content["runs_away"] == ["baseline"]:
            return [
                "The error of windows does not fall by a relevant share; but over whole tests this model follows the measurement, "
                "where the calibrated one does not."
            ]
        if any(row["augmented"]["whole_rms"] <= (1.0 - MATTERS) * row["baseline"]["whole_rms"] for row in whole):
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
