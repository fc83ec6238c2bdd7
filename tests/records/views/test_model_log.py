"""Tests with models and residuals as topics: read back by the library of the format, and the layouts that show them."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from mcap.reader import make_reader

from hjcamp.errors import HjcampError
from hjcamp.records.views.model_log import MEASURED, ModelledTest, topic_of, write_modelled

TIME = np.arange(20) * 0.004
ARM, SAID = 10.0 * np.sin(TIME), 9.0 * np.sin(TIME)


def modelled(name: str = "ramp/1") -> ModelledTest:
    """Return a test with one model, whose first value is not known."""
    said = SAID.copy()
    said[0] = np.nan
    return ModelledTest(
        name,
        "ramp",
        TIME,
        {"arm_deg": ARM, "dither_v": TIME},
        {"with leakage": {"arm_deg": said}},
        {"condition": "ramp"},
    )


def test_models_and_residuals_are_topics_with_units_and_times(tmp_path: Path) -> None:
    path, foxglove, plotjuggler = write_modelled(tmp_path, [modelled()])
    assert path.name == "ramp__1.mcap"
    found: dict[str, list[tuple[int, dict[str, float]]]] = {}
    with path.open("rb") as stream:
        reader = make_reader(stream)
        for schema, channel, message in reader.iter_messages():
            assert schema is not None and schema.encoding == "jsonschema"
            found.setdefault(channel.topic, []).append((message.log_time, json.loads(message.data)))
        summary = reader.get_summary()
    assert set(found) == {MEASURED, "/model/with_leakage", "/residual/with_leakage"}
    assert summary is not None
    assert all(channel.metadata["unit.arm_deg"] == "deg" for channel in summary.channels.values())
    assert [at for at, _ in found[MEASURED]][1] - found[MEASURED][0][0] == 4_000_000
    assert found["/model/with_leakage"][0][1] == {} and found["/residual/with_leakage"][0][1] == {}
    left = [row["arm_deg"] for _, row in found["/residual/with_leakage"][1:]]
    assert np.allclose(left, (ARM - SAID)[1:])
    layout = json.loads(foxglove.read_text(encoding="utf-8"))
    values = [path["value"] for panel in layout["configById"].values() for path in panel["paths"]]
    assert values == [f"{MEASURED}.arm_deg", "/model/with_leakage.arm_deg", "/residual/with_leakage.arm_deg"]
    assert {layout["layout"]["first"], layout["layout"]["second"]} == set(layout["configById"])
    curves = [one.attrib["name"] for one in ElementTree.parse(plotjuggler).iter("curve")]
    assert curves == [value.replace(".", "/") for value in values]


def test_equal_tests_are_equal_bytes_and_none_is_refused(tmp_path: Path) -> None:
    first, second = (write_modelled(tmp_path / one, [modelled()])[0].read_bytes() for one in "ab")
    assert first == second
    with pytest.raises(HjcampError, match="no test"):
        write_modelled(tmp_path / "c", [])


def test_names_of_models_fit_every_viewer() -> None:
    assert topic_of("model", "calibrated here") == "/model/calibrated_here"
    assert topic_of("residual", "a/b.c é") == "/residual/a_b_c"
