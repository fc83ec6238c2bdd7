"""What costs how much: each part of the rig halved or each effect removed, gains tuned again, errors before and after."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hjcamp.commands.shared.session import AnswerFile, check_answer_file, check_picture, write_answer
from hjcamp.errors import UsageError

if TYPE_CHECKING:
    from hjcamp.plants.pump_joint.studies.budget import Item


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("budget")(budget)


def budget(
    overrides: Annotated[
        list[str] | None,
        typer.Argument(metavar="[OVERRIDE...]", help="As for run: trajectory=, controller=, model= ...", show_default=False),
    ] = None,
    share: Annotated[float, typer.Option(min=0.05, max=0.95, help="Remaining share of each part.")] = 0.5,
    repetitions: Annotated[int, typer.Option(min=1, max=100, help="Simulated tests of each part.")] = 7,
    seed: Annotated[int, typer.Option(help="Every random number follows from it.")] = 1,
    keep_gains: Annotated[bool, typer.Option("--keep-gains", help="Do not tune the gains again: faster.")] = False,
    json_file: AnswerFile = None,
    figure: Annotated[Path, typer.Option(help="Where the bars go (png, svg, pdf).")] = Path("budget.png"),
) -> None:
    """What costs how much: each part of the rig halved or each effect removed, gains tuned again, errors before and after."""
    from hjcamp.analyses.diagnosing import check_seed
    from hjcamp.campaign.execution.compiling import Doing, kernels_of, status
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.commands.campaigns.plan import compose_plan
    from hjcamp.plants.pump_joint.figures.budget import draw_budget
    from hjcamp.plants.pump_joint.studies.budget import budget as work
    from hjcamp.plants.pump_joint.studies.retune import gains_of

    check_seed(seed)
    check_picture(figure)
    check_answer_file(json_file)
    plan = compose_plan(overrides or [])
    if len(plan.conditions) != 1:
        raise UsageError(f"a budget is of one test, not of {len(plan.conditions)}: conditions=NAME chooses one of the campaign")
    (condition,) = plan.conditions
    if other := condition.config.get("plant"):
        raise UsageError(f"plant {other['name']}: a budget knows the parts of pump_joint alone")
    if not keep_gains:
        gains_of(condition.config, f"condition '{condition.name}' (--keep-gains does without)")
    console, doing = make_console(), Doing("counting")
    with status(console, kernels_of([condition.config]), doing):
        items = work(
            condition,
            share,
            repetitions,
            seed,
            not keep_gains,
            lambda name, done: doing.now(f"{done:.0%} done, {name}"),
        )
    if items[0].problem:
        raise UsageError(f"the rig as it is cannot be simulated: {items[0].problem}")
    _print(condition.name, items, share)
    shown = [("as it is", items[0].best), *((one.name, one.best) for one in items[1:] if not one.problem)]
    draw_budget(figure, f"{condition.name}: each part down to {share:g}", shown)
    console.print(f"  picture  {figure}", markup=False, soft_wrap=True)
    write_answer(
        json_file,
        {
            "schema": "hjcamp.budget/1",
            "condition": condition.name,
            "share": share,
            "seed": seed,
            "rows": [_row(one) for one in items],
        },
    )


def _row(one: Item) -> dict[str, Any]:
    def told(errors: Any) -> dict[str, Any] | None:
        if not len(errors):
            return None
        spread = errors.std(axis=0, ddof=1).tolist() if len(errors) > 1 else [None, None]
        mean = errors.mean(axis=0).tolist()
        return {
            "rmse1_deg_mean": mean[0],
            "rmse1_deg_std": spread[0],
            "e_max_deg_mean": mean[1],
            "e_max_deg_std": spread[1],
            "n": len(errors),
        }

    return {
        "part": one.name,
        "gains_kept": told(one.kept),
        "gains_retuned": told(one.retuned),
        "problem": one.problem or None,
    }


def _print(name: str, items: list[Item], share: float) -> None:
    from rich.table import Table

    from hjcamp.campaign.execution.console import make_console
    from hjcamp.report.tables.sheet import with_deviation

    table = Table(title=f"{name}: each part down to {share:g} of what it is", title_justify="left", box=None, pad_edge=False)
    headings = ("part made better", "RMSE1, gains kept", "RMSE1, tuned again", "|e|max, best", "change")
    for heading in headings:
        table.add_column(heading, justify="left" if heading == headings[0] else "right")

    def cell(errors: Any, column: int) -> str:
        if not len(errors):
            return "–"
        return with_deviation(
            float(errors[:, column].mean()), float(errors[:, column].std(ddof=1)) if len(errors) > 1 else None, 2
        )

    before = float(items[0].best[:, 0].mean())
    for one in items:
        change = "" if one is items[0] or one.problem else f"{100 * (float(one.best[:, 0].mean()) / before - 1):+.0f} %"
        table.add_row(one.name, cell(one.kept, 0), cell(one.retuned, 0), cell(one.best, 1), one.problem or change)
    console = make_console()
    console.print(table)
    text = "deg, mean ± deviation of the repetitions; smallest RMSE1 first; change against the rig as it is ('nothing')"
    console.print(f"  {text}", style="dim", markup=False)
