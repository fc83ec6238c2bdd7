"""What a diagnosis of any plant says to people: its verdict, in a title and in sentences."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from hjcamp.analyses.untold import untold
from hjcamp.commands.any_plant.formula_words import formula_words
from hjcamp.commands.any_plant.law_words import described_term, local_driver, state_of, with_article
from hjcamp.commands.any_plant.plant_hints import plant_hints
from hjcamp.commands.any_plant.remarks.bound_words import ends_of_laws, held_by_bounds, late_inputs, other_sizes
from hjcamp.commands.any_plant.remarks.outside_words import (
    by_condition_words,
    constant_words,
    never_alone,
    no_memory_words,
    over_time_words,
    seldom,
    swing_words,
)
from hjcamp.commands.any_plant.remarks.remaining_words import least, most_remains, over_noise, remains, still_errs
from hjcamp.commands.any_plant.remarks.telling_words import telling_tests
from hjcamp.commands.any_plant.words import (
    bound_word,
    divergence_words,
    end_words,
    still_words,
)
from hjcamp.diagnosis.calibration.shares import left_of, share_of
from hjcamp.diagnosis.levels import MOST_OF_IT
from hjcamp.report.wording.repeatability import worst_words
from hjcamp.report.wording.units import plain, told_estimate, told_interval

if TYPE_CHECKING:
    from hjcamp.diagnosis.calibration.analysis import Analysis
    from hjcamp.diagnosis.decision.verdict import Verdict

SHOWN, PLACES = 6, 3
TITLES = {
    "nothing_missing": "NOTHING MISSING",
    "effect": "EFFECT",
    "one_of": "ONE OF",
    "outside_library": "OUTSIDE THE LIBRARY",
    "cannot_tell": "CANNOT TELL",
}
CANDIDATES = ("effect", "t", "residual", "parameter", "value", "95 %")


@dataclass(frozen=True)
class Words:
    """What a diagnosis says to people."""

    analysis: Analysis
    verdict: Verdict
    content: Mapping[str, Any]

    @property
    def title(self) -> str:
        """The verdict in one line."""
        if self.or_outside:
            return f"ONE OF THESE, OR OUTSIDE  {'; '.join(' with '.join(names) for names in self.verdict.confidence_set)}"
        names = ", ".join(self.verdict.effects)
        drivers = self.content["drivers"]
        place, _, local = drivers[0].rpartition("_") if drivers else ("", "", "")
        of_place = f" of {place.replace('_', ' ')}" if place and place != local else ""
        state = state_of(self.content["unknowns"][0]) if self.content["unknowns"] else ""
        differs = "parameters differ by condition" if self.content["by_condition"] else ""
        said = names or (f"depends on {state or local_driver(local) + of_place}" if drivers else differs)
        if self.verdict.word == "nothing_missing" and (far := self.far_off):
            return f"NOTHING IDENTIFIED  {still_errs(*far)}"
        return f"{TITLES[self.verdict.word]}{'  ' + said if said else ''}"

    @property
    def or_outside(self) -> bool:
        """Whether names are not ruled out in addition to something outside the library."""
        return self.verdict.outside and any(self.verdict.confidence_set)

    @property
    def evidence(self) -> str:
        """What the verdict rests on: the share of the error that is explained, p, and the blocks."""
        gate = self.verdict.gate
        return (
            f"On blocks left out the best model explains {100.0 * max(gate.gain, 0.0):.0f} % of the error above repeatability "
            f"(p = {plain(gate.p_value, 2)}, {gate.blocks:.1f} independent blocks; level {plain(self.verdict.alpha, 2)}, "
            f"smallest share that matters {100.0 * self.verdict.delta:.0f} %)"
        )

    @property
    def fitted_with(self) -> Mapping[str, Any]:
        """The base as it was fitted with what was found: names, or the law whose curve is drawn for it."""
        found: Mapping[str, Any] = self.content["calibration_with_effects"] or self.content["calibration_with_unknown"]
        return found

    @property
    def far_off(self) -> tuple[str, Mapping[str, Any]] | None:
        """The channel that errs most over its noise floor (its noise where none is known), where most of it is above that."""
        rows = self.content["floor"]
        worst = max(rows, key=lambda name: rows[name]["high"] / least(rows[name]))
        return (worst, rows[worst]) if rows[worst]["high"] * (1.0 - MOST_OF_IT) > least(rows[worst]) else None

    @property
    def shows_a_law(self) -> bool:
        """Whether a non-parametric term was fitted whose curve can be shown."""
        return bool(self.verdict.terms)

    @property
    def driver_words(self) -> str:
        """What drives the first non-parametric term, in words."""
        return str(self.content["unknowns"][0]["signal"]).replace("_", " ")

    def sentences(self) -> list[str]:
        """The answer in sentences."""
        return [
            *self._named(),
            *self._not_named(),
            *self._regression(),
            *self._nothing(),
            *self._other_shape(),
            *self._error(),
            *self._remarks(),
            *self.telling(),
        ]

    @property
    def _first_law(self) -> Mapping[str, Any] | None:
        """The first non-parametric term of the answer."""
        return self.content["unknowns"][0] if self.content["unknowns"] else None

    def _named(self) -> list[str]:
        """Say what was found, or what the tests lack."""
        verdict, found = self.verdict, list[str]()
        library = self.analysis.search.library
        if verdict.word == "cannot_tell":
            # what a bound holds may make all the rest: it is said first
            found += [*held_by_bounds(self.content["calibration"]), *(f"{one}." for one in verdict.lacking)]
        if verdict.word == "effect":
            found += [f"{name}: {library[name].sentence()}" for name in verdict.effects]
        sets = "; ".join(" with ".join(names) for names in verdict.confidence_set)
        if verdict.word == "one_of":
            found.append(f"These tests do not rule out: {sets}.")
        if self.or_outside:
            found.append(f"These tests do not rule out: {sets}; but something that the library does not have explains more.")
        return found

    def _not_named(self) -> list[str]:
        """Say what is found that has no name: a non-parametric term, an oscillation, other parameters in each condition, a constant."""
        verdict, error, first, found = self.verdict, self.content["error"], self._first_law, list[str]()
        if verdict.word == "outside_library" and first:
            found += formula_words(
                self.content["formulas"], described_term(first), self.driver_words, self.analysis.noise_floor.source
            )
            found.append(
                f"{with_article(described_term(first), begins=True)}, as a non-parametric term, "
                f"leaves {100.0 * left_of(first):.0f} % of {share_of(first, self.analysis.noise_floor.source)}"
                f"{'' if self.or_outside else ', less than any effect of the library'}. "
                "Its curve is on the page, and holds with the parameters in the column 'with what was found'."
            )
            found += over_time_words(first, self.analysis.measured.repeated)
        if self.content["swings"]:
            found.append(swing_words(self.content["swings"]))
        if self.content["by_condition"]:
            found += by_condition_words(self.content["by_condition"], error["augmented" if verdict.effects else "baseline"])
        found += constant_words(self.content["constants"], error["baseline"])
        return found

    def _regression(self) -> list[str]:
        """Say what a regression on motion and inputs predicts that no law explains, or that nothing explains the error."""
        verdict, found = self.verdict, list[str]()
        if verdict.follows:
            found.append(
                f"A regression on current motion and inputs predicts {100.0 * verdict.follows:.0f} % of the error above repeatability "
                "(held-out blocks), and no effect of the library and no law of one quantity as much: it may depend on several "
                "quantities, or on the past."
            )
            most = [one.replace("_", " ") for one in self.content["follows_motion"]["quantities"]]
            found += [f"Most predictive: {', '.join(most)}."] if most else []
        if verdict.word == "outside_library" and not verdict.term and not self.or_outside:
            found += self._seldom()
        return found

    def _nothing(self) -> list[str]:
        """Say that nothing is missing, and what that rests on."""
        if self.verdict.word != "nothing_missing":
            return []
        upper = 100.0 * min(max(self.verdict.gate.upper, 0.0), 1.0)
        return [
            f"No effect, no pair of effects and no non-parametric term explains {100.0 * self.verdict.delta:.0f} % of the error above "
            f"repeatability on held-out blocks; at most {upper:.0f} % could be explained."
        ]

    def _other_shape(self) -> list[str]:
        """Say what the named effects leave that could be explained."""
        verdict, first = self.verdict, self._first_law
        if verdict.word not in ("effect", "one_of") or verdict.law_left <= 0.05:
            return []
        left = f"{100.0 * min(verdict.law_left, 1.0):.0f} %"
        if first is None:
            return [f"The law leaves {left} of what the best model explains: the true law may have a different shape."]
        return [
            f"The law leaves {left} of what {with_article(described_term(first))}, as a non-parametric term, explains: the true law "
            "has a different shape, or something else is missing as well. Its curve is on the page.",
            *formula_words(self.content["formulas"], described_term(first), self.driver_words),
        ]

    def _error(self) -> list[str]:
        """Say how large the error is, before and after, and what the verdict rests on."""
        verdict, error, found = self.verdict, self.content["error"], list[str]()
        if verdict.effects or verdict.term:
            source = self.analysis.noise_floor.source
            found += most_remains(self.content, verdict, source) or over_noise(self.content, source)
        if not verdict.named and verdict.word == "cannot_tell":
            return found
        found.append(
            f"Normalised error on held-out blocks: {error['baseline']:.2f} calibrated"
            + (f" -> {error['augmented']:.2f} with what was found." if verdict.effects or verdict.term else ".")
        )
        if verdict.word == "nothing_missing" and (far := self.far_off):
            found.append(remains(*far, verdict.gate.p_value))
        return [*found, f"{self.evidence}."]

    def _remarks(self) -> list[str]:
        """Say what does not change the verdict: of bounds, memory, delays, ends of sensors, the plant's file."""
        verdict, library, found = self.verdict, self.analysis.search.library, list[str]()
        rows, period = self.content["calibration"], self.analysis.measured.period
        # beside a lag that is named the base is as late as that model has it
        late = self.content["calibration_with_effects"] or rows
        found += other_sizes(rows, self.content["candidates"][:SHOWN])
        found += ends_of_laws(verdict.effects, self.content["candidates"], library)
        if not verdict.effects:
            found += no_memory_words(self.content["candidates"], library, self.analysis.search.shortest_memory)
        held = [] if verdict.word == "cannot_tell" else held_by_bounds(rows)
        found += untold(self.analysis) + held + late_inputs(late, verdict.effects, period)
        found += end_words(self.content["ends"]) + divergence_words(self.content) + still_words(self.content["still"])
        left = not verdict.effects and bool(verdict.word != "nothing_missing" or self.far_off)
        found += never_alone(library) + plant_hints(self.analysis.windows, late, self.content["unknowns"][:1], left)
        return found

    def _seldom(self) -> list[str]:
        """Say which effect would take most of the error but cannot be shown to."""
        return seldom(self.content["candidates"], self.content["window_samples"] * self.analysis.measured.period)

    def telling(self) -> list[str]:
        """What kind of test would tell more, in words."""
        if self.verdict.word not in ("one_of", "outside_library"):
            return []
        said = telling_tests(self.verdict.effects, self.content["unknowns"], self.analysis.search.library)
        return [f"Tests that would decide: {'; '.join(said)}."] if said else []

    def where(self) -> list[str]:
        """Where the calibrated model errs most above repeatability: the channel and the range."""
        return [
            f"{100.0 * row['share']:.0f} % of the error above repeatability: "
            f"{row['variable']} of {row['subsystem'].replace('_', ' ')}, {row['bin']}"
            for row in self.content["where"][:PLACES]
        ]

    def worst(self) -> list[str]:
        """The conditions that err most with what was found."""
        return worst_words(
            self.content["worst"], "the noise floor" if self.analysis.noise_floor.source != "sensor" else "the noise"
        )

    def candidates(self) -> list[list[str]]:
        """Rows: effect, t, error left, parameter, value, 95 %."""
        rows: list[list[str]] = []
        for one in (row for k, row in enumerate(self.content["candidates"]) if k < SHOWN or row.get("asked")):
            sign = "+ " if one.get("beside") else ""
            first = [f"{sign}{one['effect']}", f"{one['t']:.1f}", f"{100 * left_of(one):.0f} %"]
            for name, row in one["parameters"].items():
                rows.append([*first, name.replace("_", " "), told_estimate(row), told_interval(row) + bound_word(row)])
                first = ["", "", ""]
        return rows

    @property
    def added_note(self) -> list[str]:
        """What the sign before an effect says, where one of those shown has it."""
        others = dict.fromkeys(name for one in self.content["candidates"][:SHOWN] for name in one.get("beside", ()))
        return [f"+: added after {' and '.join(others)}; compared with the model that includes it."] if others else []
