"""What `hjcamp next` gives: the answer for programs (schema hjcamp.next/1), the picture, and what is printed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hjcamp.analyses.data import joined
from hjcamp.errors import counted
from hjcamp.plants.pump_joint.answers.next_work import Words, Work
from hjcamp.plants.pump_joint.diagnosis.design.propose import ALL_PAIRS, REPETITIONS, Proposal, Proposed, weighted
from hjcamp.plants.pump_joint.diagnosis.design.rivals import NOTHING, Rival
from hjcamp.report.pictures.next import Bar, Labels, Prediction, draw_predictions
from hjcamp.storage import whole_file

if TYPE_CHECKING:
    from rich.console import Console

SCHEMA = "hjcamp.next/1"
DRAWN = 4
APART = 3.0
ROWS = 8
LABELS = Labels(
    ("Arm angle (deg)", "Mean pressure (MPa)", "Pressure difference (MPa)"), "Difference minus that\nof {name} (kPa)"
)
Pairs = dict[tuple[int, int], float]


def answer(proposal: Proposal | None, verdict: str | None, campaign: Path | None, picture: Path | None) -> dict[str, Any]:
    """Return every key of the schema; without a proposal nothing is to be separated."""
    rivals = proposal.rivals if proposal else []
    return {
        "schema": SCHEMA,
        "verdict": verdict,
        "rivals": [{"effects": list(one.effects), "posterior": float(one.posterior)} for one in rivals],
        "tests": [_test(one, rivals) for one in proposal.tests] if proposal else [],
        "together": _pairs(proposal.together, rivals) if proposal else [],
        "campaign": campaign.stem if campaign else None,
        "campaign_file": campaign.as_posix() if campaign else None,
        "picture": picture.as_posix() if picture else None,
        "seconds": 0.0,
    }


def _test(one: Proposed, rivals: list[Rival]) -> dict[str, Any]:
    config = one.trial.config
    return {
        "condition": one.trial.choice.name,
        "text": one.trial.choice.text,
        "trajectory": {key: value for key, value in config["trajectory"].items() if value is not None},
        "controller": config["controller"]["name"],
        "dither_v": float(config["controller"]["dither"]["amplitude_v"]),
        "payload": config["payload"]["name"],
        "orientation": config["orientation"]["name"],
        "preload_mpa": float(config["procedure"]["preload_mpa"]),
        "repetitions": REPETITIONS,
        "duration_s": one.trial.seconds,
        "separation": weighted(one.pairs, rivals),
        "pairs": _pairs(one.pairs, rivals),
    }


def _pairs(pairs: Pairs, rivals: list[Rival]) -> list[dict[str, Any]]:
    return [{"rivals": [rivals[a].name, rivals[b].name], "separation": float(value)} for (a, b), value in pairs.items()]


def names_of(proposal: Proposal) -> str:
    """Return the rivals in words."""
    names = [one.name for one in proposal.rivals]
    if many(proposal.rivals):
        return f"{NOTHING} and {counted(len(names) - 1, 'effect')}"
    return ", ".join(names[:-1]) + f" and {names[-1]}"


def comment_of(proposal: Proposal, words: Words) -> list[str]:
    """Return the head of the campaign's file."""
    source = f"Proposed by hjcamp next from {joined(words.paths)}" if words.paths else "Proposed by hjcamp next before any test"
    return [
        f"{source}, to set apart {names_of(proposal)}.",
        "Separations are expected, in standard deviations of the repetitions.",
    ] + [f"{one.trial.choice.name}: {weighted(one.pairs, proposal.rivals):.1f}" for one in proposal.tests]


def draw(path: Path, proposal: Proposal, work: Work, seed: int) -> None:
    """Write the picture of what the rivals predict for the chosen tests."""
    tests = []
    for one in proposal.tests:
        shown = _shown(proposal.rivals, one.pairs)
        means, spreads, time = {}, {}, np.zeros(0)
        for rival in shown:
            runs = []
            for number in range(REPETITIONS):
                columns = work.bench.columns(one.trial, rival.candidate, seed * 1000 + number)
                if columns is None:
                    continue
                keep = columns["phase"] == 3.0
                time = columns["time_s"][keep]
                first, second = columns["pressure1_mpa"][keep], columns["pressure2_mpa"][keep]
                runs.append(np.column_stack([columns["arm_deg"][keep], 0.5 * (first + second), first - second]))
            if runs:
                means[rival.name], spreads[rival.name] = (
                    np.mean(runs, axis=0),
                    np.std(runs, axis=0, ddof=min(1, len(runs) - 1)),
                )
        title = f"{one.trial.choice.text}\n{one.trial.config['procedure']['preload_mpa']:g} MPa"
        tests.append(Prediction(title, time, means, spreads))
    with whole_file(path) as stream:
        stream.write(draw_predictions(tests, _bars(proposal), LABELS))


