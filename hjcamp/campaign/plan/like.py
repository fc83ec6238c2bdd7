"""The plan of a run that makes the tests of one log again, by the resolved configuration in that log, not by the files here."""

from __future__ import annotations

from pathlib import Path

from hjcamp.campaign.plan.planning import SINGLE, trajectory_of
from hjcamp.configuration.check import check_configuration
from hjcamp.configuration.run_keys import read_run_keys
from hjcamp.errors import UsageError
from hjcamp.records.log import TestLog
from hjcamp.records.plan import SAFE_NAME, Condition, Plan, config_sha256, plan_sha256, planned_tests
from hjcamp.report.runs.indicators import configuration

CONFIGURATION = "config.yaml"


def plan_like(log: TestLog, path: Path) -> Plan:
    """Return the plan of the condition of ``log`` with its repetitions and seed: in simulation its tests are equal, bit for bit.

    Raises ``UsageError`` for a log that holds no configuration (it was imported), and one whose configuration is not that which its
    hash is of, or which cannot be run here.
    """
    attached = log.attachments.get(CONFIGURATION)
    if attached is None:
        raise UsageError(f"--like {path}: the log holds no configuration: it was not made by hjcamp run")
    config = configuration(attached)
    if config_sha256(config) != log.metadata.get("config_sha256"):
        raise UsageError(
            f"--like {path}: the configuration in the log is not that which its test was made with (config_sha256)"
        )
    name = log.metadata.get("condition", "")
    if not SAFE_NAME.fullmatch(name):
        raise UsageError(f"--like {path}: its condition has a name that no folder can have")
    check_configuration(config, f"--like {path}")
    keys = read_run_keys(config)
    choices = {group: log.metadata[group] for group in config if group in log.metadata and isinstance(config[group], dict)}
    condition = Condition(name, choices, config, trajectory_of(config).duration, config_sha256(config))
    campaign = log.metadata.get("campaign", "")
    campaign = campaign if SAFE_NAME.fullmatch(campaign) else SINGLE
    return Plan(
        campaign,
        f"as in {path.name}",
        (),
        keys.repetitions,
        keys.seed,
        {},
        {},
        (condition,),
        planned_tests([name], keys.repetitions, keys.seed),
        plan_sha256(campaign, (), keys.repetitions, keys.seed, [condition]),
    )
