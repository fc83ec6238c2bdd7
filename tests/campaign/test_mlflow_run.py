"""A run in a tracking store: parameters, metrics, artefacts, and the same run once; the store here is a stand-in of its client."""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import polars as pl
import pytest

from hjcamp import cli
from hjcamp.campaign.files import mlflow_run
from hjcamp.campaign.files.run_folder import folder_for
from hjcamp.campaign.plan.planning import make_plan
from hjcamp.configuration.composer import Composer


class Store:
    """What `MlflowClient` does, as far as the bridge asks for it."""

    runs: list[dict[str, Any]] = []  # noqa: RUF012
    fails = ""

    def __init__(self, tracking_uri: str) -> None:
        if self.fails:
            raise RuntimeError(f"{self.fails}\nsecond line")

    def get_experiment_by_name(self, name: str) -> Any:
        return SimpleNamespace(experiment_id=name) if any(one["experiment"] == name for one in self.runs) else None

    def create_experiment(self, name: str) -> str:
        return name

    def search_runs(self, experiments: list[str], asked: str, max_results: int) -> list[Any]:
        digest = asked.split("'")[1]
        return [
            SimpleNamespace(info=SimpleNamespace(run_id=one["id"]))
            for one in self.runs
            if one["experiment"] in experiments and digest in one["tags"].values() and one["ended"]
        ]

    def create_run(self, experiment: str, run_name: str, tags: dict[str, str]) -> Any:
        one = {
            "id": str(len(self.runs)),
            "experiment": experiment,
            "tags": tags,
            "params": {},
            "metrics": {},
            "files": [],
            "ended": False,
        }
        self.runs.append(one)
        return SimpleNamespace(info=SimpleNamespace(run_id=one["id"]))

    def log_batch(self, identity: str, metrics: Any = (), params: Any = ()) -> None:
        assert len(params) <= 100 and len(metrics) <= 1000
        one = self.runs[int(identity)]
        one["params"].update({each.key: each.value for each in params})
        one["metrics"].update({each.key: each.value for each in metrics})

    def log_artifact(self, identity: str, path: str) -> None:
        self.runs[int(identity)]["files"].append(Path(path).name)

    def log_artifacts(self, identity: str, path: str, name: str) -> None:
        self.runs[int(identity)]["files"] += [f"{name}/{one.name}" for one in Path(path).iterdir()]

    def set_terminated(self, identity: str) -> None:
        self.runs[int(identity)]["ended"] = True


@pytest.fixture
def store(monkeypatch: pytest.MonkeyPatch) -> type[Store]:
    tracking, entities = ModuleType("mlflow.tracking"), ModuleType("mlflow.entities")
    tracking.MlflowClient = Store  # type: ignore[attr-defined]
    entities.Param = lambda key, value: SimpleNamespace(key=key, value=value)  # type: ignore[attr-defined]
    entities.Metric = lambda key, value, when, step: SimpleNamespace(key=key, value=value)  # type: ignore[attr-defined]
    for name, module in (("mlflow", ModuleType("mlflow")), ("mlflow.tracking", tracking), ("mlflow.entities", entities)):
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.setattr(mlflow_run, "find_spec", lambda name: name)
    monkeypatch.setattr(Store, "runs", [])
    return Store


@pytest.fixture
def run(composer: Composer, empty_folder: Path) -> Path:
    words = ["repetitions=2"]
    plan = make_plan(composer.compose(words).config, None, words, composer)
    folder, _ = folder_for(plan, composer.compose(words).config, words, Path("mine"))
    (folder.path / "tables").mkdir()
    rows = {
        "condition": ["a b", "a b", "c"],
        "repetition": [1, 2, 1],
        "rmse1_deg": [1.0, 3.0, None],
        "sse_deg": [0.5, float("nan"), 1.5],
    }
    pl.DataFrame(rows).write_parquet(folder.path / "tables/indicators.parquet")
    (folder.path / "report.html").write_text("page")
    return folder.path


def test_a_run_goes_into_a_store_once(run: Path, store: type[Store], capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["share", "mine", "--mlflow", "store"]) == 0, capsys.readouterr().err
    [one] = store.runs
    assert one["experiment"] == "single" and one["ended"]
    assert one["params"]["pump.bore_mm"] == "6.35" and len(one["params"]) > 100
    assert one["metrics"] == {"rmse1_deg": 2.0, "rmse1_deg/a b": 2.0, "sse_deg": 1.0, "sse_deg/a b": 0.5, "sse_deg/c": 1.5}
    assert sorted(one["files"]) == ["config.yaml", "manifest.json", "plan.json", "report.html", "tables/indicators.parquet"]
    assert cli.run(["share", "mine", "--mlflow", "store"]) == 0
    assert len(store.runs) == 1 and "was there already" in capsys.readouterr().out
    # a run that changed is another one
    (run / "manifest.json").write_text((run / "manifest.json").read_text() + " ")
    assert cli.run(["share", "mine", "--mlflow", "store"]) == 0 and len(store.runs) == 2


def test_what_a_store_refuses_is_one_sentence(
    run: Path, store: type[Store], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(Store, "fails", "no connection")
    assert cli.run(["share", "mine", "--mlflow", "http://127.0.0.1:1"]) == 1
    assert capsys.readouterr().err == "hjcamp: --mlflow http://127.0.0.1:1: the store refuses: no connection\n"


def test_without_the_extra_one_line_names_it(
    run: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(mlflow_run, "find_spec", lambda name: None)
    assert cli.run(["share", "mine", "--mlflow", "store"]) == 2
    assert "pip install 'hjcamp[mlflow]'" in capsys.readouterr().err and capsys.readouterr().err.count("\n") <= 1
