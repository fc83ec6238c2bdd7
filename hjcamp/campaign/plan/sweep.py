"""What a call with ``-m`` will do, before it does it: its jobs, or the space in which a sweeper looks for the best one."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from hjcamp.campaign.files.dotted_paths import look_up
from hjcamp.campaign.plan.objective import Objective, read_objectives
from hjcamp.campaign.plan.planning import check_call
from hjcamp.configuration import optuna_sweeper
from hjcamp.configuration.search_space import asked_of, count_of, ends_of, space_of
from hjcamp.errors import UsageError, unknown

if TYPE_CHECKING:
    from hydra.core.override_parser.types import Override

    from hjcamp.configuration.composer import Composer

BASIC = "basic"
CHECKED_JOBS = 50
MOST_JOBS = 100_000
#: Where the sweepers of Hydra (optuna, nevergrad, ax) keep how many jobs they make.
COUNTS = ("n_trials", "optim.budget", "ax_config.max_trials")
INSTALL = {"optuna": "pip install 'hjcamp[sweep]'"}


@dataclass(frozen=True)
class Sweep:
    """The jobs of a sweep as lists of overrides. Where a sweeper looks for values by itself, ``space`` is where, by key,
    ``jobs`` its two ends, and ``count`` how many it makes (None: not known).
    """

    sweeper: str
    jobs: list[list[str]]
    count: int | None
    space: dict[str, str]
    objectives: tuple[Objective, ...]


def read_sweep(lines: Sequence[Override], composer: Composer) -> Sweep:
    """Return what the overrides of a sweep ask for; ``UsageError`` for a job that cannot be run, as far as that is cheap."""
    chosen = [str(line.value()) for line in lines if line.key_or_group == "hydra/sweeper"]
    sweeper = chosen[-1] if chosen else BASIC
    if sweeper not in (known := composer.options("hydra/sweeper")):
        more = f"; {sweeper} comes with: {INSTALL[sweeper]}" if sweeper in INSTALL else ""
        raise UsageError(f"{unknown('hydra/sweeper', sweeper, known)}{more}")
    own = [line for line in lines if not line.is_hydra_override()]
    composer.tell_choices(own)
    for line in lines:
        if sweeper == BASIC and line.key_or_group.startswith("hydra.sweeper.params"):
            raise UsageError(f"'{line.input_line}': without hydra/sweeper=NAME give what varies by itself, such as seed=1,2")
    if sweeper == BASIC:
        jobs = _product(own)
        for job in jobs[:CHECKED_JOBS]:
            check_call(job, composer)
        return Sweep(sweeper, jobs, len(jobs), {}, objectives_of(jobs[0], composer))
    settings = composer.sweeper([str(line.input_line) for line in lines])
    asked = asked_of(own, settings)
    space = {key: str(line.get_value_string()) for key, line in asked.items() if line.is_sweep_override()}
    if not space:
        raise UsageError(
            f"hydra/sweeper={sweeper} has nothing to vary; give a range, such as controller.positive.kp='interval(0.5,1.5)'"
        )
    jobs = [list(job) for job in zip(*map(ends_of, asked.values()), strict=True)]
    for job in jobs:
        check_call(job, composer)
    objectives = objectives_of(jobs[0], composer)
    _check_directions(sweeper, objectives, settings)
    if settings.get("_target_") == optuna_sweeper.TARGET:
        optuna_sweeper.check_settings(settings, len(objectives))
    count = next((int(found) for key in COUNTS if (found := look_up(settings, key)) is not None), None)
    return Sweep(sweeper, jobs, count, space, objectives)


def objectives_of(job: Sequence[str], composer: Composer) -> tuple[Objective, ...]:
    """Return the objectives of a job."""
    return read_objectives(composer.compose(job).config.get("objective"))


def _product(lines: Sequence[Override]) -> list[list[str]]:
    from hydra._internal.core_plugins.basic_sweeper import BasicSweeper

    for line in lines:
        if line.is_sweep_override() and not line.is_discrete_sweep():
            raise UsageError(
                f"'{line.input_line}': a range is for a sweeper that looks for values (hydra/sweeper=optuna); "
                "list them with commas"
            )
        space_of(line)  # refuses an empty range
    if (count := math.prod(map(count_of, lines))) > MOST_JOBS:
        raise UsageError(f"{count} jobs; a sweep has at most {MOST_JOBS}: give fewer values, or hydra/sweeper=optuna")
    batches = BasicSweeper.split_arguments(list(lines), None)
    return [list(job) for batch in batches for job in batch]


def _check_directions(sweeper: str, objectives: Sequence[Objective], settings: Mapping[str, Any]) -> None:
    if not objectives:
        raise UsageError(
            f"hydra/sweeper={sweeper} makes a number small: give objective=INDICATOR, a formula such as "
            "'objective=rmse1_deg + 0.1*e_max_deg', or a list of them"
        )
    given = settings.get("direction")
    several = len(given) if isinstance(given, list) else 1
    if given is not None and several != len(objectives):
        each = ",".join(["minimize"] * len(objectives))
        raise UsageError(
            f"{len(objectives)} objective{'s' * (len(objectives) != 1)} and {several} of hydra.sweeper.direction; "
            f"give hydra.sweeper.direction={f'[{each}]' if len(objectives) > 1 else each}"
        )
