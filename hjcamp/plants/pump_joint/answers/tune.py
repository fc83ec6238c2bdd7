"""`hjcamp tune` for the joint: PID gains by the stability method, or anew for the cases of a campaign."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.campaign.execution.console import bold
from hjcamp.errors import UsageError

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.plants.pump_joint.studies.retune import Retuned
    from hjcamp.records.plan import Condition, Plan

SIDES = (("positive", 1.0), ("negative", -1.0))


def stability_method(
    lines: list[str], name: str | None, step_deg: float, replace: bool, config_dir: Path | None, console: Console
) -> dict[str, Any]:
    """Print, and save where asked, the gains that follow from the critical point of each direction."""
    from hjcamp.campaign.execution.compiling import kernels_of, status
    from hjcamp.campaign.plan.planning import make_plan
    from hjcamp.campaign.tuning.gains_file import free_place, write_gains
    from hjcamp.configuration.composer import Composer, free
    from hjcamp.plants.pump_joint.studies.critical_gain import critical_point

    if name is not None:
        free_place(name, replace)
    composer = Composer(folder=config_dir)
    given = [free(line) for line in lines]
    asked = composer.compose(given)
    # The plan checks every value and the controller; the one test that it describes is not run.
    make_plan(asked.config, None, given, composer)
    points = {}
    kernels = kernels_of([composer.compose([*given, "controller=pid"]).config])
    for side, sign in SIDES:
        with status(console, kernels, f"looking for the critical gain, {side} steps"):
            points[side] = critical_point(composer, given, sign * step_deg)
    gains = {side: point.pid_gains() for side, point in points.items()}
    console.print(f"Stability method on the simulated rig, step of {step_deg:g} deg (thesis 5.2.1.3)", markup=False)
    for side, point in points.items():
        text = ", ".join(f"{key} {value:.4g}" for key, value in gains[side].items())
        console.print(f"  {side}   critical gain {point.gain:.3g}, period {1e3 * point.period:.1f} ms   ->   {text}")
    path = None
    if name is not None:
        call = " ".join(["hjcamp tune", *lines, f"--step-deg {step_deg:g}", f"--as {name}"])
        found = ", ".join(f"{side} {point.gain:.3g} and {1e3 * point.period:.1f} ms" for side, point in points.items())
        source = [
            "First gains by the stability method (thesis 5.2.1.3), before any tuning by hand.",
            f"Critical gain and period on the simulated rig: {found}.",
            f"Made by: {call}",
        ]
        path = write_gains(name, gains, source, replace)
        console.print(f"  saved   {path}: use controller/gains={name}", markup=False)
    critical = {side: {"gain": point.gain, "period_s": point.period} for side, point in points.items()}
    told = {"method": "stability", "step_deg": step_deg, "critical": critical, "gains": gains}
    return {"case": name, **told, "file": str(path) if path else None}


def tune_campaign(
    plan: Plan, lines: list[str], name: str | None, start: str, replace: bool, config_dir: Path | None, console: Console
) -> list[dict[str, Any]]:
    """Tune the gains of every case of a campaign and save them."""
    from hjcamp.campaign.tuning.gains_file import free_place, write_gains
    from hjcamp.commands.campaigns.tune import cases_of, told_of
    from hjcamp.configuration.check import check_configuration
    from hjcamp.configuration.composer import Composer
    from hjcamp.plants.pump_joint.studies.retune import FACTOR, gains_of

    config = Composer(folder=config_dir).compose([f"controller/gains={start}"]).config
    check_configuration(config, f"--from {start}")
    first = gains_of(config, f"--from {start}")
    cases = cases_of(plan)
    if name is not None and len(cases) > 1:
        raise UsageError(f"--as names one gain set, but there are {len(cases)} cases: {', '.join(cases)}")
    named = {name or case: conditions for case, conditions in cases.items()}
    for case, conditions in named.items():
        for condition in conditions:
            gains_of(condition.config, f"condition '{condition.name}'")
        free_place(case, replace)
    told = []
    for case, conditions in named.items():
        console.print(bold(case, f"   {', '.join(one.name for one in conditions)}"))
        result = search(conditions, first, plan.seed, console)
        source = [
            f"Tuned by: hjcamp tune {' '.join(lines)} (campaign '{plan.campaign}', seed {plan.seed})",
            f"Smallest mean RMSE1 over {', '.join(result.conditions)}, simulated without scatter: "
            f"{result.before:.4f} -> {result.after:.4f} deg.",
            f"{result.evaluations} evaluations of a seeded search, each gain between 1/{FACTOR:g} and {FACTOR:g} times "
            f"its value in controller/gains={start}: {_shown(result.start)}.",
        ]
        path = write_gains(case, result.gains, source, replace)
        console.print(f"  mean RMSE1 {result.before:.4f} -> {result.after:.4f} deg, {result.evaluations} evaluations")
        console.print(f"  {_shown(result.gains)}", markup=False)
        console.print(f"  saved   {path}: use controller/gains={case}", markup=False)
        told.append(told_of(case, result, "deg", result.gains, path))
    return told


def search(conditions: list[Condition], first: Mapping[str, Mapping[str, float]], seed: int, console: Console) -> Retuned:
    """Return the gains found for conditions that share them; says on a terminal how far the search is."""
    from hjcamp.campaign.execution.compiling import Doing, kernels_of, status
    from hjcamp.plants.pump_joint.studies.retune import retune

    doing = Doing("searching")
    with status(console, kernels_of(one.config for one in conditions), doing):
        return retune(conditions, first, seed, lambda best: doing.now(f"searching, mean RMSE1 {best:.4f} deg"))


def _shown(gains: Mapping[str, Mapping[str, float]]) -> str:
    return "; ".join(
        f"{side} " + ", ".join(f"{key} {value:.4g}" for key, value in group.items()) for side, group in gains.items()
    )
