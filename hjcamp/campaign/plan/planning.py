"""Make the plan of a run from the call: compose and check every condition, derive every seed."""

from __future__ import annotations

import fnmatch
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from hjcamp.backends.plant_simulation import followed_unit, plant_in, prepare
from hjcamp.campaign.plan.campaign_file import RUN_KEYS, Campaign, label_of, read_campaign
from hjcamp.campaign.plan.conditions import Draft, draft_conditions
from hjcamp.campaign.plan.objective import read_objectives
from hjcamp.configuration.check import check_configuration
from hjcamp.configuration.composer import free
from hjcamp.configuration.run_keys import RunKeys, read_run_keys
from hjcamp.controllers import find_controller
from hjcamp.errors import UsageError, counted, nearest, shown, unknown
from hjcamp.records.plan import Condition, Plan, config_sha256, folder_name, lasting_name, plan_sha256, planned_tests
from hjcamp.schema import naming
from hjcamp.trajectories import Trajectory, build_trajectory

if TYPE_CHECKING:
    from hjcamp.configuration.composer import Composer, Composition

SINGLE = "single"


def make_plan(asked: Mapping[str, Any], choice: str | None, lines: Sequence[str], composer: Composer) -> Plan:
    """Return the plan of a run.

    ``asked`` is the composed configuration of the call, ``choice`` the campaign's name in it (None: the one condition
    that ``asked`` describes), ``lines`` the user's overrides. Raises ``UsageError`` for anything that cannot be run.
    """
    composer.refuse_bundles(lines)
    run = read_run_keys(asked)
    repetitions, seed = run.repetitions, run.seed
    if choice is None and asked.get("campaign"):
        raise UsageError(f"campaign is {shown(asked['campaign'])}, but none is chosen; choose with campaign=NAME")
    if choice is None:
        name = "__".join(label_of("", str(asked[group].get("name"))) for group in ("trajectory", "controller"))
        campaign, drafts = Campaign(SINGLE, "one condition, no campaign", {}, ()), [Draft(name, tuple(lines))]
    else:
        campaign = read_campaign(asked["campaign"], choice)
        campaign, drafts = draft_conditions(campaign, lines, composer, run.most_tests)
    drafts = _selected(drafts, run.conditions)
    _refuse_too_many(drafts, run, composer)
    conditions = tuple(_condition(draft, composer.compose(draft.overrides), repetitions, seed, composer) for draft in drafts)
    _refuse_equal(conditions)
    tables = _tables(run.tables, composer)
    read_objectives(run.objective)
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


def composed_plan(overrides: Sequence[str], composer: Composer) -> tuple[Plan, dict[str, Any]]:
    """Return the plan of ``hjcamp run`` with these overrides, and the composed configuration of the call."""
    lines = [free(line) for line in overrides]
    asked = composer.compose(lines)
    return make_plan(asked.config, asked.choices.get("campaign"), lines, composer), asked.config


def check_call(lines: Sequence[str], composer: Composer) -> None:
    """Raise ``UsageError`` for a call that cannot be run, judging by its first condition: cheap enough for a sweep."""
    asked = composer.compose(lines)
    run = read_run_keys(asked.config)
    _tables(run.tables, composer)
    read_objectives(run.objective)
    first = asked
    if choice := asked.choices.get("campaign"):
        campaign = read_campaign(asked.config["campaign"], choice)
        drafts = _selected(draft_conditions(campaign, lines, composer, run.most_tests)[1], run.conditions)
        first = composer.compose(drafts[0].overrides)
    check_configuration(first.config, f"'{' '.join(lines)}'")


def check_plan(plan: Plan, where: str) -> None:
    """Raise ``UsageError`` where a plan that was read holds a configuration that could not be planned here and now."""
    for condition in plan.conditions:
        place = f"{where}, condition '{condition.name}'"
        try:
            check_configuration(condition.config, place)
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
            # Hashes that are right do not make a configuration one of ours.
            reason = f"{type(error).__name__}: {error}"
            raise UsageError(f"{place}: no test can be made with this configuration ({reason})") from error


def _condition(draft: Draft, composition: Composition, repetitions: int, seed: int, composer: Composer) -> Condition:
    config = {key: value for key, value in composition.config.items() if key not in RUN_KEYS}
    choices = {group: choice for group, choice in composition.choices.items() if choice and group != "campaign"}
    where = f"condition '{draft.name}'"
    check_configuration(config, where)
    if not config.get("plant"):
        with naming(where):
            config["controller_model"] = composer.model(str(config["controller"].get("model")))
    elif find_controller(str(config["controller"]["name"])).inverts:
        _add_inverted_model(config, composer, where)
    duration = trajectory_of(config).duration
    config |= {"repetitions": repetitions, "seed": seed}
    return Condition(draft.name, choices, config, duration, config_sha256(config))


def _add_inverted_model(config: dict[str, Any], composer: Composer, where: str) -> None:
    """Add the model that a controller of another plant inverts; raises ``UsageError`` where it cannot be inverted."""
    lines = [f"plant={config['plant']['name']}", f"model={config['controller'].get('model')}"]
    with naming(where):
        config["controller_model"] = composer.compose(lines).config["model"]
        check_configuration({**config, "model": config["controller_model"]})
        prepare(config, 1)


def trajectory_of(config: Mapping[str, Any]) -> Trajectory:
    """Return the trajectory of a resolved configuration, in the unit that its plant follows."""
    if not config.get("plant"):
        return build_trajectory(config["trajectory"])

    return build_trajectory(config["trajectory"], unit=followed_unit(config, plant_in(config))[1])


def _refuse_too_many(drafts: Sequence[Draft], run: RunKeys, composer: Composer) -> None:
    count = len(drafts) * run.repetitions
    if count > run.most_tests:
        first = composer.compose(drafts[0].overrides).config
        days = count * trajectory_of(first).duration / 86400
        conditions = f"{len(drafts)} condition{'s' * (len(drafts) != 1)}"
        raise UsageError(
            f"{conditions} x {counted(run.repetitions, 'repetition')} = {counted(count, 'test')}, some {days:.3g} days of motion; "
            f"at most {run.most_tests} are made, unless you say most_tests={count}"
        )


def _selected(drafts: list[Draft], patterns: Any) -> list[Draft]:
    if patterns is None:
        return drafts
    names = [draft.name for draft in drafts]
    kept: set[str] = set()
    for pattern in patterns if isinstance(patterns, list | tuple) else [patterns]:
        known = {name: (name, folder_name(name), lasting_name(name)) for name in names}
        found = [name for name in names if fnmatch.filter(known[name], str(pattern))]
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
