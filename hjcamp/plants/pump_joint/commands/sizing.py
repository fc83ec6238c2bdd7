"""The formulas of chapter 3 next to the print; whether this joint can do a task, and which limit stops it; figures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hjcamp.commands.shared.session import AnswerFile, check_answer_file, write_answer
from hjcamp.errors import UsageError, unknown
from hjcamp.storage import check_place

if TYPE_CHECKING:
    from hjcamp.plants.pump_joint.sizing.capability import Friction, Joint

USAGE = "hjcamp sizing | sizing capability torque_mnm=20 range_deg=180 diameter_mm=15 | sizing figures [OVERRIDE...]"
#: The joint as measured last, as measured first, and as thesis 5.6 would have it.
FRICTIONS = {"bidirectional": "worn", "first_state": "first state", "reduced": "reduced"}
#: What the figure of the load shows where no other payload is named: that of thesis 5.5.
PAYLOAD = ("payload=brass_8p5g", "orientation=vertical")
SCALE = {"MPa": 1e-6, "mm": 1e3}


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("sizing")(sizing)


def sizing(
    words: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[capability KEY=NUMBER... [OVERRIDE...] | figures [OVERRIDE...]]",
            help="A question, or the figures; none for the table of formulas.",
            show_default=False,
        ),
    ] = None,
    json_file: AnswerFile = None,
    output: Annotated[Path, typer.Option(help="With figures: the folder for them.")] = Path("sizing"),
) -> None:
    """The formulas of chapter 3 next to the print; whether this joint can do a task, and which limit stops it; figures."""
    match words or []:
        case []:
            check_answer_file(json_file)
            write_answer(json_file, show_formulas())
        case ["capability", *lines]:
            check_answer_file(json_file)
            write_answer(json_file, answer_question(lines))
        case ["figures", *lines] if json_file is None:
            draw(output, lines)
        case ["figures", *_]:
            raise UsageError(f"figures gives no answer for --json: {USAGE}")
        case [word, *_]:
            raise unknown("word", word, ("capability", "figures"), "hjcamp sizing")


def show_formulas() -> dict[str, Any]:
    """Print every quantity next to what the thesis prints; returns the answer for programs."""
    from rich.table import Table

    from hjcamp.campaign.execution.console import make_console
    from hjcamp.plants.pump_joint.sizing.reference import decimals, quantities
    from hjcamp.report.wording.units import plain

    found = quantities()
    table = Table(box=None, header_style="bold", pad_edge=False)
    for heading in ("quantity", "value", "unit", "thesis", "place"):
        table.add_column(heading, justify="right" if heading in ("value", "thesis") else "left")
    for part in dict.fromkeys(one.part for one in found):
        table.add_section()
        for one in (one for one in found if one.part == part):
            digits = decimals(one.printed) if one.printed else 0
            value = f"{one.value:.{digits}f}" if one.relation == "=" and one.printed else plain(one.value, 4)
            sign = {"=": "", ">": "more than ", "measured": "measured "}[one.relation]
            off = " ✗" if one.agrees() is False else ""
            note = f" ({one.inferred} inferred)" if one.inferred else ""
            table.add_row(one.name, value + off, one.unit, f"{sign}{one.printed or '–'}", one.place + note)
    console = make_console()
    console.print(table)
    judged = [agrees for one in found if (agrees := one.agrees()) is not None]
    console.print(f"  {sum(judged)} of {len(judged)} printed values are met to their digits", style="dim", markup=False)
    console.print(f"  next    {USAGE.split(' | ')[1].replace('sizing', 'hjcamp sizing', 1)}", markup=False)
    rows = [
        {
            "quantity": one.name, "value": one.value, "unit": one.unit, "printed": one.printed, "relation": one.relation,
            "place": one.place, "agrees": one.agrees(),
        }
        for one in found
    ]  # fmt: skip
    return {"schema": "hjcamp.sizing/1", "quantities": rows}


def answer_question(lines: list[str]) -> dict[str, Any]:
    """Print whether the joint can do it with each friction, and what stops it; returns the answer for programs."""
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.plants.pump_joint.sizing import capability

    asked, overrides = _split(lines)
    question = capability.read_question(asked)
    joint, frictions = _joint_and_frictions(overrides)
    answers = []
    for one in frictions:
        found = capability.limits(question, joint, one)
        there = min(joint.sensor_range, question.pressure or joint.sensor_range)
        answers.append(
            {
                "friction": one.name,
                "verdict": capability.verdict(found),
                "largest_torque_mnm": capability.largest_torque(there, one.coulomb, joint) * 1e3,
                "at_mpa": there * 1e-6,
                "limits": [
                    {
                        "limit": limit.name,
                        "what": limit.what,
                        "needed": limit.needed * SCALE[limit.unit],
                        "there": limit.there * SCALE[limit.unit],
                        "unit": limit.unit,
                        "stops": limit.stops,
                    }
                    for limit in found
                ],
            }
        )
    tension = capability.string_tension(question, joint)
    _print_answers(answers, tension)
    if question.pressure is not None and question.pressure > joint.sensor_range:
        told = f"  pressure_mpa is beyond what the sensors measure: counted with their {joint.sensor_range * 1e-6:.3g} MPa."
        make_console().print(told, markup=False, soft_wrap=True)
    return {"schema": "hjcamp.capability/1", "asked": asked, "answers": answers, "string_tension_n": tension}


def _split(lines: list[str]) -> tuple[list[str], list[str]]:
    from hjcamp.configuration.composer import Composer

    composer = Composer()
    overrides = [line for line in lines if "." in (key := line.partition("=")[0]) or composer.is_group(key)]
    return [line for line in lines if line not in overrides], overrides


def _joint_and_frictions(overrides: list[str]) -> tuple[Joint, list[Friction]]:
    from hjcamp.configuration.check import check_configuration
    from hjcamp.configuration.composer import Composer
    from hjcamp.plants.pump_joint.sizing.capability import Joint, frictions_of

    chosen = any(line.partition("=")[0] == "friction" for line in overrides)
    composer, frictions = Composer(), []
    for name in [""] if chosen else FRICTIONS:
        config = composer.compose([*([f"friction={name}"] if name else []), *overrides]).config
        check_configuration(config)
        own = str(config["friction"]["name"])
        shown = FRICTIONS.get(own, own)
        frictions += frictions_of(shown, config["friction"])
    if not config["joint"].get("string"):
        raise UsageError("joint.string is needed: turns, friction_coefficient, minimum_tension_n")
    return Joint.of(config), frictions


def _print_answers(answers: list[dict[str, Any]], tension: float | None) -> None:
    from rich.table import Table

    from hjcamp.campaign.execution.console import make_console

    console = make_console()
    table = Table(box=None, header_style="bold", pad_edge=False)
    for heading in ("friction", "answer", "limit", "needed", "there is", "largest torque"):
        table.add_column(heading, justify="left" if heading in ("friction", "answer", "limit") else "right")
    for answer in answers:
        for number, limit in enumerate(answer["limits"]):
            mark = "✗ " if limit["stops"] else "  "
            first = number == 0
            table.add_row(
                answer["friction"] if first else "",
                answer["verdict"] if first else "",
                f"{mark}{limit['what']}",
                f"{limit['needed']:.3f} {limit['unit']}",
                f"{limit['there']:.3f} {limit['unit']}",
                f"{answer['largest_torque_mnm']:.1f} mNm at {answer['at_mpa']:.3g} MPa" if first else "",
            )
    console.print(table)
    if tension is not None:
        console.print(f"  The string must be tensioned to {tension:.2f} N or more, or it slips.", markup=False)


def draw(output: Path, lines: list[str]) -> None:
    """Draw every figure into a folder: those of the formulas, and those of the configured friction and payload."""
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.configuration.check import check_configuration
    from hjcamp.configuration.composer import Composer
    from hjcamp.plants.pump_joint.figures.joint import figures_of
    from hjcamp.plants.pump_joint.figures.sizing import FIGURES, draw_figures

    for line in lines:
        if "=" not in line or line.partition("=")[0] == "campaign":
            raise UsageError(f"figures takes overrides of the joint, such as friction=first_state, not '{line}': {USAGE}")
    config = Composer().compose([*PAYLOAD, *lines]).config
    check_configuration(config)
    check_place(output / f"{next(iter(FIGURES))}.png", "--output")
    console = make_console()
    for path in draw_figures(output, figures={**FIGURES, **figures_of(config)}):
        console.print(f"  picture  {path}", markup=False, soft_wrap=True)