def _shown(rivals: list[Rival], pairs: Pairs) -> list[Rival]:
    """Return the rivals that are drawn: all of a few, else "nothing" and those that the test shows best."""
    if len(rivals) <= DRAWN:
        return rivals
    best = sorted(pairs, key=lambda pair: -pairs[pair])[: DRAWN - 1]
    return [rivals[0], *(rivals[max(pair)] for pair in best)]


def _bars(proposal: Proposal) -> list[Bar]:
    rivals, bars = proposal.rivals, []
    for pair, together in sorted(proposal.together.items(), key=lambda item: -item[1]):
        named = [rivals[place].name for place in pair]
        name = named[1] if many(rivals) else " / ".join(named)
        bars.append(Bar(name, together, [one.pairs[pair] for one in proposal.tests]))
    return bars


def many(rivals: list[Rival]) -> bool:
    """Whether all effects stand against "nothing", rather than rivals against each other."""
    return len(rivals) > ALL_PAIRS


def tell(console: Console, proposal: Proposal, work: Work, campaign: Path, picture: Path) -> None:
    """Print the sentence, the table, and what to do next."""
    from rich.table import Table

    rivals, words = proposal.rivals, work.words
    motion = sum(one.trial.seconds for one in proposal.tests) * REPETITIONS
    number = len(proposal.tests)
    console.print(_opening(proposal, work), markup=False)
    size = f"{counted(number, 'test')} x {counted(REPETITIONS, 'repetition')}, {motion:.0f} s of motion"
    console.print(f"PROPOSED   {size}, the best of {proposal.tried} tried in simulation", style="bold", markup=False)
    table = Table(box=None, pad_edge=False, header_style="dim")
    for heading in ("", "test", "preload", "controller", "separation"):
        table.add_column(heading, justify="right" if heading in ("preload", "separation") else "left")
    for place, one in enumerate(proposal.tests, start=1):
        config = one.trial.config
        preload = f"{config['procedure']['preload_mpa']:g} MPa"
        table.add_row(f"  {place}", one.trial.choice.text, preload, config["controller"]["name"], _sigma(one.pairs, rivals))
    console.print(table)
    for line in _outlook(proposal):
        console.print(line, markup=False)
    console.print(f"campaign   {campaign}      picture   {picture}", markup=False)
    console.print(f"next    hjcamp run campaign={campaign.stem}{_where(work)}", markup=False)
    runs = f"runs/{campaign.stem}/UTC_TIME"
    console.print(f"        hjcamp diagnose {joined([*words.paths, Path(runs)])}", markup=False)


def _where(work: Work) -> str:
    """Return the words that run the campaign where the logs come from."""
    if work.found is None:
        return ""
    log = work.found.fitter.views.evidence.tests[0].log
    backend = log.metadata.get("backend", "simulation")
    return "" if backend == "simulation" or "rig" in work.words.fixed else f" backend={backend} rig=YOUR_RIG"


def _opening(proposal: Proposal, work: Work) -> str:
    if work.found is None:
        return f"Nothing is measured yet: the first tests are to set apart {names_of(proposal)}."
    if work.words.rivals:
        return f"The tests so far are to be joined by some that set apart {names_of(proposal)}, each refitted."
    return f"The tests so far cannot set apart {names_of(proposal)}."


def _sigma(pairs: Pairs, rivals: list[Rival]) -> str:
    if many(rivals):
        return f"{sum(value > APART for value in pairs.values())} of {len(pairs)} effects seen"
    return f"{weighted(pairs, rivals):.1f} sigma"


def _outlook(proposal: Proposal) -> list[str]:
    rivals = proposal.rivals
    apart = [pair for pair, value in proposal.together.items() if value > APART]
    similar = [pair for pair in proposal.together if pair not in apart]
    if many(rivals):
        unseen = ", ".join(rivals[max(pair)].name for pair in similar)
        lines = [f"together they would show {len(apart)} of {len(proposal.together)} effects at their usual size"]
        return lines + ([f"not shown by these   {unseen}"] if unseen else [])
    lines = [
        f"together   {rivals[a].name} / {rivals[b].name} {value:.1f} sigma"
        for (a, b), value in list(proposal.together.items())[:ROWS]
    ]
    if similar:
        lines.append("what stays below 3 sigma is the same thing to this rig, or needs other tests than those of the menu")
    return lines
