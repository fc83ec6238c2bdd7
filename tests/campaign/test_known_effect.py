"""A controller that knows an added effect tracks better than one that does not."""

from __future__ import annotations

from pathlib import Path

import polars as pl
import pytest

from hjcamp import cli

MODEL = """
name: tight_seals
parameters: {}
effects: {pressure_friction: {coefficient: 6.0e-6, reference: 0.2e+6}}
"""


@pytest.mark.study
def test_the_feedforward_that_knows_the_seals_tracks_better(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("HJCAMP_CONF", raising=False)
    Path("conf/model").mkdir(parents=True)
    Path("conf/model/tight_seals.yaml").write_text(MODEL, encoding="utf-8")
    errors = {}
    for known in ("published", "tight_seals"):
        words = ["run", "campaign=known_effect", "model=tight_seals", f"controller.model={known}", "workers=1"]
        assert cli.run([*words, "repetitions=2", f"run_dir={known}"]) == 0
        rows = pl.read_csv(Path(known) / "tables" / "indicators.csv")
        errors[known] = dict(rows.group_by("trajectory").agg(pl.col("rmse1_deg").mean()).iter_rows())
    better = [errors["tight_seals"][name] / errors["published"][name] for name in errors["published"]]
    assert len(better) == 3
    assert max(better) < 1.0
    assert sum(better) / 3 < 0.97
