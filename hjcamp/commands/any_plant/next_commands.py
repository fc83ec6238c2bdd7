"""The commands that go on from a diagnosis of any plant."""

from __future__ import annotations

from hjcamp.commands.any_plant.verdict_words import Words
from hjcamp.diagnosis.calibration.shares import left_of


def next_commands(words: Words, paths: str, model: str, folder: str = "diagnose") -> list[str]:
    """The commands that go on from the answer."""
    own = "" if model == "published" else f" --model {model}"
    # no law of an effect can know a course of its own in each condition
    curve = bool(words.content["unknowns"]) and not words.content["unknowns"][0]["apart_s"]
    if words.verdict.word == "effect":
        added, named = " ".join(words.verdict.effects), "_and_".join(words.verdict.effects)
        return [f"hjcamp add {added} {paths}{own} --as with_{named}"]
    if words.verdict.word == "one_of" or words.or_outside:
        sets = words.verdict.confidence_set[:2]
        adds = [f"hjcamp add {' '.join(one)} {paths}{own} --as with_{'_and_'.join(one)}" for one in sets]
        return [f"hjcamp next {paths}{own}", *adds]
    if words.verdict.word == "outside_library":
        if words.content["by_condition"] and not words.content["unknowns"]:
            return ["hjcamp calibrate LOGS_OF_ONE --as NAME   # each specimen or condition by itself"]
        begun, formulas = f" --from {folder}" if curve else "", words.content["formulas"]
        if formulas and not formulas["none"]:
            form = formulas["forms"][0]["form"]
            return [f"hjcamp effects new MY_EFFECT{begun} --form {form}   # then: hjcamp diagnose {paths}{own}"]
        return [f"hjcamp effects new MY_EFFECT{begun}   # write its law, then: hjcamp diagnose {paths}{own}"]
    held = any(row.get("held") for row in words.content["calibration"].values())
    rivals = words.verdict.word == "cannot_tell" and not held and any(left_of(row) < 1.0 for row in words.content["candidates"])
    return [*([f"hjcamp next {paths}{own}"] if rivals else []), f"hjcamp compare {paths}{own}"]
