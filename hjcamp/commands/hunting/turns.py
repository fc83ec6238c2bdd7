"""The turns of a hunt: make tests, look whether the rig has changed, diagnose, choose the next tests, until one verdict stands."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from hjcamp.analyses.data import Data
from hjcamp.campaign.files.json_files import write_json
from hjcamp.campaign.one_run import make_run
from hjcamp.commands.hunting import budget
from hjcamp.commands.hunting.chosen import Choose, Chosen, condition_name, plan_of
from hjcamp.commands.hunting.drift import drift_of
from hjcamp.commands.hunting.page import write_page
from hjcamp.commands.hunting.record import ENDED, INTERRUPTED, RUNNING, STOPPED, Hunt, Round, save
from hjcamp.commands.hunting.said import said_verdict
from hjcamp.commands.shared.session import progress_of
from hjcamp.errors import HjcampError, Interrupted, RigStopped, UsageError, counted
from hjcamp.records.plan import Condition, Plan, read_plan
from hjcamp.report.wording.repeatability import NEAR

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.analyses.diagnosing import Asked

#: Verdicts that leave no rivals, where their level is reached; that nothing is missing stands once no test could show more.
SETTLED = ("effect", "outside_library")


@dataclass(frozen=True)
class Options:
    """What was asked: how to diagnose, when a verdict stands, tests of a round.

    ``level`` is the p-value at which a verdict stands, ``within`` the largest error over the noise floor that a name may leave.
    """

    asked: Asked
    level: float = 0.05
    within: float = NEAR
    tests: int = 3
    #: Returns whether the tests of a round may be made; None where nobody is asked.
    ask: Callable[[str], bool] | None = None

    def told(self) -> dict[str, Any]:
        """Return what decides a hunt's course, as its folder keeps it."""
        asked = {key: getattr(self.asked, key) for key in ("model", "effort", "seed", "only", "without")}
        return {**asked, "level": self.level, "within": self.within, "tests": self.tests}


