"""Degrees become kelvins; a plant that is written for degrees Celsius is told of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from hjcamp.records.elsewhere.importing import import_files

PLANT = '''"""A block that is heated."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, sensor


class Oven(Plant):
    """A block that cools to a room."""

    warmth = State("K"TYPICAL)
    power = Input("W", typical=50.0)
    capacity = Parameter("J/K", 200.0)
    loss = Parameter("W/K", 2.0, (0.01, 100.0), "log-uniform", base=True)
    ambient = Parameter("K", AMBIENT, (0.0, 400.0), base=True)
    period = 1.0
    warmth_k = Measured("probe", of="warmth")

    @staticmethod
    def equations(state, parameter, drive, rate):
        rate.warmth = (drive.power - parameter.loss * (state.warmth - parameter.ambient)) / parameter.capacity
        probe = sensor(state.warmth)
'''


@pytest.mark.parametrize(
    ("typical", "ambient", "unit", "told"),
    [
        (", typical=50.0", "23.0", "degC", True),
        ("", "23.0", "degC", True),
        (", typical=310.0", "296.0", "degC", False),
        ("", "296.0", "degC", False),
        (", typical=50.0", "23.0", "K", False),
        (", typical=50.0", "23.0", "degF", True),
        (", typical=310.0", "296.0", "degF", False),
    ],
)
def test_kelvins_of_degrees_that_the_plant_is_not_written_for_are_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, typical: str, ambient: str, unit: str, told: bool
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "oven.py").write_text(PLANT.replace("TYPICAL", typical).replace("AMBIENT", ambient))
    degrees = 40.0 + 15.0 * np.sin(np.arange(200.0) / 20.0)
    values = 1.8 * degrees + 32.0 if unit == "degF" else degrees
    rows = [f"{k},{one:.6g},10" for k, one in enumerate(values)]
    (tmp_path / "oven.csv").write_text("\n".join(["t,T,P", *rows]) + "\n")
    fields = {"time_s": "t", "warmth_k": {"column": "T", "unit": unit}, "power_w": "P"}
    (tmp_path / "map.yaml").write_text(yaml.safe_dump({"plant": "oven", "fields": fields}))
    [log] = import_files(["oven.csv"], "map.yaml", ["oven.mcap"])
    said = [one for one in log.doubtful if one.field == "warmth_k"]
    assert bool(said) == told
    if told:
        assert not said[0].refused and "Celsius" in said[0].text


def test_a_sensor_that_reads_absolute_zero_is_no_internal_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "oven.py").write_text(PLANT.replace("TYPICAL", "").replace("AMBIENT", "23.0"))
    rows = [f"{k},{20.0 if k < 10 else -273.15},10" for k in range(200)]
    (tmp_path / "oven.csv").write_text("\n".join(["t,T,P", *rows]) + "\n")
    fields = {"time_s": "t", "warmth_k": {"column": "T", "unit": "degC"}, "power_w": "P"}
    (tmp_path / "map.yaml").write_text(yaml.safe_dump({"plant": "oven", "fields": fields}))
    [log] = import_files(["oven.csv"], "map.yaml", ["oven.mcap"])
    assert log.samples == 200
