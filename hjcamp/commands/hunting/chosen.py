"""The tests of a further round: what `hjcamp next` chooses, as configurations, and the plan of their run."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from hjcamp.analyses.data import Report
from hjcamp.campaign.plan.planning import trajectory_of
from hjcamp.configuration.check import check_configuration
from hjcamp.records.plan import Condition, Plan, config_sha256, plan_sha256, planned_tests

#: Before the name of a condition: the round that it was made in, so that no two rounds hold tests of one name.
ROUND = re.compile(r"^t\d+_")


@dataclass(frozen=True)
class Chosen:
    """The tests that are worth making, best first: name -> configuration; none where ``why`` says so.

    ``answer`` is that of `hjcamp next`; ``hidden`` are effects that the tests so far would not show at their usual size.
    """

    answer: dict[str, Any]
    configs: dict[str, dict[str, Any]] = field(default_factory=dict)
    texts: dict[str, str] = field(default_factory=dict)
    repetitions: int = 1
    hidden: tuple[str, ...] = ()
    why: str = ""


#: Chooses tests after a diagnosis: from the configurations of the campaign, how many, the number of the round.
Choose = Callable[[Sequence[Mapping[str, Any]], int, int, Report], Chosen]


def condition_name(text: str, number: int, taken: Collection[str]) -> str:
    """Return the name of a condition of round ``number``, safe as the name of a folder and not ``taken``."""
    plain = re.sub(r"[^A-Za-z0-9._-]+", "-", ROUND.sub("", text)).strip("-.") or "test"
    name, count = f"t{number}_{plain}", 1
    while name in taken:
        count += 1
        name = f"t{number}_{plain}-{count}"
    return name


def plan_of(name: str, text: str, configs: Mapping[str, Mapping[str, Any]], repetitions: int, seed: int) -> Plan:
    """Return the plan of a run of these conditions; raises ``UsageError`` for one that cannot be run."""
    conditions = []
    for label, given in configs.items():
        config = {**given, "repetitions": repetitions, "seed": seed}
        check_configuration(config, f"condition '{label}'")
        choices = {group: str(part["name"]) for group, part in config.items() if isinstance(part, dict) and part.get("name")}
        conditions.append(Condition(label, choices, config, trajectory_of(config).duration, config_sha256(config)))
    return Plan(
        name, text, (), repetitions, seed, {}, {"test": list(configs)}, tuple(conditions),
        planned_tests(list(configs), repetitions, seed), plan_sha256(name, (), repetitions, seed, conditions),
    )  # fmt: skip
