"""``import hjcamp`` does what the commands do: every example runs, the notebook too, and refusals have the commands' words."""

from __future__ import annotations

import doctest
import inspect
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from matplotlib.figure import Figure

import hjcamp
from hjcamp import cli, notebook
from hjcamp.errors import HjcampError, UsageError
from hjcamp.notebook.any_command import COMMANDS, _typed
from hjcamp.records.log import TestLog
from hjcamp.records.write import write_log

NOTEBOOK = Path(__file__).parents[2] / "docs" / "notebook.ipynb"


@pytest.mark.study
def test_every_example_runs(stage: Path) -> None:
    finder, flags = doctest.DocTestFinder(recurse=False), doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    runner = doctest.DocTestRunner(optionflags=flags)
    for name in notebook.__all__:
        function = getattr(notebook, name)
        assert inspect.signature(function).return_annotation, name
        [example] = finder.find(function, name, globs={"hjcamp": hjcamp})
        assert example.examples, f"hjcamp.{name} has no example"
        told: list[str] = []
        assert runner.run(example, out=told.append).failed == 0, "".join(told)


def test_the_notebook_runs(samples: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(samples.parent)
    monkeypatch.delenv("HJCAMP_CONF", raising=False)
    cells = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]
    names: dict[str, object] = {}
    for cell in cells:
        if cell["cell_type"] == "code":
            exec(compile("".join(cell["source"]), str(NOTEBOOK), "exec"), names)
    found, model, both = names["found"], names["model"], names["both"]
    assert found.effects == ["spring"] and model.helps
    assert both.scores["with_spring"] < 0.5 * both.scores["published"]
    [stiffness] = model.frame.filter(pl.col("parameter") == "stiffness")["value"]
    assert stiffness == pytest.approx(140.0, rel=0.1)
    page = found._repr_html_()
    assert "spring" in page and "<table>" in page and "&lt;" not in found.title
    assert isinstance(found.plot(), Figure) and found.plot()._repr_png_()[:4] == b"\x89PNG"
    assert found.page("diagnose").name == "index.html" and both.page("compare").is_file()


def test_the_answer_is_that_of_the_command(stage: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["compare", "logs", "--json", "-"]) == 0
    told = json.loads(capsys.readouterr().out)
    heard: list[float] = []
    found = hjcamp.compare("logs", progress=lambda text, share: heard.append(share))
    assert found.answer == told and len(heard) > 2 and 0.0 <= min(heard) <= max(heard) <= 1.0
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: hjcamp.load("nowhere"), ["compare", "nowhere"]),
        (lambda: hjcamp.load(), None),
        (lambda: hjcamp.compare("logs", model="publish"), ["compare", "logs", "--model", "publish"]),
        (lambda: hjcamp.compare("logs", model=["published"] * 2), ["compare", "logs", *["--model", "published"] * 2]),
        (lambda: hjcamp.diagnose("logs", only="sprong"), ["diagnose", "logs", "--only", "sprong"]),
        (lambda: hjcamp.diagnose("logs", seed=-1), ["diagnose", "logs", "--seed", "-1"]),
        (lambda: hjcamp.add("spring", "logs", as_="published"), ["add", "spring", "logs", "--as", "published"]),
        (lambda: hjcamp.plan("campaign=robustnes_vertical"), ["plan", "campaign=robustnes_vertical"]),
        (lambda: hjcamp.simulate("controller=pidd"), ["run", "controller=pidd"]),
        (lambda: hjcamp.plants("stag"), ["plants", "stag"]),
        (lambda: hjcamp.add([], "logs", as_="x"), None),
        (lambda: hjcamp.simulate("backend=nidaqmx", "rig=virtual", repetitions=1), None),
        (lambda: hjcamp.simulate("seed=1,2"), None),
        (lambda: hjcamp.load("logs").samples("trein"), None),
        (lambda: hjcamp.load("logs").samples(7), None),
    ],
)
def test_a_refusal_has_the_words_of_the_command(
    stage: Path, capsys: pytest.CaptureFixture[str], call: object, words: list[str] | None
) -> None:
    before = sorted(map(str, stage.rglob("*")))
    with pytest.raises(UsageError) as error:
        call()  # type: ignore[operator]
    if words is not None:
        capsys.readouterr()
        assert cli.run(words) == 2
        assert str(error.value) in capsys.readouterr().err
    assert sorted(map(str, stage.rglob("*"))) == before


