"""``hydra/sweeper=optuna``: optuna is asked for values and told what they gave, in the process of the call."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, Literal

from hydra.core.config_store import ConfigStore
from hydra.core.plugins import Plugins
from hydra.core.utils import JobReturn, JobStatus
from hydra.plugins.sweeper import Sweeper
from hydra.types import HydraContext, TaskFunction
from omegaconf import DictConfig, OmegaConf

from hjcamp.errors import HjcampError, UsageError

if TYPE_CHECKING:
    from optuna import Study
    from optuna.distributions import BaseDistribution
    from optuna.samplers import BaseSampler

#: Hydra makes plugins of its own namespace alone.
TARGET = "hydra_plugins.hjcamp.OptunaSweeper"
SAMPLERS = {"tpe": "TPESampler", "random": "RandomSampler", "cmaes": "CmaEsSampler", "nsgaii": "NSGAIISampler"}
SETTINGS = {
    "_target_": TARGET,
    "defaults": [{"sampler": "tpe"}],
    "n_trials": 20,
    "n_jobs": 1,
    "direction": None,  # every objective is minimized
    "storage": None,
    "study_name": None,
    "params": None,
}


class OptunaSweeper(Sweeper):
    """Hydra's sweeper that runs ``n_trials`` jobs, ``n_jobs`` at once, with values that optuna proposes."""

    def __init__(self, **settings: Any) -> None:
        self.settings = settings
        self.launcher = None

    def setup(self, *, hydra_context: HydraContext, task_function: TaskFunction, config: DictConfig) -> None:
        """Keep what Hydra gives, and make its launcher."""
        self.hydra_context, self.config = hydra_context, config
        self.launcher = Plugins.instance().instantiate_launcher(
            config=config, hydra_context=hydra_context, task_function=task_function
        )

    def sweep(self, arguments: list[str]) -> None:
        """Run the jobs; the error of the first that fails ends the sweep."""
        from optuna.trial import TrialState

        from hjcamp.configuration.overrides import parse_overrides
        from hjcamp.configuration.search_space import asked_of

        assert self.launcher is not None and self.config is not None
        asked = asked_of(parse_overrides(arguments), self.settings)
        objective = self.config.get("objective")
        study = self._study(len(objective) if OmegaConf.is_list(objective) else 1)
        fixed = [line for line in asked.values() if not line.is_sweep_override()]
        space = {line.get_key_element(): _distribution(line) for line in asked.values() if line.is_sweep_override()}
        given = [f"{line.get_key_element()}={line.get_value_element_as_str()}" for line in fixed]
        done, count = 0, int(self.settings["n_trials"])
        while done < count:
            trials = [study.ask(space) for _ in range(min(int(self.settings["n_jobs"]), count - done))]
            jobs = [[*given, *(f"{key}={value}" for key, value in one.params.items())] for one in trials]
            for trial, ended in zip(trials, self.launcher.launch(jobs, initial_job_idx=done), strict=True):
                if ended.status != JobStatus.COMPLETED:
                    study.tell(trial, state=TrialState.FAIL)
                study.tell(trial, _values(ended), skip_if_finished=True)
            done += len(trials)

    def _study(self, objectives: int) -> Study:
        import optuna

        for name in ("alembic", "optuna"):  # they log each trial, and how a storage is set up
            logging.getLogger(name).setLevel(logging.WARNING)
        wanted = self.settings["direction"] or ["minimize"] * objectives
        directions: list[Any] = [wanted] if isinstance(wanted, str) else list(wanted)
        storage, name = self.settings["storage"], self.settings["study_name"]
        try:
            study = optuna.create_study(
                storage=storage, study_name=name, directions=directions, load_if_exists=True, sampler=self._sampler(0)
            )
        except Exception as error:  # whatever the library of the storage raises
            reason = str(error).splitlines()[0] if str(error) else type(error).__name__
            raise UsageError(f"hydra.sweeper.storage={storage} cannot be used: {reason}") from error
        if [one.name.lower() for one in study.directions] != directions:
            raise UsageError(
                f"the study {study.study_name} in {storage} was begun with hydra.sweeper.direction="
                f"[{','.join(one.name.lower() for one in study.directions)}]; give another hydra.sweeper.study_name"
            )
        # A study that goes on with the same seed would propose its first values again.
        study.sampler = self._sampler(len(study.trials))
        return study

    def _sampler(self, begun: int) -> BaseSampler:
        from optuna import samplers

        seed = self.settings["sampler"]["seed"]
        made: BaseSampler = getattr(samplers, SAMPLERS[self.settings["sampler"]["name"]])(
            seed=None if seed is None else int(seed) + begun
        )
        return made


def check_settings(settings: Any, objectives: int) -> None:
    """Raise ``UsageError`` for a setting of ``hydra.sweeper`` that optuna cannot follow."""
    from hjcamp.schema import Group, between, checked

    class Sampler(Group):
        name: Literal["tpe", "random", "cmaes", "nsgaii"]
        seed: int | None = between(0, 2**31, default=None)

    Way = Literal["minimize", "maximize"]

    class Settings(Group):
        n_trials: int = between(1, 1_000_000)
        n_jobs: int = between(1, 1024)
        direction: Way | list[Way] | None = None
        sampler: Sampler
        storage: str | None = None
        study_name: str | int | None = None
        params: dict[str, Any] | None = None

    read = checked(Settings, {key: value for key, value in settings.items() if key != "_target_"}, "hydra.sweeper")
    if read.sampler.name == "cmaes" and objectives > 1:
        raise UsageError("hydra/sweeper/sampler=cmaes takes one objective; Allowed for several: nsgaii, random, tpe")


def register() -> None:
    """Make the sweeper known to Hydra where optuna is installed (extra ``sweep``)."""
    if find_spec("optuna") is None:
        return
    Plugins.instance().class_name_to_class[TARGET] = OptunaSweeper
    store = ConfigStore.instance()
    store.store(group="hydra/sweeper", name="optuna", node=SETTINGS, provider="hjcamp")
    for name in SAMPLERS:
        node = {"name": name, "seed": None}
        store.store(group="hydra/sweeper/sampler", name=name, node=node, provider="hjcamp")


def _distribution(line: Any) -> BaseDistribution:
    from optuna.distributions import CategoricalDistribution, FloatDistribution, IntDistribution

    from hjcamp.configuration.search_space import Interval, space_of

    space = space_of(line)
    if not isinstance(space, Interval):
        return CategoricalDistribution(space)
    if isinstance(space.low, int) and isinstance(space.high, int):
        return IntDistribution(space.low, space.high, log=space.log, step=int(space.step or 1))
    return FloatDistribution(space.low, space.high, log=space.log, step=space.step)


def _values(ended: JobReturn) -> Sequence[float]:
    found = ended.return_value  # raises what the job raised
    if isinstance(found, int | float):
        return [found]
    if isinstance(found, tuple):
        return found
    raise HjcampError("a job gave no value of the objective: it has no report")
