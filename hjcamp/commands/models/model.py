"""Take a model along: its equations, values and integrator as one file for Python, python-control, FMI, MuJoCo or LaTeX."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from hjcamp.commands.shared.session import AnswerFile, check_answer_file, write_answer
from hjcamp.errors import UsageError, unknown
from hjcamp.storage import check_place, write_whole

SUFFIXES = {"python": ".py", "control": ".py", "latex": ".tex", "fmu": ".fmu", "mujoco": ".xml"}
USAGE = "hjcamp model export PLANT_OR_MODEL --as python|control|latex|fmu|mujoco [--model M | --run RUN] [--into FILE]"


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("model")(model)


def model(
    words: Annotated[list[str], typer.Argument(metavar="export PLANT_OR_MODEL", help="A plant, or a model of conf/model.")],
    kind: Annotated[
        str, typer.Option("--as", help="python (numpy alone), control (python-control), latex, fmu (FMI 2.0) or mujoco (MJCF).")
    ] = "python",
    saved: Annotated[str, typer.Option("--model", help="A saved model of the plant.", show_default=False)] = "",
    run: Annotated[
        Path | None, typer.Option(help="A run folder or a diagnosis: the model that it has.", show_default=False)
    ] = None,
    condition: Annotated[str, typer.Option(help="With --run: the condition whose model is meant.", show_default=False)] = "",
    into: Annotated[Path | None, typer.Option(help="The file to write; NAME and the usual suffix by default.")] = None,
    json: AnswerFile = None,
) -> None:
    """Take a model along: its equations, values and integrator as one file for Python, python-control, FMI, MuJoCo or LaTeX."""
    if len(words) != 2 or words[0] != "export":
        raise UsageError(f"{USAGE}: give 'export' and one name")
    if kind not in SUFFIXES:
        raise unknown("kind", kind, SUFFIXES, "--as")
    if condition and run is None:
        raise UsageError("--condition is one of a run's: give --run with it")
    check_answer_file(json)
    path = into or Path(f"{words[1]}{'_control' if kind == 'control' else ''}{SUFFIXES[kind]}")
    if path.suffix != SUFFIXES[kind]:
        raise UsageError(f"--into {path}: a file of kind {kind} ends in {SUFFIXES[kind]}")
    if kind not in ("latex", "mujoco") and not path.stem.isidentifier():
        raise UsageError(
            f"--into {path}: what is imported has a name of letters, digits and _, such as {words[1]}{SUFFIXES[kind]}"
        )
    check_place(path, "--into")
    write_answer(json, export(words[1], kind, saved, run, condition, path))


def export(name: str, kind: str, saved: str, run: Path | None, condition: str, path: Path) -> dict[str, object]:
    """Write the file, say what is in it, and return the answer for programs."""
    from hjcamp.analyses.exporting import model_to_export
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.model.export.equations import latex_file
    from hjcamp.model.export.fmu_file import write_fmu
    from hjcamp.model.export.joint_values import mapped
    from hjcamp.model.export.mujoco_file import mujoco_file
    from hjcamp.model.export.python_file import python_file

    exported = model_to_export(name, saved, run, condition)
    joints = mapped(exported) if kind == "mujoco" else None
    if joints:
        write_whole(path, mujoco_file(exported, joints))
    elif kind == "fmu":
        write_fmu(path, exported)
    else:
        write_whole(path, latex_file(exported) if kind == "latex" else python_file(exported, kind))
    console = make_console()
    console.print(f"written  {path}: {exported.title}", markup=False, soft_wrap=True)
    said = ", ".join(f"{one} = {exported.readings[one][0]}" for one in exported.readings)
    console.print(f"         inputs {', '.join(exported.given) or 'none'}; readings {said}", markup=False, soft_wrap=True)
    if lacks := exported.source.get("lacks"):
        console.print(f"         without {lacks}", markup=False, soft_wrap=True)
    for sentence in joints.lost if joints else ():
        console.print(f"         not expressed: {sentence}", markup=False, soft_wrap=True)
    use = {
        "python": f"python {path}; from {path.stem} import simulate",
        "control": f"from {path.stem} import system, initial",
        "latex": f"pdflatex {path}",
        "fmu": f"fmpy info {path}",
        "mujoco": f"python -m mujoco.viewer --mjcf={path}",
    }
    console.print(f"next     {use[kind]}", markup=False, soft_wrap=True)
    return {
        "schema": "hjcamp.model_file/1",
        "plant": exported.composition.plant.name,
        "as": kind,
        "file": str(path),
        "effects": [one.name for one in exported.composition.effects],
        "parameters": {key: value if abs(value) < float("inf") else None for key, value in exported.parameters.items()},
        "inputs": exported.given,
        "readings": {key: one[0] for key, one in exported.readings.items()},
        "source": dict(exported.source),
        **({"joints": [asdict(one) for one in joints.joints], "not_expressed": list(joints.lost)} if joints else {}),
    }
