"""The steps of the tour: what to look at, the command, where its answer and its pictures are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hjcamp.errors import HjcampError, UsageError
from hjcamp.json_text import read_json

MODEL = "tour_model"
BOTH = "compare_both"
NEEDED = {2: ("verdict", "effects", "candidates"), 3: ("model", "file")}


@dataclass(frozen=True)
class Tour:
    """A tour in ``folder``: its answers for programs are what has been done so far."""

    folder: Path
    effort: str = "quick"

    def answer_file(self, number: int) -> Path:
        """Return where the answer of a step is kept."""
        return self.folder / f"step_{number}.json"

    def answer(self, number: int) -> dict[str, Any]:
        """Return the answer of a step; raises UsageError where that step has not been done."""
        path = self.answer_file(number)
        if not path.is_file():
            raise UsageError(f"{path} is not there: first do step {number} of the tour, --step {number}")
        try:
            content = read_json(path)
            if not isinstance(content, dict):
                raise ValueError("no object")
        except ValueError as error:
            raise self.again(number) from error
        for key in NEEDED.get(number, ()):
            if key not in content:
                raise self.again(number)
        return content

    def again(self, number: int) -> HjcampError:
        """Return the refusal of an answer that was damaged."""
        return HjcampError(
            f"{self.answer_file(number)}: cannot be read as an answer of step {number}; do it again: --step {number}"
        )

    def next_step(self) -> int:
        """Return the first step that has not been done."""
        return next(number for number in range(1, len(STEPS) + 1) if not self.answer_file(number).is_file())


@dataclass(frozen=True)
class Step:
    """One step: its title, what to look at, the words of its command after ``hjcamp``, the folder of its page."""

    title: str
    look: str
    words: Callable[[Tour], list[str]]
    page: str = ""


def _compare(tour: Tour) -> list[str]:
    return ["compare", str(tour.folder), "--model", "published", "--json", str(tour.answer_file(1))]


def _diagnose(tour: Tour) -> list[str]:
    return ["diagnose", str(tour.folder), "--effort", tour.effort, "--json", str(tour.answer_file(2))]


def _add(tour: Tour) -> list[str]:
    from hjcamp.analyses.data import free_model_name

    effects = effects_to_add(tour.answer(2))
    return ["add", *effects, str(tour.folder), "--as", free_model_name(MODEL), "--json", str(tour.answer_file(3))]


def _compare_both(tour: Tour) -> list[str]:
    name = str(tour.answer(3).get("model"))
    models = ["--model", "published", "--model", name]
    # A folder of its own: the page of step 1 stays beside it.
    return ["compare", str(tour.folder), *models, "--into", str(tour.folder / BOTH), "--json", str(tour.answer_file(4))]


def _open(tour: Tour) -> list[str]:
    return ["tour", "--open", *([] if tour.folder == Path("tour") else ["--into", str(tour.folder)])]


def effects_to_add(diagnosis: dict[str, Any]) -> list[str]:
    """Return the effects that a diagnosis names, else the candidate that it ranks first."""
    named = diagnosis.get("effects") or []
    ranked = [row["effect"] for row in diagnosis.get("candidates") or []]
    if diagnosis.get("verdict") == "effect" and named:
        return list(named)
    if not ranked:
        raise HjcampError("the diagnosis names no effect, so there is nothing to add; try --step 2 --effort standard")
    return ranked[:1]


STEPS = (
    Step(
        "How far is the model off, and where?",
        "The published model is driven with the measured motion of the pump and has to say what the arm and the two "
        "lines do. 'error' is by how much it is wrong. 'floor' is by how much repetitions of one test differ from "
        "each other: no model can do better. Look at 'error / floor' (1 would be perfect) and at the sentences after "
        "'where'. Open the page: in the overlay model and measurement part within a second. Some of that is only "
        "another specimen's friction: the map shows a missing force that changes its sign with the direction.",
        _compare,
        "compare",
    ),
    Step(
        "What is missing?",
        "This joint is not the published one, so friction, stiffness and mass are calibrated first: they are not "
        "called missing. Then every effect of the library is tried. Twins, simulated tests in which nothing is "
        "missing, tell how much of an improvement is mere chance (p). Look at the line in capitals, at 'posterior' (how "
        "sure it is of this effect and no other), and at the errors: they are of tests that the fit has not seen. "
        "'Where' on the page tells which part of the rig is to blame once friction is right.",
        _diagnose,
        "diagnose",
    ),
    Step(
        "Add it to the model",
        "The effect is fitted together with the base parameters on all repetitions but the last of each condition; "
        "the table and the bars are the error on those last ones, on the scale of step 1. The new model is a file that "
        "you can read and change; it says where it comes from: the command, the intervals, the hashes of the logs.",
        _add,
    ),
    Step(
        "Compare again, both models",
        "The same tests, two models. Look at the bars, then at the page: in the overlay the new model lies on the "
        "measurement, and in the last picture its error is born no larger than the floor. The row of the pump is as "
        "before: how it follows its command is a part of the model that nothing was added to.",
        _compare_both,
        BOTH,
    ),
    Step(
        "Open the sealed answer",
        "What really hides in the rig, beside what step 2 found. The rig is another program with other equations, so "
        "the numbers need not agree to the last digit; 95 % is what the diagnosis thinks of its own.",
        _open,
    ),
)
