"""Find PID gains on the simulated rig: by the stability method, or again for the cases of a campaign."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hjcamp.campaign.execution.console import bold
from hjcamp.commands.shared.complete import complete_override
from hjcamp.commands.shared.session import AnswerFile
from hjcamp.errors import UsageError, counted

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.records.plan import Condition, Plan


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("tune")(tune)


def tune(
    overrides: Annotated[list[str] | None, typer.Argument(autocompletion=complete_override)] = None,
    name: Annotated[str | None, typer.Option("--as", help="Save as conf/controller/gains/NAME.yaml.")] = None,
    start: Annotated[str, typer.Option("--from", help="With a campaign: the gain set to start from.")] = "simulation",
    step_deg: Annotated[float, typer.Option(min=0.1, help="Step of the stability method, deg.")] = 30.0,
    replace: Annotated[bool, typer.Option("--replace", help="Overwrite a gain set that exists.")] = False,
    config_dir: Annotated[Path | None, typer.Option("--config-dir", help="A further folder of groups.")] = None,
    json: AnswerFile = None,
) -> None:
    """Find PID gains on the simulated rig: by the stability method, or again for the cases of a campaign.

    Without a campaign: the critical gain and period for a step, and the gains of thesis 5.2.1.3. With one: for every
    case (conditions that differ only in their trajectory share one gain set) the gains with the smallest mean RMSE1,
    sought from those of Table 5.3.1 (--from simulation) and written to conf/controller/gains/CASE.yaml.
    """
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.commands.shared.session import check_answer_file, write_answer
    from hjcamp.known_plants import usual_plant

    check_answer_file(json)
    lines = overrides or []
    if any(line.split("=")[0].lstrip("+~") == "campaign" for line in lines):
        cases = tune_campaign(lines, name, start, replace, config_dir, make_console())
    else:
        own = usual_plant().own_room("tune")
        cases = [own.stability_method(lines, name, step_deg, replace, config_dir, make_console())]
    write_answer(json, {"schema": "hjcamp.tuning/1", "cases": cases})


def tune_campaign(
    lines: list[str], name: str | None, start: str, replace: bool, config_dir: Path | None, console: Console
) -> list[dict[str, Any]]:
    """Tune the gains of every case of a campaign and save them."""
    from hjcamp.commands.plan import compose_plan
    from hjcamp.known_plants import plant_of

    plan = compose_plan(lines, config_dir)
    room = plant_of(plan.conditions[0].config).room_of("tune")
    if room is None:
        return tune_laws(plan, lines, name, replace, console)
    return list(room.tune_campaign(plan, lines, name, start, replace, config_dir, console))


def told_of(case: str, result: Any, unit: str, gains: Mapping[str, Any], path: Path) -> dict[str, Any]:
    """Return a case for programs: what was found, by how much the error falls, where it is kept."""
    return {
        "case": case, "method": "search", "conditions": list(result.conditions), "mean_error_before": result.before,
        "mean_error_after": result.after, "unit": unit, "evaluations": result.evaluations, "gains": dict(gains), "file": str(path),
    }  # fmt: skip


def tune_laws(plan: Plan, lines: list[str], name: str | None, replace: bool, console: Console) -> list[dict[str, Any]]:
    """Tune the controllers of a campaign of another plant, one parameter set for each case, and save them."""
    from hjcamp.campaign.execution.compiling import Doing, kernels_of, status
    from hjcamp.campaign.tuning.gains_file import free_place, write_gains
    from hjcamp.campaign.tuning.retune_law import FACTOR, retune_law

    cases = cases_of(plan)
    if name is not None and len(cases) > 1:
        raise UsageError(f"--as names one gain set, but there are {len(cases)} cases: {', '.join(cases)}")
    plant = plan.conditions[0].config["plant"]["name"]
    named = {name or f"{plant}_{case}": conditions for case, conditions in cases.items()}
    for case in named:
        free_place(case, replace)
    told = []
    for case, conditions in named.items():
        console.print(bold(case, f"   {', '.join(one.name for one in conditions)}"))
        doing = Doing("searching for the smallest mean error")
        with status(console, kernels_of(one.config for one in conditions), doing):
            result = retune_law(conditions, plan.tests, plan.seed)
        each = counted(plan.repetitions, "test")
        source = [
            f"Tuned by: hjcamp tune {' '.join(lines)} (campaign '{plan.campaign}', seed {plan.seed})",
            f"Smallest mean RMSE over {', '.join(result.conditions)}, simulated with scatter, {each} each, SI: "
            f"{result.before:.5g} -> {result.after:.5g}.",
            f"{result.evaluations} evaluations of a seeded search, each between 1/{FACTOR:g} and {FACTOR:g} times its start: "
            + ", ".join(f"{key} {value:.4g}" for key, value in result.start.items())
            + ".",
        ]
        path = write_gains(case, result.found, source, replace)
        console.print(f"  mean error {result.before:.5g} -> {result.after:.5g} (SI), {result.evaluations} evaluations")
        console.print(f"  {', '.join(f'{key} {value:.4g}' for key, value in result.found.items())}", markup=False)
        console.print(f"  saved   {path}: use controller/gains={case}", markup=False)
        told.append(told_of(case, result, "SI", result.found, path))
    return told


def cases_of(plan: Plan) -> dict[str, list[Condition]]:
    """Return the conditions that differ only in their trajectory, by the name of what they share."""
    cases: dict[str, list[Condition]] = {}
    for condition in plan.conditions:
        labels = condition.name.split("__")
        if len(labels) == len(plan.axes):
            labels = [label for label, axis in zip(labels, plan.axes, strict=True) if axis != "trajectory"]
        cases.setdefault("__".join(labels) or plan.campaign, []).append(condition)
    return cases
