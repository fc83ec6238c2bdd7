"""What a tour is: its steps, their answers, and the last sentence of each, computed from its answer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hjcamp.errors import HjcampError, UsageError
from hjcamp.json_text import read_json

NEEDED = ("verdict", "effects", "candidates"), ("model", "file")


@dataclass(frozen=True)
class Step:
    """One step: its title, what to look at, the words of its command after ``hjcamp``, the folder of its page.

    ``writes`` are files in the tour's folder that its command would not replace: they go before the step is done again.
    """

    title: str
    look: str
    words: Callable[[Tour], list[str]]
    page: str = ""
    writes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Kind:
    """One of the tours: its usual folder, its steps, those that diagnose and add, its sealed answer, and how its logs are laid out.

    ``fall`` gives the errors of the models one after the other on what was ``held_out``; ``after`` are commands for then.
    """

    folder: Path
    steps: tuple[Step, ...]
    diagnosing: int
    adding: int
    lay_out: Callable[[Path], int]
    sealed: Path
    introduction: str
    fall: Callable[[Tour], list[tuple[str, float]]]
    held_out: str
    after: Sequence[str]
    option: tuple[str, ...] = ()
    written: tuple[str, ...] = ()


@dataclass(frozen=True)
class Tour:
    """A tour in ``folder``: its answers for programs are what has been done so far."""

    folder: Path
    kind: Kind
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
        needed = dict(zip((self.kind.diagnosing, self.kind.adding), NEEDED, strict=True))
        for key in needed.get(number, ()):
            if key not in content:
                raise self.again(number)
        return content

    def again(self, number: int) -> HjcampError:
        """Return the refusal of an answer that was damaged."""
        return HjcampError(
            f"{self.answer_file(number)}: cannot be read as an answer of step {number}; do it again: --step {number}"
        )

    def next_step(self) -> int:
        """Return the first step that has not been done; the last one leaves no answer."""
        last = len(self.kind.steps)
        return next((number for number in range(1, last) if not self.answer_file(number).is_file()), last)

    def open_words(self) -> list[str]:
        """Return the words of the command that opens the sealed answer."""
        place = [] if self.folder == self.kind.folder else ["--into", str(self.folder)]
        return ["tour", *self.kind.option, "--open", *place]


def effects_to_add(diagnosis: dict[str, Any]) -> list[str]:
    """Return the effects that a diagnosis names, else the candidate that it ranks first."""
    named = diagnosis.get("effects") or []
    ranked = [row["effect"] for row in diagnosis.get("candidates") or []]
    if diagnosis.get("verdict") == "effect" and named:
        return list(named)
    if not ranked:
        raise HjcampError(
            "the diagnosis names no effect, so there is nothing to add; try the step again with --effort standard"
        )
    return ranked[:1]


def last_sentence(answer: dict[str, Any]) -> str:
    """Return what the answer of a step comes to, in numbers; empty where it holds none."""
    error = answer.get("error") or {}
    if answer.get("logs"):
        seconds = sum(row["duration_s"] for row in answer["logs"])
        return f"{len(answer['logs'])} logs, {seconds:.0f} s of motion, in SI units from here on."
    if "verdict" in answer and error.get("baseline") and error.get("augmented"):
        found = " and ".join(answer["effects"]) or "what was found"
        return (
            f"The model with its constants estimated here errs by {error['baseline']:.2f} times the noise floor on tests that it was "
            f"not fitted to; with {found} by {error['augmented']:.2f} times."
        )
    if "helps" in answer and error.get("before") and error.get("after"):
        said = "helps" if answer["helps"] else "does not help"
        return (
            f"{' and '.join(answer['effects'])} {said}: {error['before']:.2f} times the noise floor without it, {error['after']:.2f} "
            "times with it, on what was not used for the fit."
        )
    models = [*(answer.get("models") or []), *([answer["calibrated"]] if answer.get("calibrated") else [])]
    scores = [f"{one['name']} {one['score']:.2f}" for one in models if one.get("score")]
    return f"Errors in multiples of the noise floor: {', '.join(scores)}." if scores else ""