class Hunter:
    """One hunt in its folder: a plan (``first``), the composed configuration of the call with its overrides, and what was asked."""

    def __init__(
        self, folder: Path, hunt: Hunt, first: Plan, call: tuple[dict[str, Any], list[str]], options: Options, console: Console
    ) -> None:
        self.folder, self.hunt, self.first, self.options, self.console = folder, hunt, first, options, console
        self._call = call
        self._room: ModuleType | None = None

    def go(self) -> None:
        """Turn until the hunt ends; whatever stops it, its folder says how it stands. Raises what `make_run` raises."""
        hunt = self.hunt
        try:
            hunt.state = RUNNING
            while hunt.state == RUNNING:
                self._turn(hunt.rounds[-1])
        except (KeyboardInterrupt, Interrupted):
            hunt.state, hunt.message = INTERRUPTED, "interrupted"
            raise Interrupted(f"the hunt was interrupted; {self._goes_on()}") from None
        except RigStopped as problem:
            hunt.state, hunt.message = STOPPED, str(problem)
            raise RigStopped(f"{problem}\n{self._goes_on()}") from problem
        except HjcampError as problem:
            hunt.state, hunt.message = STOPPED, str(problem)
            raise
        finally:
            self._keep()

    def _goes_on(self) -> str:
        return f"the same call with run_dir={self.folder} goes on"

    def _keep(self) -> None:
        save(self.folder, self.hunt)
        write_page(self.folder, self.hunt)

    def _turn(self, one: Round) -> None:
        number = len(self.hunt.rounds) - 1
        if not one.made:
            self._make(one, number)
        chosen = self._judge(one, number)
        if self._stands(one.diagnosis or {}):
            self._end("verdict", self._verdict_words(one))
        elif not chosen.configs:
            verdict = one.diagnosis is not None and one.diagnosis["verdict"] == "nothing_missing"
            self._end("verdict" if verdict else "no_test", self._verdict_words(one) if verdict else chosen.why)
        else:
            self._go_on(chosen, number + 1)

    def _make(self, one: Round, number: int) -> None:
        """Make the tests of a round that are left, and look whether the rig has changed."""
        plan = read_plan(self._plan_file(number))
        texts = ", ".join(row["text"] for row in one.tests)
        self.console.print(f"round {number}   {counted(len(plan.tests), 'test')}: {texts}", markup=False, highlight=False)
        config, lines = self._call
        make_run(plan, config, lines, self.console, self.folder / one.run)
        one.made, one.seconds = True, budget.made_seconds(self.folder / one.run)
        one.drift = self._drift(one) if number else []
        if one.drift:
            one.since = number
            fields = ", ".join(row["field"] for row in one.drift)
            self.console.print(
                f"  drift   the rig has changed ({fields}): its base parameters are estimated again, from this round on",
                style="yellow", markup=False,
            )  # fmt: skip
        self._keep()

    def _judge(self, one: Round, number: int) -> Chosen:
        """Diagnose the tests that count, and choose the next ones."""
        data = Data([self.folder / each.run for each in self.hunt.rounds[one.since : number + 1]])
        room = data.plant.room_of("hunt") or importlib.import_module("hjcamp.commands.hunting.any_plant")
        with progress_of(self.console) as report:
            content, choose = room.judged(data, self.options.asked, lambda text, share: report(text, 0.6 * share))
            one.diagnosis = concluded(content)
            chosen = Chosen({}) if self._stands(one.diagnosis) else self._chosen(choose, number, report)
        one.diagnosis["hidden"] = list(chosen.hidden)
        for name, answer in (("diagnosis", content), ("next", chosen.answer)):
            if answer:
                write_json(self.folder / f"{name}_{number:02d}.json", answer)
        error = one.diagnosis["error"]
        said = " -> ".join("-" if error[key] is None else f"{error[key]:.3g}" for key in ("baseline", "augmented"))
        self.console.print(
            f"round {number}   {self._verdict_words(one)}   error {said} x the noise floor   "
            f"{self.hunt.spent_s / 60.0:.3g} of {self.hunt.budget_s / 60.0:.3g} min",
            style="bold", markup=False, highlight=False,
        )  # fmt: skip
        return chosen

    def _chosen(self, choose: Choose, number: int, report: Any) -> Chosen:
        configs = [one.config for one in self.first.conditions]
        return choose(configs, self.options.tests, number + 1, lambda text, share: report(text, 0.6 + 0.4 * share))

    def _stands(self, found: dict[str, Any]) -> bool:
        """Whether a verdict leaves nothing to test: something outside the library, or names that leave no more than the noise floor."""
        if found.get("verdict") not in SETTLED or (found.get("p_value") or 0.0) > self.options.level:
            return False
        if found["verdict"] == "outside_library" and any(found["not_ruled_out"]):
            return False  # one of these names, or something outside: rivals remain
        left = found["error"]["augmented"]
        return found["verdict"] != "effect" or left is None or left <= self.options.within

    def _verdict_words(self, one: Round) -> str:
        return said_verdict(one.diagnosis or {})

    def _go_on(self, chosen: Chosen, number: int) -> None:
        """Plan the next round with what the budget leaves, ask where somebody is to be asked, and note it."""
        again = self._again()
        found = self._affordable(chosen, again, number)
        if found is None:
            self._end("budget", f"the budget leaves no time for {next(iter(chosen.texts.values()))}")
            return
        plan, planned = found
        if self.options.ask is not None and not self.options.ask("; ".join(row["text"] for row in planned.tests)):
            raise Interrupted("not confirmed")
        planned.since = self.hunt.rounds[-1].since
        planned.expected = chosen.answer.get("together", [])
        write_json(self._plan_file(number), plan.as_json())
        self.hunt.rounds.append(planned)
        self._keep()

    def _affordable(self, chosen: Chosen, again: Condition | None, number: int) -> tuple[Plan, Round] | None:
        """Return the tests, best first, and as many repetitions of them as the budget has room for; None for none."""
        left = self.hunt.budget_s - self.hunt.spent_s
        name = f"{self.first.campaign}_{number}"
        for repetitions in range(chosen.repetitions, 0, -1):
            for count in range(len(chosen.configs), 0, -1):
                configs = dict(list(chosen.configs.items())[:count])
                texts = dict(chosen.texts)
                if again is not None:
                    label = condition_name(f"again_{again.name}", number, configs)
                    configs = {label: again.config, **configs}
                    texts[label] = f"{again.name} once more"
                plan = plan_of(name, "Chosen by hjcamp hunt", configs, repetitions, self.first.seed)
                planned = round_of(plan, f"{number:02d}_tests", texts, self._overhead())
                if planned.seconds <= left:
                    return plan, planned
        return None

    def _again(self) -> Condition | None:
        """Return the test of the campaign that is made again in each round, to see a rig change; None where nothing can."""
        if self.first.conditions[0].config["backend"]["name"] == "simulation" or self.first.repetitions < 2:
            return None
        return min(self.first.conditions, key=lambda one: one.duration)

    def _overhead(self) -> float:
        """Return by how much a test of the campaign took longer than planned, s."""
        made = self.hunt.rounds[0]
        planned = round_of(self.first, "", {}, 0.0).seconds
        return max(made.seconds - planned, 0.0) / len(self.first.tests) if made.made else 0.0

    def _drift(self, one: Round) -> list[dict[str, Any]]:
        """Return in which fields the campaign's test, made again, differs from what it was (`drift_of`)."""
        from hjcamp.records.find import group_by_condition, read_logs

        again = self._again()
        if again is None:
            return []
        first = group_by_condition(read_logs([self.folder / self.hunt.rounds[0].run]))[again.name]
        since = self.hunt.rounds[-1].since
        before = first if since == 0 else self._made_again(self.hunt.rounds[since], again.name)
        found: list[dict[str, Any]] = []
        for log in self._made_again(one, again.name)[:1]:
            found = drift_of(first, before, log)
        return found

    def _made_again(self, one: Round, name: str) -> list[Any]:
        from hjcamp.records.find import read_logs

        logs = read_logs([self.folder / one.run])
        return [log for log in logs if log.metadata.get("condition", "").partition("_again_")[2] == name]

    def _plan_file(self, number: int) -> Path:
        return self.folder / f"plan_{number:02d}.json"

    def _end(self, reason: str, message: str) -> None:
        self.hunt.state, self.hunt.reason, self.hunt.message = ENDED, reason, message


