"""The sweeper by optuna without the runs: what it asks of the launcher, and what it makes of the answers."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hydra.core.utils import JobReturn, JobStatus
from hypothesis import given
from hypothesis import strategies as st
from omegaconf import OmegaConf

from hjcamp.configuration.composer import Composer
from hjcamp.configuration.optuna_sweeper import OptunaSweeper
from hjcamp.configuration.overrides import parse_overrides
from hjcamp.configuration.search_space import Interval, space_of
from hjcamp.errors import HjcampError, UsageError

KP = "controller.positive.kp"


class Launcher:
    """Stand in for Hydra's: what a job gives follows from its overrides."""

    def __init__(self, answer: Callable[[dict[str, str]], Any]) -> None:
        self.answer, self.batches = answer, list[list[dict[str, str]]]()

    def launch(self, jobs: list[list[str]], initial_job_idx: int) -> list[JobReturn]:
        assert initial_job_idx == sum(map(len, self.batches))
        batch = [dict(line.split("=", 1) for line in job) for job in jobs]
        self.batches.append(batch)
        return [self._ended(job) for job in batch]

    def _ended(self, job: dict[str, str]) -> JobReturn:
        try:
            return JobReturn(_return_value=self.answer(job), status=JobStatus.COMPLETED)
        except ArithmeticError as error:
            return JobReturn(_return_value=error, status=JobStatus.FAILED)


def swept(answer: Callable[[dict[str, str]], Any], *words: str, objective: Any = "rmse1_deg") -> list[dict[str, str]]:
    """Return the overrides of every job of a sweep with these words."""
    settings = Composer().sweeper(["hydra/sweeper=optuna", *(one for one in words if one.startswith("hydra"))])
    sweeper = OptunaSweeper(**{key: value for key, value in settings.items() if key != "_target_"})
    sweeper.config = OmegaConf.create({"objective": objective})
    sweeper.launcher = launcher = Launcher(answer)  # type: ignore[assignment]
    sweeper.sweep([one for one in words if not one.startswith("hydra")])
    at_once = settings["n_jobs"]
    assert all(len(batch) == at_once for batch in launcher.batches[:-1]) and len(launcher.batches[-1]) <= at_once
    return [job for batch in launcher.batches for job in batch]


@pytest.mark.parametrize("sampler", ["tpe", "cmaes"])
def test_it_finds_the_gain(sampler: str) -> None:
    jobs = swept(
        lambda job: (float(job[KP]) - 0.9) ** 2,
        f"{KP}=interval(0.5,1.5)",
        "pump=pump1",
        "hydra.sweeper.sampler.seed=1",
        f"hydra/sweeper/sampler={sampler}",
    )
    assert len(jobs) == 20 and {job["pump"] for job in jobs} == {"pump1"}
    assert min(abs(float(job[KP]) - 0.9) for job in jobs) < 0.05


@pytest.mark.parametrize("way", ["minimize", "maximize"])
def test_a_direction_decides_where_it_looks(way: str) -> None:
    jobs = swept(
        lambda job: float(job[KP]),
        f"{KP}=tag(log,interval(0.01,1.0))",
        f"hydra.sweeper.direction={way}",
        "hydra.sweeper.n_trials=40",
        "hydra.sweeper.sampler.seed=2",
    )
    late = sorted(float(job[KP]) for job in jobs[20:])
    assert late[10] < 0.05 if way == "minimize" else late[10] > 0.2  # the middle of the range is 0.1


@pytest.mark.parametrize("sampler", ["tpe", "random", "nsgaii"])
def test_two_objectives_with_a_seed_give_the_same_values_again(sampler: str) -> None:
    words = (
        f"{KP}=range(0.5,1.5,0.25)", "pump=choice(pump1,pump2)", "n=int(interval(1,3))", "hydra.sweeper.sampler.seed=5",
        "hydra.sweeper.n_trials=5", "hydra.sweeper.n_jobs=2", f"hydra/sweeper/sampler={sampler}",
    )  # fmt: skip
    first, again = (swept(lambda job: (float(job[KP]), 1.0), *words, objective=["a", "b"]) for _ in range(2))
    assert first == again and len(first) == 5
    assert {job[KP] for job in first} <= {"0.5", "0.75", "1.0", "1.25"}
    assert {job["pump"] for job in first} <= {"pump1", "pump2"} and {job["n"] for job in first} <= {"1", "2", "3"}


def test_a_kept_study_goes_on_with_other_values(tmp_path: Path) -> None:
    kept = (
        f"hydra.sweeper.storage=sqlite:///{tmp_path}/gain.db",
        "hydra.sweeper.study_name=gain",
        "hydra.sweeper.sampler.seed=1",
        "hydra.sweeper.n_trials=3",
        f"{KP}=interval(0.5,1.5)",
    )
    values = {job[KP] for _ in range(2) for job in swept(lambda job: float(job[KP]), *kept)}
    assert len(values) == 6
    with pytest.raises(UsageError, match=r"the study gain in .* was begun with hydra.sweeper.direction=\[minimize\]"):
        swept(lambda job: (1.0, 2.0), *kept, objective=["a", "b"])


def test_the_first_job_that_fails_ends_the_sweep() -> None:
    asked: list[str] = []

    def answer(job: dict[str, str]) -> float:
        asked.append(job[KP])
        return 1.0 / (len(asked) - 3)

    with pytest.raises(ZeroDivisionError):
        swept(answer, f"{KP}=interval(0.5,1.5)")
    assert len(asked) == 3
    with pytest.raises(HjcampError, match="no value of the objective"):
        swept(lambda job: "runs/1", f"{KP}=interval(0.5,1.5)")


@given(
    start=st.integers(-50, 50),
    step=st.integers(-20, 20).filter(bool),
    count=st.integers(1, 40),
    scale=st.sampled_from([1, 0.5, 0.25]),
)
def test_a_range_holds_what_hydra_counts(start: int, step: int, count: int, scale: float) -> None:
    written = f"range({start * scale},{(start + count * step) * scale},{step * scale})"
    line = parse_overrides([f"a={written}"])[0]
    values, space = [float(one) for one in line.sweep_string_iterator()], space_of(line)
    assert isinstance(space, Interval) and len(values) == count
    assert (space.low, space.high, space.step) == (min(values), max(values), abs(step * scale))
    assert isinstance(space.low, int) == (scale == 1)
