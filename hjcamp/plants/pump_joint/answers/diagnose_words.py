"""The words and tables of a diagnosis, for the terminal and the page alike."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from hjcamp.plants.pump_joint.analyses.diagnosing import Diagnosed, looks_at_final
from hjcamp.plants.pump_joint.answers.error_words import over
from hjcamp.plants.pump_joint.answers.where_words import where_sentences
from hjcamp.plants.pump_joint.diagnosis.levels import CERTAIN, LEVEL, best_gains
from hjcamp.report.wording.chance import p_words
from hjcamp.report.wording.repeatability import worse_calibrated, worst_words
from hjcamp.report.wording.units import label, plain, told, told_estimate, told_interval, told_like

if TYPE_CHECKING:
    from hjcamp.plants.pump_joint.diagnosis.scale import Judged

TITLES = {
    "nothing_missing": "Nothing missing",
    "effect": "Effect",
    "one_of": "One of",
    "outside_library": "Outside library",
    "cannot_tell": "Cannot tell",
}
CALIBRATED = ("parameter", "published", "here", "95 %", "change")
CANDIDATES = ("effect", "posterior", "residual", "parameter", "value", "95 %")
LEFT = (
    "Residual: share on held-out tests (windows, lines, sliding force, initial encoder offset), relative to the "
    "calibrated model's; this ranks the effects."
)
MOVED = 0.01
APART = 0.95


@dataclass(frozen=True)
class Told(Diagnosed):
    """A diagnosis in words."""

    @property
    def title(self) -> str:
        """The verdict and what it names."""
        verdict, drivers = self.content["verdict"], self.content["drivers"]
        named = {
            "effect": " and ".join(self.content["effects"]),
            "one_of": ", ".join(self.content["effects"]),
            "outside_library": f"depends on {drivers[0].replace('_', ' ')}" if drivers else "",
        }.get(verdict)
        return f"{TITLES[verdict]}: {named}" if named else TITLES[verdict]

    def answer(self) -> list[str]:
        """Return the sentences of the answer, the first of them what the verdict means."""
        verdict, found = self.content["verdict"], self.found
        if verdict == "effect":
            named = [self.library[name].sentence() for name in self.content["effects"]]
            doubt = [whole_sentence(found.reason)] if found.undecided else []
            return [*named, *doubt, self.chance()]
        if verdict == "one_of":
            return [whole_sentence(found.reason), self.chance()]
        if verdict == "outside_library":
            left = "The residual depends on nothing that was measured."
            if self.unexplained is not None:
                final = self.content["error"]["augmented"]
                left = self.unexplained.sentence("best" if looks_at_final(found, final) else "calibrated")
            return [whole_sentence(found.reason), left]
        if verdict == "nothing_missing":
            return [f"These tests would have shown {cut(self.detectable(), 6)}.", self.chance()]
        return [whole_sentence(found.reason)]

    def chance(self) -> str:
        """Return the gain against those of simulations, and of rigs with other contacts, in which nothing is missing."""
        if not self.found.steps:
            return "No effect gained anything."
        step, p_value = self.found.steps[0], self.content["p_value"]
        replicates, rigs = len(step.null_gains), len(best_gains())
        number = round(step.p_value * (replicates + 1)) - 1
        said = f"Adding {step.best} raises the log-likelihood by {plain(step.gain)}"
        most = plain(float(max(step.null_gains)), 2) if replicates else "0"
        said += (
            f"; the most in {replicates} simulations with nothing missing is {most} ({p_words(step.p_value, replicates)}, "
            "the least that "
            f"{replicates} can show)."
            if number <= 0
            else f", and {number} of {replicates} simulations with nothing missing by as much ({p_words(step.p_value, replicates)})."
        )
        number = round(self.found.rig_chance * (rigs + 1)) - 1
        said += (
            f" {number or 'None'} of {rigs} simulated rigs with another contact gained as much for their effect "
            f"({p_words(self.found.rig_chance, rigs)})."
        )
        asked = self.content["verdict"] == "nothing_missing" and p_value < CERTAIN
        return said + (f" A name is given where no more than {rigs * LEVEL:.0f} of these rigs do." if asked else "")

    def detectable(self) -> list[str]:
        """Return the smallest amplitude of every effect that would have been seen."""
        return [
            f"{name} {told(row['value'], row['unit'], 2)}".rstrip() for name, row in self.content["minimum_detectable"].items()
        ]

    def where(self) -> list[str]:
        """Return where the error is before the effects, and where what is left is after them."""
        if odd := self.found.features.evidence.odd:
            return list(odd)
        error = self.content["error"] if self.judging.scale.repeated else {"baseline": None, "augmented": None}
        said = where_sentences(self.judging.places(self.found.baseline), error["baseline"])
        if self.found.final is not self.found.baseline:
            left = where_sentences(self.judging.places(self.found.final), error["augmented"])
            with_ = " and ".join(self.found.final.candidate.effects)
            said = [f"Calibrated: {line}" if number == 0 else line for number, line in enumerate(said[:3])]
            said += [f"With {with_}: {left[0]}", *left[1:3]]
        return said

    def worst(self) -> list[str]:
        """Return the conditions that err most on tests not used for the fit, by the model with the effects."""
        over = "the noise floor" if self.judging.scale.repeated else "the spread of what was measured"
        return worst_words(self.content["worst"], over)

    def errors(self) -> list[tuple[str, Judged]]:
        """Return the errors by name: as started, calibrated, with the effects."""
        rows = [] if self.start is None else [(self.model, self.start)]
        rows.append(("calibrated", self.judging.before))
        if self.found.final is not self.found.baseline:
            rows.append((f"with {' and '.join(self.found.final.candidate.effects)}", self.judging.after))
        return rows

    def further_off(self) -> list[str]:
        """Return in words where the model is the worse for being calibrated first, on tests not used for the fit."""
        if self.start is None:
            return []
        why = "what the other tests say of its parameters does not hold for these, or the fit looks at something else"
        return worse_calibrated(self.model, self.start.score, self.judging.before.score, why)

    def scores(self) -> list[tuple[str, float]]:
        """Return the errors in one number each, and the floor last where there is one."""
        rows = [(name, one.score) for name, one in self.errors() if math.isfinite(one.score)]
        return [*rows, ("noise floor", 1.0)] if self.judging.scale.repeated else rows

    def bars(self) -> tuple[list[tuple[str, float]], str, bool, int]:
        """Return what draws these errors: rows, what they are over, whether there is a floor, how many are before the calibrated."""
        scale, rows = self.judging.scale, self.scores()
        names = [name for name, _ in rows]
        return rows, over(scale), scale.repeated, names.index("calibrated") if "calibrated" in names else 0

    def calibration(self, every: bool = False) -> list[list[str]]:
        """Return the rows of the calibrated base parameters, those that moved or ``every`` one."""
        rows = []
        for name, row in self.content["calibration"].items():
            move = row["value"] - row["published"]
            if every or abs(move) > MOVED * (abs(row["published"]) or 1.0):
                change = f"{100 * move / abs(row['published']):+.0f} %" if row["published"] else ""
                before, here = told_like(row["published"], row), told_estimate(row)
                rows.append([label(name), before, here, told_interval(row), change])
        return rows

    def candidates(self, most: int | None = None) -> list[list[str]]:
        """Return the rows of the ranked effects, one for each parameter; an effect is named in its first."""
        rows = []
        for place, row in enumerate(self.content["candidates"]):
            if most is not None and place >= most and not row.get("asked"):
                continue
            ratio = row["heldout_error_ratio"]
            left = "" if ratio is None else f"{100 * ratio:.0f} %"
            posterior = "<0.01" if row["posterior"] < 0.005 else f"{row['posterior']:.2f}"
            first = [row["effect"], posterior, left]
            for name, one in row["parameters"].items():
                rows.append([*first, label(name), told_estimate(one), told_interval(one)])
                first = ["", "", ""]
        return rows

    def confounded(self, least: float = 0.0) -> tuple[list[str], list[tuple[str, float]]]:
        """Return effects that these tests cannot see, and pairs that look alike with their cosine."""
        hidden, pairs = list[str](), list[tuple[str, float]]()
        for row in self.found.confounded:
            names, cosine = row["effects"], float(str(row["cosine"]))
            assert isinstance(names, list)
            if len(names) == 1:
                hidden.append(str(names[0]))
            elif cosine >= least:
                pairs.append((" / ".join(str(name) for name in names), cosine))
        return hidden, pairs


def whole_sentence(text: str) -> str:
    """Return words as a sentence; names keep their capitals."""
    return f"{text[:1].upper()}{text[1:]}."


def parameters_told(rows: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the parameters of one effect in a line, in the units that people read."""
    return ", ".join(f"{label(name)} {told_estimate(row)}" for name, row in rows.items())


def cut(names: Sequence[str], most: int) -> str:
    """Return so many names, and how many more there are."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more
