"""Completion in the shell: overrides, runs, models, effects and the values of options."""

from __future__ import annotations

import typing
from collections.abc import Callable, Iterable
from pathlib import Path

import typer
from typer.models import ArgumentInfo, OptionInfo

RUN_PLACES = ("runs/*/*/plan.json", "multirun/*/*/plan.json")


def complete_override(incomplete: str) -> list[str]:
    """Return the groups, choices, campaigns and parameters that may follow ``incomplete``."""

    def found() -> list[str]:
        from hjcamp.configuration.composer import Composer

        composer = Composer()
        words = composer.complete(incomplete)
        if len(words) == 1 and words[0].endswith(("=", ".")):
            # The shell would put a space behind a single word that has to go on.
            return composer.complete(words[0]) or words
        return words

    return quietly(found)


def complete_run(incomplete: str) -> list[str]:
    """Return run folders, and the folders and logs at the path that was begun."""

    def found() -> list[str]:
        runs = sorted(path.parent.as_posix() for place in RUN_PLACES for path in Path().glob(place))
        return list(dict.fromkeys([*starting(incomplete, reversed(runs)), *paths_at(incomplete, (".mcap",))]))

    return quietly(found)


def complete_effect(incomplete: str) -> list[str]:
    """Return the names of effects."""

    def found() -> list[str]:
        from hjcamp.effects import load_effects

        return sorted(name for name in load_effects() if name.startswith(incomplete))

    return quietly(found)