def test_frames_go_to_pandas_where_it_is(stage: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = hjcamp.load("logs")
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(HjcampError, match="pip install pandas"):
        data.to_pandas()


def test_a_table_goes_to_pandas(stage: Path) -> None:
    pytest.importorskip("pandas", reason="pandas is no dependency; its frames are tested where it is there")
    data = hjcamp.load("logs")
    assert data.to_pandas().to_dict("records") == data.frame.to_dicts()


def test_samples_and_picture_of_a_test(stage: Path) -> None:
    data = hjcamp.load(stage / "logs")
    assert len(data) == 1 and data.plant.name == "stage"
    [name] = data.frame["test"]
    frame = data.samples(name)
    np.testing.assert_array_equal(frame["position_m"].to_numpy(), data.logs[0].columns["position_m"])
    assert len(data.plot(name).axes) == 2


def test_a_simulated_campaign_of_the_pump_joint(empty_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import hjcamp.backends

    def run_test(config: dict, seed: int) -> tuple[dict[str, np.ndarray], dict[str, str]]:
        time, line = np.arange(300) * 1e-3, np.full(300, 0.3)
        error = 1.0 + 0.1 * seed % 1
        columns = {"time_s": time, "phase": np.full(300, 3.0), "reference_deg": 60 * time, "arm_deg": 60 * time - error}
        return columns | {"pressure1_mpa": line, "pressure2_mpa": line, "pump_deg": 510 * time}, {}

    monkeypatch.setattr(hjcamp.backends, "run_test", run_test)
    made = hjcamp.simulate("campaign=robustness_vertical", "trajectory=sine_0p5hz", repetitions=2, workers=1, run_dir="one")
    assert made.path == Path("one") and made.page.is_file() and made.frame.height == 4
    assert sorted(made.frame["rmse1_deg"]) == sorted(made.data.indicators["rmse1_deg"])
    assert len(made.plot().axes) == 1 and made._repr_html_().count("<tr>") == 5
    assert hjcamp.report("one").frame.equals(made.frame)
    assert hjcamp.resume("one").frame.equals(made.frame)
    assert hjcamp.runs("campaign=robustness_vertical", folder=".").frame["run"].to_list() == ["one"]
    with pytest.raises(UsageError, match="did you mean 'rmse1_deg'"):
        made.plot("rmse1_dg")


def test_importing_is_light_and_packages_stay_packages() -> None:
    code = (
        "import sys, hjcamp; heavy = {'numpy', 'polars', 'matplotlib', 'hydra', 'typer'} & set(sys.modules);"
        "assert not heavy, heavy; assert 'effects' in dir(hjcamp);"
        "import hjcamp.effects as package; assert package.load_effects and package is hjcamp.effects is sys.modules['hjcamp.effects'];"
        "assert callable(hjcamp.effects) and callable(hjcamp.plants) and callable(hjcamp.calibrate) and callable(hjcamp.report);"
        "assert hjcamp.effects().frame.height > 20; assert hjcamp.effects is package;"
        "print(getattr(hjcamp, 'efects', 'nothing'))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stdout.strip()) == (0, "nothing"), done.stderr


def three_tests(folder: Path) -> hjcamp.Data:
    """Return the logs up/1, up/2 and down/1, of which the last has a field more."""
    time = np.arange(200) * 1e-3
    for name, condition, repetition, further in (
        ("a", "up", "1", {}),
        ("b", "up", "2", {}),
        ("c", "down", "1", {"dither_v": time}),
    ):
        columns = {"time_s": time, "phase": np.full(200, 3.0), "arm_deg": time, **further}
        lines = {"pressure1_mpa": time + 0.2, "pressure2_mpa": time + 0.3, "pump_deg": time}
        write_log(folder / f"{name}.mcap", TestLog(columns | lines, {"condition": condition, "repetition": repetition}))
    return hjcamp.load(folder)


def test_the_samples_of_many_tests_are_one_long_frame(tmp_path: Path) -> None:
    data = three_tests(tmp_path)
    assert sorted(data.frame["repetition"]) == [1, 1, 2]
    up, every = data.samples(condition="up"), data.samples(condition="*")
    assert up.columns[:3] == ["test", "condition", "repetition"] and up.height == 400 and set(up["repetition"]) == {1, 2}
    assert every.height == 600 and every["dither_v"].null_count() == 400 and data.samples(0).height == 200
    for name in data.frame["test"]:
        assert every.filter(pl.col("test") == name)["arm_deg"].equals(data.samples(name)["arm_deg"])
    with pytest.raises(UsageError, match="unknown condition 'upp'; did you mean 'up'"):
        data.samples(condition="upp")


@pytest.mark.parametrize(
    ("chosen", "names"),
    [
        (0, ["up/1"]),
        (-1, ["down/1"]),
        (slice(1, None), ["up/2", "down/1"]),
        ("up", ["up/1", "up/2"]),
        ("u*", ["up/1", "up/2"]),
        ("up/2", ["up/2"]),
        ("*/1", ["up/1", "down/1"]),
        ("*", ["up/1", "up/2", "down/1"]),
        ("upp", UsageError),
        (3, UsageError),
        (slice(3, None), UsageError),
    ],
)
def test_some_tests_are_data_again(tmp_path: Path, chosen: int | slice | str, names: list[str] | type[Exception]) -> None:
    data = three_tests(tmp_path)
    if not isinstance(names, list):
        with pytest.raises(names):
            data[chosen]
        return
    found = data[chosen]
    assert found.frame["test"].to_list() == names and len(found) == len(names)
    assert found.samples(names[-1]).equals(data.samples(names[-1])) and found.plant_name == data.plant_name
    assert found.logs[0] is data.logs[list(data.frame["test"]).index(names[0])]


def test_data_is_gone_through_test_by_test(tmp_path: Path) -> None:
    data = three_tests(tmp_path)
    assert [test.frame["test"].to_list() for test in data] == [["up/1"], ["up/2"], ["down/1"]]
    assert data[1:][0].frame["test"].to_list() == ["up/2"]


def test_commands_without_a_function_of_their_own_are_functions_that_say_and_answer(stage: Path) -> None:
    said = hjcamp.explain("floor")
    assert said.text.startswith("  noise floor: ") and said.answer is not None and list(said.answer["words"]) == ["noise floor"]
    made = hjcamp.export("logs", into="tables")
    assert made.answer is not None and made.answer["files"] == ["tables/train.parquet"] and "tables/train.parquet" in made.text
    with pytest.raises(UsageError, match="hjcamp explain --help"):
        hjcamp.explain("floor", colour=True)
    for name, words in COMMANDS.items():
        function = getattr(hjcamp, name)
        assert name in dir(hjcamp) and function.__name__ == name and f"hjcamp {' '.join(words)}" in function.__doc__
    assert _typed({"all": True, "workers": 2, "model": ["a", "b"], "as_": "x", "seed": None, "json": False}) == [
        "--all", "--workers", "2", "--model", "a", "--model", "b", "--as", "x",
    ]  # fmt: skip


@pytest.mark.parametrize("name", ["effects", "plants", "report"])
def test_a_called_package_has_the_documentation_of_its_function(name: str) -> None:
    function = getattr(notebook, name)
    assert getattr(hjcamp, name).__doc__ == function.__doc__ and inspect.signature(getattr(hjcamp, name)) == inspect.signature(
        function
    )
    assert not {"sys", "types", "importlib"} & set(dir(hjcamp))


def test_a_slider_simulates_again(stage: Path) -> None:
    found = hjcamp.compare("logs")
    low, high, step = found.sliders["mass"]
    calibrated = found.found.analysis.base.fitted.candidate.base["mass"]
    assert (low, high) == pytest.approx((0.5 * calibrated, 1.5 * calibrated)) and step == pytest.approx((high - low) / 200.0)
    assert {"mass", "coulomb", "viscous"} <= set(found.sliders)
    curves = {line.get_label(): line.get_ydata() for line in found.plot(mass=high).axes[0].lines}
    same = {line.get_label(): line.get_ydata() for line in found.plot(mass=calibrated).axes[0].lines}
    assert len(curves) == len(found.plot().axes[0].lines) + 1
    moved, stays = (np.nanmax(np.abs(np.subtract(one["with these values"], one["calibrated here"]))) for one in (curves, same))
    assert moved > 10.0 * stays
    with pytest.raises(UsageError, match="did you mean 'mass'"):
        found.plot(mas=1.0)
