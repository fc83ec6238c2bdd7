"""What is exported for python-control, as an FMU and as LaTeX, against the exported Python, which is the simulator's own."""

from __future__ import annotations

import importlib.util
import re
import sys
import types
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hjcamp import cli
from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.plant import Plant
from hjcamp.model.export.equations import equations_of, latex_formula
from hjcamp.model.export.fmu_file import write_fmu
from hjcamp.model.export.python_file import Exported, python_file

CLOSE = 1e-4
SAMPLES = 800


def volts() -> np.ndarray:
    """A drive that stops and starts again, so that the carriage sticks."""
    time = np.arange(SAMPLES) * 1e-3
    return 6.0 * np.sin(2.0 * np.pi * 2.5 * time) * (time % 0.4 < 0.3)


def module_of(text: str, known: dict[str, Any] | None = None) -> types.ModuleType:
    """Return a text as a module, with what stands for a library that it imports."""
    made = types.ModuleType("exported")
    with pytest.MonkeyPatch.context() as patch:
        for name, one in (known or {}).items():
            patch.setitem(sys.modules, name, one)
        exec(compile(text, "exported.py", "exec"), vars(made))
    return made


class _System:
    """What python-control makes of update and output functions, as far as a loop over samples needs it."""

    def __init__(self, update: Any, output: Any, **given: Any) -> None:
        self.update, self.output, self.given = update, output, given


def test_the_functions_for_python_control_go_from_sample_to_sample_as_the_model_does(carriage: type[Plant]) -> None:
    exported = Exported(Composition(carriage), {"coulomb": 60.0}, {"voltage": 0.0013})
    stand_in = types.ModuleType("control")
    stand_in.NonlinearIOSystem = _System  # type: ignore[attr-defined]
    made = module_of(python_file(exported, "control"), {"control": stand_in})
    system, drive = made.system(), volts()
    x = made.initial({"voltage": drive[0]})
    assert system.given["dt"] == carriage.period and system.given["outputs"] == ["encoder"]
    assert system.given["states"] == ["position", "velocity", "voltage_before_2", "voltage_before_1"]
    found = np.empty(SAMPLES)
    for k in range(SAMPLES):
        [found[k]] = system.output(k * 1e-3, x, drive[k : k + 1], {})
        x = system.update(k * 1e-3, x, drive[k : k + 1], {})
    wanted, states = made.simulate({"voltage": drive})
    assert 0.05 < (states["velocity"] == 0.0).mean() < 0.95
    assert np.abs(found - wanted["encoder"]).max() <= CLOSE * np.ptp(wanted["encoder"])


@pytest.mark.study
@pytest.mark.skipif(importlib.util.find_spec("control") is None, reason="python-control (hjcamp[control]) is not installed")
def test_python_control_itself_simulates_the_same(carriage: type[Plant]) -> None:
    import control

    made = module_of(python_file(Exported(Composition(carriage), {"coulomb": 60.0}), "control"))
    drive = volts()
    answer = control.input_output_response(made.system(), np.arange(SAMPLES) * 1e-3, drive[None, :], made.initial())
    wanted, _ = made.simulate({"voltage": drive})
    assert np.abs(np.ravel(answer.outputs) - wanted["encoder"]).max() <= CLOSE * np.ptp(wanted["encoder"])


@pytest.mark.study
@pytest.mark.skipif(
    not all(map(importlib.util.find_spec, ("pythonfmu", "fmpy"))), reason="pythonfmu (hjcamp[fmu]) or fmpy is not installed"
)
@pytest.mark.filterwarnings("ignore")
def test_fmpy_finds_the_fmu_valid_and_simulates_the_same(carriage: type[Plant], tmp_path: Path) -> None:
    import fmpy
    from fmpy.validation import validate_fmu

    exported = Exported(Composition(carriage), {"coulomb": 60.0})
    write_fmu(tmp_path / "carriage.fmu", exported)
    assert validate_fmu(str(tmp_path / "carriage.fmu")) == []
    drive, time = volts(), np.arange(SAMPLES) * 1e-3
    given = np.array(list(zip(time, drive, strict=True)), dtype=[("time", float), ("voltage", float)])
    found = fmpy.simulate_fmu(
        str(tmp_path / "carriage.fmu"),
        stop_time=time[-1],
        output_interval=1e-3,
        step_size=1e-3,
        input=given,
        output=["encoder"],
    )
    wanted, _ = module_of(python_file(exported)).simulate({"voltage": drive})
    assert np.abs(found["encoder"] - wanted["encoder"]).max() <= CLOSE * np.ptp(wanted["encoder"])


def test_without_pythonfmu_one_line_names_it(
    carriage: type[Plant], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "pythonfmu.builder", None)
    assert cli.run(["model", "export", "carriage", "--as", "fmu"]) == 2
    assert "pip install 'hjcamp[fmu]'" in capsys.readouterr().err
    assert not Path("carriage.fmu").exists()


@pytest.mark.parametrize(
    ("formula", "wanted"),
    [
        ("p_a * (s_x - s_y)", r"a \, \left(x - y\right)"),
        ("s_x - (s_y - s_z)", r"x - \left(y - z\right)"),
        ("s_x / (p_tau + 1.0)", r"\frac{x}{\tau + 1}"),
        ("(s_x + s_y)**2", r"\left(x + y\right)^{2}"),
        ("-s_x**2", r"-x^{2}"),
        ("(-s_x)**2", r"\left(-x\right)^{2}"),
        ("-(s_x + s_y)", r"-\left(x + y\right)"),
        ("sqrt(abs(p_head))", r"\sqrt{\left|\mathit{head}\right|}"),
        ("sin(2.0 * s_q) * 1e-06", r"\sin\left(2 \, q\right) \, 10^{-6}"),
        ("limited(s_x, 0.0, p_v_max, 1.0)", r"\operatorname{sat}_{0}^{v_{\mathrm{max}}}\!\left(x\right)"),
        ("p_a if s_x > 0.0 else 0.0", r"\begin{cases} a & x > 0 \\ 0 & \text{else} \end{cases}"),
    ],
)
def test_a_formula_is_written_with_the_brackets_that_it_needs(formula: str, wanted: str) -> None:
    assert latex_formula(formula) == wanted


def test_every_line_of_the_carriage_is_written(carriage: type[Plant]) -> None:
    lines = equations_of(Exported(Composition(carriage)))
    assert r"\dot{\mathit{position}} &= \mathit{velocity}" in lines
    assert all(len(re.findall(r"(?<!\\)[{]", one)) == len(re.findall(r"(?<!\\)[}]", one)) for one in lines)
