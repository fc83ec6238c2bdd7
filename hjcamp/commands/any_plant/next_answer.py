"""What `hjcamp next` says of tests of any plant: the answer for programs (schema hjcamp.next/2), the picture, the table."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np

from hjcamp.errors import counted, plain
from hjcamp.report.wording.units import told

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.analyses.proposing import PlantProposed
    from hjcamp.diagnosis.design.beyond import Beyond
    from hjcamp.diagnosis.design.proposal import Pairs, Proposal, Proposed

SCHEMA = "hjcamp.next/2"
COLUMNS = 3
DRAWN = 4
TITLE = 42
HEAD = ("test", "apart by", "beyond the logs")


def answer(done: PlantProposed, campaign: Path | None, picture: Path | None, seconds: float) -> dict[str, Any]:
    """Return every key of the schema."""
    proposal = done.proposal
    rivals = proposal.question.rivals
    return {
        "schema": SCHEMA,
        "plant": done.analysis.measured.plant.name,
        "verdict": done.diagnosis["verdict"],
        "rivals": [
            {
                "effects": list(one.names),
                "posterior": 1.0 / len(rivals),
                "fitted": one.fitted,
                "parameters": {name: dict(values) for name, values in one.candidate.effects.items()},
            }
            for one in rivals
        ],
        "tests": [_test(one, proposal) for one in proposal.tests[: proposal.chosen]],
        "others": [_test(one, proposal) for one in proposal.tests[proposal.chosen :]],
        "together": _pairs(proposal.together, proposal),
        "best_separation": float(proposal.best),
        "needed_separation": _needed(),
        "tried": proposal.tried,
        "driven_by": "motion" if proposal.by_motion else "inputs",
        "telling": telling(done),
        "reused": done.reused.as_posix() if done.reused else None,
        "campaign": campaign.stem if campaign else None,
        "campaign_file": campaign.as_posix() if campaign else None,
        "picture": picture.as_posix() if picture else None,
        "seconds": round(seconds, 3),
    }


def _needed() -> float:
    from hjcamp.diagnosis.design.proposal import APART

    return APART


def _test(one: Proposed, proposal: Proposal) -> dict[str, Any]:
    return {
        "condition": one.wanted.name,
        "text": one.wanted.text,
        "from_test": one.of,
        "changes": dict(one.wanted.changes),
        "given": dict(one.wanted.given),
        "input": one.wanted.driven or None,
        "pieces": [list(piece) for piece in one.wanted.pieces],
        "repetitions": one.repetitions,
        "duration_s": one.seconds,
        "separation": min(one.pairs.values(), default=0.0) if len(one.pairs) == 1 else float(np.mean(list(one.pairs.values()))),
        "pairs": _pairs(one.pairs, proposal),
        "before_refit": _pairs(one.linear, proposal),
        "beyond": [asdict(each) for each in one.beyond],
    }


def _pairs(pairs: Pairs, proposal: Proposal) -> list[dict[str, Any]]:
    rivals = proposal.question.rivals
    return [{"rivals": [rivals[a].name, rivals[b].name], "separation": float(value)} for (a, b), value in pairs.items()]


def telling(done: PlantProposed) -> list[str]:
    """Return in words which kinds of test distinguish the rivals."""
    from hjcamp.commands.any_plant.remarks.telling_words import telling_tests

    names = [name for one in done.proposal.question.rivals for name in one.names]
    return telling_tests(names, done.diagnosis["unknowns"], done.analysis.search.library)


def names_of(proposal: Proposal) -> str:
    """Return the rivals in words."""
    names = [one.name for one in proposal.question.rivals]
    return ", ".join(names[:-1]) + f" and {names[-1]}" if len(names) > 1 else names[0]


def title(done: PlantProposed) -> str:
    """Return the answer in one line."""
    proposal = done.proposal
    if len(proposal.question.rivals) < 2:
        return "NOTHING TO SEPARATE"
    if not proposal.chosen:
        return "NO DISCRIMINATING TEST"
    one = proposal.tests[0]
    size = f"{counted(proposal.chosen, 'test')} of {plain(one.seconds)} s"
    again = f", {one.repetitions} repetitions each" if one.repetitions > 1 else ""
    return f"PROPOSED   {size}{again}, the best of {proposal.tried} tried in simulation"


def sentences(done: PlantProposed) -> list[str]:
    """Return what is proposed, or that nothing is, in sentences."""
    proposal, said = done.proposal, telling(done)
    found = [f"{one}." for one in done.diagnosis.get("lacking", ())]
    if len(proposal.question.rivals) < 2:
        return [
            *found,
            "No rivals remain: every effect of the library would be detectable in these tests at its typical size.",
        ]
    found += _left_out(done)
    hidden = [one.name for one in proposal.question.rivals if not one.fitted]
    if hidden:
        found.append(f"At their typical size these would not be detectable in the tests so far: {', '.join(hidden)}.")
    if not proposal.tried:
        found.append("Every test generated from these logs makes a rival diverge, or goes far beyond what the logs visited.")
    elif not proposal.chosen:
        best = proposal.tests[0].wanted.text if proposal.tests else ""
        apart = f"; the best, {best}, separates one pair by {proposal.best:.1f} standard deviations" if best else ""
        found.append(
            f"None of {proposal.tried} tests separates any two by {_needed():.0f} standard deviations{apart}. "
            "More repetitions lower that limit with the root of their number."
        )
    else:
        similar = [key for key in proposal.question.pairs if proposal.together.get(key, 0.0) < _needed()]
        rivals = proposal.question.rivals
        if similar:
            pairs = ", ".join(f"{rivals[a].name} / {rivals[b].name}" for a, b in similar)
            found.append(f"Still indistinguishable after these tests: {pairs}.")
        if proposal.by_motion:
            found.append(
                "Each test is a motion, as this plant stays where it is moved: a loop or a course of inputs has to make it; what that "
                "has to give is in the answer (beyond), and may be more than your drive can."
            )
    if said and (not proposal.chosen or any(value < _needed() for value in proposal.together.values())):
        which = (
            "Kinds of test that distinguish" if proposal.chosen else "Beyond what was tried, kinds of test that may distinguish"
        )
        found.append(f"{which} them: {'; '.join(said)}.")
    return found


def _left_out(done: PlantProposed) -> list[str]:
    """Say which sets that the tests do not rule out are not distinguished here, since so many at once are the most."""
    from hjcamp.diagnosis.design.rivals import MOST

    sets = [" + ".join(one) for one in done.diagnosis.get("confidence_set", ())]
    names = [one.name for one in done.proposal.question.rivals]
    left = [one for one in sets if one and one not in names]
    if not left or len(names) < MOST or not set(names) <= set(sets):
        return []
    return [f"The tests do not rule out {', '.join(left)} either; {MOST} are distinguished at once: --rivals A,B names others."]


def no_campaign(proposal: Proposal) -> str:
    """Return why the proposed tests are no campaign of `hjcamp run`."""
    if proposal.by_motion:
        return (
            "none: these tests are motions, for a loop outside the plant's equations or a hand, and hjcamp run gives an input"
        )
    changed = [one.wanted.text for one in proposal.tests[: proposal.chosen] if not one.wanted.pieces]
    if changed:
        return f"none: hjcamp run holds an input at levels, and '{changed[0]}' is a measured test that is changed"
    return "none: hjcamp run gives one input alone while all others rest, and these tests do not"


def rows(proposal: Proposal) -> list[list[str]]:
    """Return the table of the tests: words, separation of the pairs, what leaves the logs."""
    return [
        [one.wanted.text, _apart(one.pairs), "; ".join(_beyond(each) for each in one.beyond[:2]) or "-"]
        for one in proposal.tests[: proposal.chosen]
    ]


def _apart(pairs: Pairs) -> str:
    values = [_sigma(value) for value in pairs.values()]
    return " / ".join(values) if len(values) <= 3 else f"{min(values)} to {max(values)}"


def _sigma(value: float) -> str:
    return f"{min(value, 999.0):.1f}"


def _beyond(one: Beyond) -> str:
    return f"{one.name.replace('_', ' ')} {told(one.reached, one.unit)} ({100 * one.share:.0f} % more range)"


def tell(console: Console, done: PlantProposed, picture: Path | None, campaign: Path | None, lines: list[str]) -> None:
    """Print the sentence, the table, and what to do next."""
    from hjcamp.commands.any_plant.words import table
    from hjcamp.commands.shared.wrapped import print_wrapped

    proposal = done.proposal
    if done.reused:
        console.print(f"diagnosis of the same logs taken from {done.reused}", style="dim", markup=False)
    if len(proposal.question.rivals) > 1:
        console.print(f"To distinguish: {names_of(proposal)}.", markup=False)
    console.print(title(done), style="bold" if proposal.chosen else "yellow", markup=False, highlight=False)
    if proposal.chosen:
        table(console, HEAD, rows(proposal))
        names = [one.name for one in proposal.question.rivals]
        for (a, b), value in list(proposal.together.items())[:8]:
            console.print(f"together   {names[a]} / {names[b]} {_sigma(value)} standard deviations", markup=False)
    print_wrapped(console, sentences(done), 8)
    for label, said in (("campaign", campaign or no_campaign(proposal) if proposal.chosen else None), ("picture", picture)):
        if said is not None:
            console.print(f"{label}   {said}", markup=False)
    for number, line in enumerate(lines):
        console.print(f"{'        ' if number else 'next    '}{line}", markup=False)


def drawn(done: PlantProposed) -> tuple[Any, Any, Any]:
    """Return what is drawn of the best tests: predictions of the rivals, bars of separations, labels."""
    from hjcamp.report.pictures.next import Bar, Labels
    from hjcamp.report.pictures.prediction import readable

    proposal, sensors = done.proposal, done.analysis.measured.sensors
    names = [one.name for one in proposal.question.rivals]
    tests = [_prediction(done, one) for one in proposal.tests[:COLUMNS]]
    order = _order(done, tests)
    shown = [
        one._replace(
            means={key: value[:, order] for key, value in one.means.items()},
            spreads={key: value[:, order] for key, value in one.spreads.items()},
        )
        for one in tests
    ]
    last = sensors[order[-1]]
    gaps = [value[:, -1] - one.means[names[0]][:, -1] for one in shown for value in one.means.values()]
    gaps += [2.0 * one.spreads[names[0]][:, -1] for one in shown]
    label, [_, scaled] = readable("difference", last.unit, np.zeros(1), np.concatenate(gaps) / last.scale)
    factor = float(np.max(np.abs(scaled)) / max(np.max(np.abs(np.concatenate(gaps))), 1e-300)) or 1.0
    labels = Labels(
        tuple(f"{sensors[k].quantity.replace('_', ' ')} ({sensors[k].unit})" for k in order),
        f"{label}\nfrom {{name}}",
        factor,
        "2 standard deviations of what the logs allow of the parameters",
    )
    bars = [
        Bar(f"{names[a]} / {names[b]}", value, [one.pairs[a, b] for one in proposal.tests[: proposal.chosen]])
        for (a, b), value in (proposal.together or proposal.tests[0].pairs).items()
    ]
    return shown, bars, labels


def _prediction(done: PlantProposed, one: Proposed) -> Any:
    from hjcamp.report.pictures.next import Prediction

    proposal, scales = done.proposal, np.array([each.scale for each in done.analysis.measured.sensors])
    means, spreads, time = {}, {}, np.zeros(0)
    for rival, drawn in list(zip(proposal.question.rivals, proposal.truths, strict=True))[:DRAWN]:
        layout = drawn[0].layout
        rows = np.repeat(layout.of_test, layout.width) == one.place
        values = np.stack([each.layout.readings[rows] * scales for each in drawn])
        time = layout.time[rows]
        # with some of the values that the logs allow a model may run away
        stays = [one for one in values[1:] if np.all(np.isfinite(one))]
        means[rival.name], spreads[rival.name] = values[0], np.std(stays or values[:1], axis=0)
    return Prediction("\n".join(wrap(one.wanted.text, TITLE)), time, means, spreads)


def _order(done: PlantProposed, tests: list[Any]) -> list[int]:
    """Return the sensors, the one in which the rivals differ most last."""
    sensors = done.analysis.measured.sensors
    noise = done.analysis.measured.noise * np.array([one.scale for one in sensors])
    most = np.zeros(len(sensors))
    for one in tests:
        first = next(iter(one.means.values()))
        for value in one.means.values():
            most = np.maximum(most, np.sqrt(np.mean((value - first) ** 2, axis=0)) / noise)
    return [int(k) for k in np.argsort(most)]