def complete_words(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return what may follow ``hjcamp effects`` (an effect, ``new``, ``test``, then overrides) and ``hjcamp next``."""
    if ctx.info_name == "next":
        return [*complete_run(incomplete), *complete_override(incomplete)]
    if ctx.info_name == "history":
        return complete_filter(incomplete)
    if ctx.info_name == "plants":
        named = [str(word) for word in ctx.params.get("words") or []]
        words = [] if named else starting(incomplete, ("new", "test"))
        return [*complete_plant(incomplete), *words] if named in ([], ["test"]) else []
    if ctx.info_name == "sizing":
        return starting(incomplete, ("capability", "figures", "torque_mnm=", "range_deg=", "diameter_mm="))
    before = [str(word) for word in ctx.params.get("words") or []]
    if not before:
        return [*complete_effect(incomplete), *starting(incomplete, ("new", "test"))]
    if before[0] == "new":
        return []
    return complete_effect(incomplete) if before == ["test"] else complete_override(incomplete)


def complete_effects_and_runs(incomplete: str) -> list[str]:
    """Return effects and run folders."""
    return [*complete_effect(incomplete), *complete_run(incomplete)]


def complete_paths(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return run folders and logs; for ``hjcamp paper`` answers, too."""
    answers = quietly(lambda: paths_at(incomplete, (".json",))) if ctx.info_name == "paper" else []
    return list(dict.fromkeys([*complete_run(incomplete), *answers]))


def complete_only(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return effects, and for ``hjcamp calibrate`` the hardware that metadata name."""
    return complete_override(incomplete) if ctx.info_name == "calibrate" else complete_rivals(incomplete)


def complete_against(incomplete: str) -> list[str]:
    """Return ``published``, and run folders."""
    return [*starting(incomplete, ("published",)), *complete_run(incomplete)]


def complete_filter(incomplete: str) -> list[str]:
    """Return what may filter runs (``state=``, and what configures a run), and indicators for ``hjcamp history``."""
    from hjcamp.report.runs.indicators import INDICATORS

    states = [f"state={state}" for state in ("complete", "failed", "interrupted", "new", "running")]
    return [*starting(incomplete, states), *complete_override(incomplete), *starting(incomplete, INDICATORS)]


def complete_columns(incomplete: str) -> list[str]:
    """Return columns of a list of runs, behind the commas, the plus or the minus that are there."""

    def found() -> list[str]:
        from hjcamp.campaign.runs.listing import SESSION, USUAL
        from hjcamp.report.runs.indicators import CHOICES, INDICATORS

        head, comma, last = incomplete.rpartition(",")
        sign = last[:1] if last[:1] in ("+", "-") else ""
        names = starting(last[len(sign) :], dict.fromkeys((*USUAL, *CHOICES, *INDICATORS, *SESSION)))
        return [f"{head}{comma}{sign}{name}" for name in names]

    return quietly(found)


def complete_plant(incomplete: str) -> list[str]:
    """Return the names of plants."""

    def found() -> list[str]:
        from hjcamp.known_plants import plants_and_faults

        return starting(incomplete, plants_and_faults()[0])

    return quietly(found)


def complete_kind(incomplete: str) -> list[str]:
    """Return the kinds of places."""

    def found() -> list[str]:
        from hjcamp.model.declare.port import KINDS

        return starting(incomplete, KINDS)

    return quietly(found)


def complete_style(incomplete: str) -> list[str]:
    """Return the styles of figures for a text."""

    def found() -> list[str]:
        from hjcamp.report.paper.figures import STYLES

        return starting(incomplete, STYLES)

    return quietly(found)


def complete_files(*suffixes: str) -> Callable[[str], list[str]]:
    """Return the completion of a path to a file of these suffixes, or to a folder on the way."""
    return lambda incomplete: quietly(lambda: paths_at(incomplete, suffixes))


def complete_tolerances(incomplete: str) -> list[str]:
    """Return ``default``, and YAML files."""
    return quietly(lambda: [*starting(incomplete, ("default",)), *paths_at(incomplete, (".yaml", ".yml"))])


def complete_choice(group: str) -> Callable[[str], list[str]]:
    """Return the completion of a choice of a configuration group."""

    def complete(incomplete: str) -> list[str]:
        def found() -> list[str]:
            from hjcamp.configuration.composer import Composer

            return starting(incomplete, Composer().options(group))

        return quietly(found)

    return complete


def complete_effort(incomplete: str) -> list[str]:
    """Return the efforts of a diagnosis."""

    def found() -> list[str]:
        from hjcamp.analyses.effort import EFFORTS

        return starting(incomplete, EFFORTS)

    return quietly(found)


def complete_rivals(incomplete: str) -> list[str]:
    """Return effects and ``nothing``, behind the commas that are there."""
    head, comma, last = incomplete.rpartition(",")
    return [f"{head}{comma}{name}" for name in (*complete_effect(last), *starting(last, ("nothing",)))]


#: Parameters of the commands by their names, which mean the same in each of them.
COMPLETIONS: dict[str, Callable[..., list[str]]] = {
    "path": complete_run,
    "paths": complete_paths,
    "run": complete_run,
    "other": complete_run,
    "filters": complete_filter,
    "columns": complete_columns,
    "sort": complete_columns,
    "plant": complete_plant,
    "on": complete_kind,
    "style": complete_style,
    "only": complete_only,
    "without": complete_rivals,
    "over": lambda incomplete: starting(incomplete, ("commits", "runs")),
    "json": complete_files(".json"),
    "json_file": complete_files(".json"),
    "figure": complete_files(".png", ".svg", ".pdf"),
    "summary": complete_files(".md"),
    "junit": complete_files(".xml"),
    "mapping": complete_files(".yaml", ".yml"),
    "files": complete_files(".csv", ".mat", ".parquet", ".mcap"),
    "page": complete_files(".html"),
    **dict.fromkeys(("folder", "output", "into", "conf", "config_dir"), complete_files()),
    "overrides": complete_override,
    "words": complete_words,
    "effects_and_paths": complete_effects_and_runs,
    "model": complete_choice("model"),
    "start": complete_choice("controller/gains"),
    "effort": complete_effort,
    "against": complete_against,
    "check": complete_tolerances,
    "rivals": complete_rivals,
}


def add_completions(app: typer.Typer) -> None:
    """Give every parameter of a command and its parts the completion that its name has."""
    for group in app.registered_groups:
        if group.typer_instance is not None:
            add_completions(group.typer_instance)
    for command in app.registered_commands:
        if command.callback is None:
            continue
        hints = typing.get_type_hints(command.callback, include_extras=True)
        for name, hint in hints.items():
            for info in getattr(hint, "__metadata__", ()):
                if isinstance(info, ArgumentInfo | OptionInfo) and info.autocompletion is None:
                    info.autocompletion = COMPLETIONS.get(name)
        # Annotations that are texts are evaluated anew by each reader, without what was added here.
        command.callback.__annotations__ = hints


def starting(incomplete: str, words: Iterable[str]) -> list[str]:
    """Return the words that begin with ``incomplete``."""
    return [word for word in words if word.startswith(incomplete)]


def paths_at(incomplete: str, suffixes: tuple[str, ...]) -> list[str]:
    """Return the folders, with a slash where they are no runs, and files of these suffixes that begin with ``incomplete``."""
    folder, slash, begun = incomplete.rpartition("/")
    place = Path(folder or ("/" if slash else "."))
    names = sorted(path for path in place.iterdir() if path.name.startswith(begun)) if place.is_dir() else []
    shown = [path for path in names if begun.startswith(".") or not path.name.startswith(".")]
    found = [
        f"{folder}{slash}{path.name}{'/' if path.is_dir() and not (path / 'plan.json').exists() else ''}"
        for path in shown
        if path.is_dir() or path.suffix in suffixes
    ]
    # As with an override: a single folder goes on.
    return paths_at(found[0], suffixes) or found if len(found) == 1 and found[0].endswith("/") else found


def quietly(found: Callable[[], list[str]]) -> list[str]:
    """Return what is found; nothing rather than an error."""
    try:
        return found()
    except Exception:
        # A shell waits for an answer: a broken configuration must not print into the prompt.
        return []
