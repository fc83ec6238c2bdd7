"""Lines of a plant may be called as one likes, also as something in the compiled model."""

from __future__ import annotations

from pathlib import Path

import pytest

from hjcamp.errors import UsageError
from hjcamp.known_plants import find_plant
from hjcamp.model.checks.place_checks import PlainModel
from hjcamp.model.language.vocabulary import read_vocabulary

PLANT = '''"""A tank."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, sensor, signal, sqrt


class Tank(Plant):
    """A tank that runs out."""

    level = State("m", typical=1.0, low=0.0)
    inflow = Input("m^3/s", typical=0.02)
    p = Parameter("m^2", 2.5, (0.1, 50.0), "log-uniform", base=True)
    k = Parameter("m^2.5/s", 0.025, (1e-4, 1.0), "log-uniform", base=True)
    period = 2.0
    level_m = Measured("gauge", of="level")

    @staticmethod
    def equations(state, parameter, drive, rate):
        {a} = sqrt(state.level)
        {out} = parameter.k * {a}
        {z} = {mark}
        rate.level = {z} / parameter.p
        gauge = sensor(state.level)
'''


def written(folder: Path, **names: str) -> None:
    (folder / "plants").mkdir(exist_ok=True)
    (folder / "plants" / "tank.py").write_text(PLANT.format(**names), encoding="utf-8")


def test_plain_lines_may_have_any_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    written(tmp_path, a="a", out="out", z="z", mark="drive.inflow - out")
    model = PlainModel(find_plant("tank"))
    rate = model.rates({"level": 4.0, "inflow": 0.06, "time": 0.0})["level"]
    assert rate == pytest.approx((0.06 - 0.025 * 2.0) / 2.5)


def test_what_effects_may_use_keeps_its_name_so_that_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    written(tmp_path, a="a", out="out", z="z", mark='signal(drive.inflow - out, "m^3/s")')
    with pytest.raises(UsageError, match="'z' is a name that the compiled model has for itself; call this line otherwise"):
        read_vocabulary(find_plant("tank"))
