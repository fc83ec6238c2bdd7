"""A finished run in an MLflow tracking store: parameters, means of the indicators, tables and page; the same run once."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from hjcamp.campaign.files.dotted_paths import leaves
from hjcamp.campaign.files.lock import is_locked
from hjcamp.campaign.files.run_folder import open_folder
from hjcamp.errors import HjcampError, UsageError
from hjcamp.records.elsewhere.reader import first_line
from hjcamp.storage import shown_path
from hjcamp.yaml_file import read_yaml

TAG = "hjcamp.run_sha256"
LONGEST_VALUE, MOST_PARAMETERS = 500, 100  # what a store takes: of a value, and at once
ARTEFACTS = ("config.yaml", "plan.json", "manifest.json", "report.html", "tables")
# What a name may hold there.
OTHERS = re.compile(r"[^\w ./-]+")


def check_mlflow() -> None:
    """Raise ``UsageError`` where MLflow is not installed."""
    if find_spec("mlflow") is None:
        raise UsageError("--mlflow needs the extra 'mlflow', which is not installed: pip install 'hjcamp[mlflow]'")


def track(run: Path, store: str) -> tuple[str, bool]:
    """Write a run into the store (a database's or a server's address); return its id there, and whether it is new.

    Raises UsageError for a folder that is no run, and one in which a process is at work; HjcampError where the store refuses.
    """
    check_mlflow()
    folder = open_folder(run)
    if is_locked(run):
        raise UsageError(f"{shown_path(run)}: a process is at work in this run; track it when that has ended")
    from mlflow.tracking import MlflowClient

    campaign = folder.plan.campaign or "single"
    digest = hashlib.sha256((run / "manifest.json").read_bytes()).hexdigest()
    try:
        client = MlflowClient(tracking_uri=store)
        known = client.get_experiment_by_name(campaign)
        experiment = known.experiment_id if known else client.create_experiment(campaign)
        if found := client.search_runs(
            [experiment], f"tags.`{TAG}` = '{digest}' and attributes.status = 'FINISHED'", max_results=1
        ):
            return str(found[0].info.run_id), False
        made = client.create_run(experiment, run_name=run.resolve().name, tags={TAG: digest, **_tags(folder.manifest)})
        _fill(client, made.info.run_id, run)
        client.set_terminated(made.info.run_id)
    except HjcampError:
        raise
    except Exception as error:  # whatever a store, its database or its server raises
        raise HjcampError(f"--mlflow {store}: the store refuses: {first_line(error)}") from error
    return str(made.info.run_id), True


def _fill(client: Any, identity: str, run: Path) -> None:
    from mlflow.entities import Metric, Param

    parameters = [Param(name, value) for name, value in parameters_of(run)]
    for first in range(0, len(parameters), MOST_PARAMETERS):
        client.log_batch(identity, params=parameters[first : first + MOST_PARAMETERS])
    metrics = [Metric(name, value, 0, 0) for name, value in metrics_of(run)]
    for first in range(0, len(metrics), 1000):
        client.log_batch(identity, metrics=metrics[first : first + 1000])
    for name in ARTEFACTS:
        if (run / name).is_dir():
            client.log_artifacts(identity, str(run / name), name)
        elif (run / name).is_file():
            client.log_artifact(identity, str(run / name))


def _tags(manifest: dict[str, Any]) -> dict[str, str]:
    made: dict[str, Any] = next(iter(manifest["sessions"]), {})
    known = {key: made.get(key) for key in ("version", "git", "started_at")}
    return {f"hjcamp.{key}": str(value) for key, value in known.items() if value}


def parameters_of(run: Path) -> Iterator[tuple[str, str]]:
    """Yield every value of a run's configuration by its dotted name, as text."""
    for name, value in leaves(read_yaml(run / "config.yaml")):
        if value is not None:
            yield OTHERS.sub("_", name), str(value)[:LONGEST_VALUE]


def metrics_of(run: Path) -> Iterator[tuple[str, float]]:
    """Yield the mean of each number of the indicators over all tests, and over those of each condition (``rmse1_deg/CONDITION``)."""
    import polars as pl

    table = run / "tables" / "indicators.parquet"
    if not table.is_file():
        return
    frame = pl.read_parquet(table)
    numbers = [name for name, kind in frame.schema.items() if kind.is_float()]
    groups = [("", frame)]
    if "condition" in frame.columns:
        groups += [(f"/{OTHERS.sub('_', str(key[0]))}", own) for key, own in frame.group_by("condition", maintain_order=True)]
    for name in numbers:
        for suffix, own in groups:
            mean = own[name].drop_nulls().drop_nans().mean()
            if isinstance(mean, float):
                yield f"{name}{suffix}", mean
