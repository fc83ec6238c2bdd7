"""A user's folder with two plants: a carriage with dry friction, and two tanks without any contact."""

from __future__ import annotations

from pathlib import Path

import pytest

from hjcamp.plants._template import TEMPLATE

TANKS = '''"""Two tanks, one above the other."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, path, sensor, sqrt, store


class Tanks(Plant):
    """A pump fills the upper one of two tanks, which runs out into the lower one."""

    upper = State("V", typical=5.0, low=0.0, start="unknown")
    lower = State("V", typical=5.0, low=0.0)
    pump = Input("V", typical=3.0)
    k1 = Parameter("V**0.5/s", 0.05, (1e-4, 1.0), "log-uniform", base=True)
    k3 = Parameter("V**0.5/s", 0.05, (1e-4, 1.0), "log-uniform", base=True)
    k4 = Parameter("1/s", 0.05, (1e-4, 1.0), "log-uniform", base=True)
    level_v = Measured("gauge", of="lower")

    @staticmethod
    def equations(state, parameter, drive, rate):
        inflow = actuator(parameter.k4 * drive.pump)
        between = path(parameter.k1 * sqrt(state.upper), upstream=state.upper, downstream=state.lower)
        outflow = path(parameter.k3 * sqrt(state.lower), upstream=state.lower)
        rate.upper = store(inflow - between)
        rate.lower = store(between - outflow)
        gauge = sensor(state.lower)
'''
AXIS = TEMPLATE.format(title="Axis")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a user's folder that is the working directory."""
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "axis.py").write_text(AXIS)
    (tmp_path / "plants" / "tanks.py").write_text(TANKS)
    monkeypatch.chdir(tmp_path)
    return tmp_path
