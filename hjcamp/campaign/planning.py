"""Make the plan of a run from the call: compose and check every condition, derive every seed."""

from __future__ import annotations

import fnmatch
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from hjcamp.campaign.campaign_file import RUN_KEYS, Campaign, label_of, read_campaign
from hjcamp.campaign.conditions import Draft, draft_conditions
from hjcamp.campaign.values import check_count, check_values
from hjcamp.errors import UsageError, nearest, unknown
from hjcamp.records.plan import Condition, Plan, config_sha256, plan_sha256, planned_tests

if TYPE_CHECKING:
    from hjcamp.configuration.composer import Composer, Composition

SINGLE = "single"
# What a plan adds to the configuration that was composed.
ADDED = ("controller_model", "repetitions", "seed")


def make_plan(asked: Mapping[str, Any], choice: str | None, lines: Sequence[str], composer: Composer) -> Plan:
    """Return the plan of a run.

    ``asked`` is the composed configuration of the call, ``choice`` the campaign's name in it (None: the one condition
    that ``asked`` describes), ``lines`` the user's overrides. Raises ``UsageError`` for anything that cannot be run.
    """
    repetitions = check_count(asked.get("repetitions"), "repetitions")
    seed = check_count(asked.get("seed"), "seed", lowest=0)
    if choice is None:
        name = "__".join(label_of("", str(asked[group].get("name"))) for group in ("trajectory", "controller"))
        campaign, drafts = Campaign(SINGLE, "one condition, no campaign", {}, ()), [Draft(name, tuple(lines))]
    else:
        campaign = read_campaign(asked["campaign"], choice)
        campaign, drafts = draft_conditions(campaign, lines, composer)
    drafts = _selected(drafts, asked.get("conditions"))
    conditions = tuple(
        _condition(draft, composer.compose(draft.overrides), repetitions, seed, composer) for draft in drafts
    )
    _refuse_equal(conditions)
    tables = _tables(asked.get("tables"), composer)
    return Plan(
        campaign.name,
        campaign.description,
        tables,
        repetitions,
        seed,
        campaign.fixed,
        {axis.name: list(axis.cases) for axis in campaign.axes},
        conditions,
        planned_tests([one.name for one in conditions], repetitions, seed),
        plan_sha256(campaign.name, tables, repetitions, seed, conditions),
    )


def check_call(lines: Sequence[str], composer: Composer) -> None:
    """Raise ``UsageError`` for a call that cannot be run, judging by its first condition: cheap enough for a sweep."""
    asked = composer.compose(lines)
    check_count(asked.config.get("repetitions"), "repetitions")
    check_count(asked.config.get("seed"), "seed", lowest=0)
    _tables(asked.config.get("tables"), composer)
    first = asked
    if choice := asked.choices.get("campaign"):
        campaign = read_campaign(asked.config["campaign"], choice)
        drafts = _selected(draft_conditions(campaign, lines, composer)[1], asked.config.get("conditions"))
        first = composer.compose(drafts[0].overrides)
    check_values(first.config, f"'{' '.join(lines)}'")


def check_plan(plan: Plan, where: str) -> None:
    """Raise ``UsageError`` where a plan that was read holds a configuration that could not be planned here and now."""
    for condition in plan.conditions:
        place = f"{where}, condition '{condition.name}'"
        try:
            check_values({key: value for key, value in condition.config.items() if key not in ADDED}, place)
            _check_test(condition.config)
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
            # Hashes that are right do not make a configuration one of ours.
            reason = f"{type(error).__name__}: {error}"
            raise UsageError(f"{place}: no test can be made with this configuration ({reason})") from error


def _condition(draft: Draft, composition: Composition, repetitions: int, seed: int, composer: Composer) -> Condition:
    config = {key: value for key, value in composition.config.items() if key not in RUN_KEYS}
    choices = {group: choice for group, choice in composition.choices.items() if choice and group != "campaign"}
    for group, choice in choices.items():
        if isinstance(config.get(group), dict):
            config[group].setdefault("name", choice)
    check_values(config, f"condition '{draft.name}'")
    config["controller_model"] = composer.model(str(config["controller"].get("model")))
    duration = _check_test(config)
    config |= {"repetitions": repetitions, "seed": seed}
    return Condition(draft.name, choices, config, duration, config_sha256(config))


def _check_test(config: Mapping[str, Any]) -> float:
    """Return how long the motion of a test takes, s; raises ``UsageError`` where its backend cannot make it."""
    from hjcamp import backends
    from hjcamp.trajectories import build_trajectory

    duration = float(build_trajectory(config["trajectory"]).duration)
    check_test = getattr(backends, "check_test", None)
    if check_test is not None:
        check_test(config)
    return duration


def _selected(drafts: list[Draft], patterns: Any) -> list[Draft]:
    if patterns is None:
        return drafts
    names = [draft.name for draft in drafts]
    kept: set[str] = set()
    for pattern in patterns if isinstance(patterns, list | tuple) else [patterns]:
        found = fnmatch.filter(names, str(pattern))
        if not found:
            match = nearest(str(pattern), names)
            hint = f"; did you mean '{match}'?" if match else "."
            raise UsageError(f"conditions: nothing matches '{pattern}'{hint} Allowed: {', '.join(names)}")
        kept.update(found)
    return [draft for draft in drafts if draft.name in kept]


def _refuse_equal(conditions: Sequence[Condition]) -> None:
    seen: dict[str, str] = {}
    for condition in conditions:
        if condition.sha256 in seen:
            raise UsageError(
                f"the campaign varies the same thing twice: the conditions '{seen[condition.sha256]}' and "
                f"'{condition.name}' have the same configuration"
            )
        seen[condition.sha256] = condition.name


def _tables(asked: Any, composer: Composer) -> tuple[str, ...]:
    tables = [asked] if isinstance(asked, str) else list(asked or [])
    allowed = composer.options("table") if composer.is_group("table") else None
    for table in tables:
        if allowed is not None and table not in allowed:
            raise unknown("table", str(table), allowed, "tables")
    if len(set(tables)) < len(tables):
        raise UsageError(f"tables names one table twice: {', '.join(map(str, tables))}")
    return tuple(map(str, tables))