def round_of(plan: Plan, run: str, texts: dict[str, str], overhead: float) -> Round:
    """Return a round that is planned; each test takes ``overhead`` s more than its motion and rests."""
    tests = [
        {
            "name": one.name,
            "text": texts.get(one.name, one.name),
            "seconds": budget.planned_seconds(one.config, one.duration) + overhead,
        }
        for one in plan.conditions
    ]
    return Round(run, tests, plan.repetitions, plan.repetitions * sum(float(str(one["seconds"])) for one in tests))


def concluded(content: dict[str, Any]) -> dict[str, Any]:
    """Return what a round keeps of a diagnosis: its public answer in short."""
    error = content.get("error") or {}
    sets: Sequence[Sequence[str]] = content.get("confidence_set") or []
    if not sets and content["verdict"] == "one_of":
        sets = [[name] for name in content["effects"]]
    return {
        "verdict": content["verdict"],
        "effects": list(content["effects"]),
        "p_value": content.get("p_value"),
        "error": {key: error.get(key) for key in ("baseline", "augmented")},
        "not_ruled_out": [list(one) for one in sets],
        "base": {name: {"value": row["value"], "unit": row["unit"]} for name, row in content["calibration"].items()},
        "hidden": [],
    }


def first_round(folder: Path, plan: Plan, budget_s: float) -> Round:
    """Return the round of the campaign itself, its plan kept; raises ``UsageError`` for a budget that is shorter."""
    found = round_of(plan, "00_campaign", {}, 0.0)
    if found.seconds > budget_s:
        raise UsageError(
            f"--budget: {budget_s / 60.0:.3g} min are shorter than the campaign, which takes {found.seconds / 60.0:.3g} min; "
            "give more, or a campaign with fewer tests"
        )
    folder.mkdir(parents=True, exist_ok=True)
    write_json(folder / "plan_00.json", plan.as_json())
    return found
