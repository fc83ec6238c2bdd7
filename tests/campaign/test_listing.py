"""Runs as rows: columns of choices, parameters and indicators, sorted; unknown ones are refused."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hjcamp.campaign.files.run_folder import folder_for
from hjcamp.campaign.plan.planning import make_plan
from hjcamp.campaign.runs.finding import find_runs
from hjcamp.campaign.runs.listing import in_order, rows_of
from hjcamp.commands.runs.ls import ls
from hjcamp.configuration.composer import Composer
from hjcamp.errors import UsageError


def test_rows_columns_order_and_answer(composer: Composer, empty_folder: Path) -> None:
    for payload, mean in (("none", 1.0), ("brass_8p5g", 3.0)):
        asked = [f"payload={payload}"]
        plan = make_plan(composer.compose(asked).config, None, asked, composer)
        folder, _ = folder_for(plan, {}, asked, Path(f"runs/{payload}"))
        content = {
            "a": {"n": 1, "rmse1_deg": {"mean": mean, "std": None}},
            "b": {"n": 1, "rmse1_deg": {"mean": mean + 1, "std": None}},
        }
        (folder.path / "metrics.json").write_text(json.dumps(content))
    runs = find_runs([Path("runs")])
    rows = in_order(rows_of(runs, ["run", "payload", "rmse1_deg", "controller.positive.kp"]), "-rmse1_deg")
    assert [(row["payload"], row["rmse1_deg"]) for row in rows] == [("brass_8p5g", 3.5), ("none", 1.5)]
    assert all(isinstance(row["controller.positive.kp"], float) for row in rows)
    ls(None, None, "+payload,rmse1_deg", "rmse1_deg", json=Path("answer.json"))
    answer = json.loads(Path("answer.json").read_text())
    assert answer["schema"] == "hjcamp.runs/1" and [row["rmse1_deg"] for row in answer["runs"]] == [1.5, 3.5]
    assert answer["columns"] == ["run", "campaign", "state", "tests", "started", "payload", "rmse1_deg"]
    (Path("runs/none") / "report.html").write_text("<p>")
    ls(None, None, "payload", None, Path("runs/index.html"))
    page = Path("runs/index.html").read_text()
    assert '<a href="none/report.html">runs/none</a>' in page and "<td>runs/brass_8p5g</td><td>brass_8p5g</td>" in page
    (runs[0].path / "metrics.json").write_text("[1, 2")
    assert in_order(rows_of(runs, ["rmse1_deg"]), "-rmse1_deg")[-1]["rmse1_deg"] is None
    with pytest.raises(UsageError, match=r"unknown column 'paylod'.*payload"):
        rows_of(runs, ["paylod"])
    with pytest.raises(UsageError, match="--sort kp: no column"):
        in_order(rows, "kp")
    with pytest.raises(UsageError, match="at least one column"):
        ls(None, None, ",")
    # a folder is what one names first
    for words, number in ((["."], 2), (["runs/none"], 1), (["runs", "payload=none"], 1), (["payload=none"], 1), (["."] * 2, 2)):
        ls(words, json=Path("answer.json"))
        assert len(json.loads(Path("answer.json").read_text())["runs"]) == number, words
    with pytest.raises(UsageError, match="'nowhere' is no folder and no filter; write KEY=VALUE"):
        ls(["nowhere"])
