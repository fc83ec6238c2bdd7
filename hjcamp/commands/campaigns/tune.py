"""Find PID gains on the simulated rig: by the stability method, by a step test, or again for the cases of a campaign."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hjcamp.campaign.execution.console import bold, make_console
from hjcamp.commands.shared.complete import complete_override
from hjcamp.commands.shared.session import AnswerFile, check_answer_file, write_answer
from hjcamp.errors import UsageError, counted

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.records.plan import Condition, Plan

PIDS = ("plain_pid", "feedforward_pid")


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("tune")(tune)


def tune(
    overrides: Annotated[list[str] | None, typer.Argument(autocompletion=complete_override)] = None,
    name: Annotated[str | None, typer.Option("--as", help="Save as conf/controller/gains/NAME.yaml.")] = None,
    start: Annotated[str, typer.Option("--from", help="With a campaign: the gain set to start from.")] = "simulation",
    step_deg: Annotated[float, typer.Option(min=0.1, help="Step of the stability method, deg.")] = 30.0,
    step: Annotated[
        float | None, typer.Option(help="Another plant's step test: the input, SI; then twice that.", show_default=False)
    ] = None,
    time_ms: Annotated[
        float | None, typer.Option(min=1e-6, help="Step test: the time constant that the loop is to have.", show_default=False)
    ] = None,
    replace: Annotated[bool, typer.Option("--replace", help="Overwrite a gain set that exists.")] = False,
    config_dir: Annotated[Path | None, typer.Option("--config-dir", help="A further folder of groups.")] = None,
    json: AnswerFile = None,
) -> None:
    """Find PID gains on the simulated rig: by the stability method, by a step test, or again for the cases of a campaign.

    Without a campaign: the critical gain and period for a step, and the gains of thesis 5.2.1.3; of another plant
    (plant=NAME) two lags and a delay fitted to a step response, and Skogestad's rules (SIMC). With one: for every
    case (conditions that differ only in their trajectory share one gain set) the gains with the smallest mean RMSE1,
    sought from those of Table 5.3.1 (--from simulation) and written to conf/controller/gains/CASE.yaml.
    """
    from hjcamp.campaign.tuning.gains_file import free_place
    from hjcamp.known_plants import usual_plant

    check_answer_file(json)
    lines = overrides or []
    if any(line.split("=")[0].lstrip("+~") == "campaign" for line in lines):
        if step is not None or time_ms is not None:
            raise UsageError("--step and --time-ms are of a step test: leave the campaign out, or them")
        cases = tune_campaign(lines, name, start, replace, config_dir, make_console())
    elif plant := _other_plant(lines):
        for option, value in (("--step", step), ("--time-ms", time_ms)):
            if value is not None and not (math.isfinite(value) and value):
                raise UsageError(f"{option} {value:g}: a finite number other than 0 is needed")
        if name is not None:
            free_place(name, replace)
        cases = [tune_by_step(lines, plant, name, step or 0.0, 1e-3 * (time_ms or 0.0), replace, config_dir, make_console())]
    else:
        if step is not None or time_ms is not None:
            raise UsageError("--step and --time-ms are of another plant's step test; add plant=NAME, or give --step-deg")
        own = usual_plant().own_room("tune")
        cases = [own.stability_method(lines, name, step_deg, replace, config_dir, make_console())]
    write_answer(json, {"schema": "hjcamp.tuning/1", "cases": cases})


def _other_plant(lines: list[str]) -> str:
    """Return the plant that the overrides name, empty where it is the usual one."""
    from hjcamp.known_plants import DEFAULT

    named = [line.partition("=")[2] for line in lines if line.split("=")[0].lstrip("+") == "plant"]
    return named[-1] if named and named[-1] != DEFAULT else ""


def tune_by_step(
    lines: list[str],
    plant: str,
    name: str | None,
    step: float,
    closed: float,
    replace: bool,
    config_dir: Path | None,
    console: Console,
) -> dict[str, Any]:
    """Print, and save where asked, the gains of a PID by a step test on the simulation of a plant."""
    from hjcamp.campaign.execution.compiling import kernels_of, status
    from hjcamp.campaign.tuning.gains_file import write_gains
    from hjcamp.campaign.tuning.step_test import step_test
    from hjcamp.configuration.check import check_configuration
    from hjcamp.configuration.composer import Composer

    composer = Composer(folder=config_dir)
    laws = [line.partition("=")[2] for line in lines if line.split("=")[0] == "controller"]
    law = laws[-1] if laws else "plain_pid"
    if law not in PIDS:
        raise UsageError(f"controller={law}: a step test gives the gains of a PID: controller={' or controller='.join(PIDS)}")
    kept = [line for line in lines if line.split("=")[0] != "controller"]
    config = composer.compose([*kept, "controller=given"]).config
    check_configuration(config)
    with status(console, kernels_of([config, composer.compose([*kept, f"controller={law}"]).config]), "making a step test"):
        found = step_test(config, law, step, closed)
    lags = found.response
    shape = f"1/tau_1 {lags.leak:.4g} 1/s, tau_2 {lags.lag:.4g} s, delay {lags.delay:.4g} s, k' {lags.slope:.4g}"
    gains = ", ".join(f"{key} {value:.4g}" for key, value in found.gains.items())
    source = [
        f"Made by: hjcamp tune {' '.join(lines)}" + (f" --as {name}" if name else ""),
        f"Step test on the simulation of {plant}: input {found.step:g} -> {2.0 * found.step:g} (SI), {found.seconds:.4g} s; {shape},",
        f"which leaves {100.0 * lags.left:.2g} % of the response. SIMC (Skogestad 2003) with tau_c {1e3 * found.closed:.4g} ms;",
        f"the simulated loop goes {100.0 * found.overshoot:.2g} % beyond a step of its reference.",
    ]
    for line in source[1:]:
        console.print(f"  {line}", markup=False, soft_wrap=True)
    console.print(f"  {gains}", markup=False, soft_wrap=True)
    path = write_gains(name, found.gains, source, replace) if name is not None else None
    use = (
        f"controller={law} +controller/gains={name}"
        if path
        else " ".join([f"controller={law}", *(f"controller.{key}={value:g}" for key, value in found.gains.items())])
    )
    console.print(f"  {f'saved   {path}: ' if path else ''}use {use}", markup=False, soft_wrap=True)
    response = {"slope": lags.slope, "leak_per_s": lags.leak, "lag_s": lags.lag, "delay_s": lags.delay, "left": lags.left}
    return {
        "case": name, "method": "step", "step": found.step, "seconds": found.seconds, "response": response, "closed_s": found.closed,
        "overshoot": found.overshoot, "gains": found.gains, "file": str(path) if path else None,
    }  # fmt: skip


def tune_campaign(
    lines: list[str], name: str | None, start: str, replace: bool, config_dir: Path | None, console: Console
) -> list[dict[str, Any]]:
    """Tune the gains of every case of a campaign and save them."""
    from hjcamp.commands.campaigns.plan import compose_plan
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
