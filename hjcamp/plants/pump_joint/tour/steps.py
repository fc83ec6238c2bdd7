"""The steps of the joint's tour: what to look at, the command, where its answer and its pictures are."""

from __future__ import annotations

from pathlib import Path

from hjcamp.plants.pump_joint.tour.kinds import Kind, Step, Tour, effects_to_add
from hjcamp.plants.pump_joint.tour.samples import SEALED, lay_out

MODEL = "tour_model"
BOTH = "compare_both"


def _compare(tour: Tour) -> list[str]:
    return ["compare", str(tour.folder), "--model", "published", "--json", str(tour.answer_file(1))]


def _diagnose(tour: Tour) -> list[str]:
    return ["diagnose", str(tour.folder), "--effort", tour.effort, "--json", str(tour.answer_file(2))]


def _add(tour: Tour) -> list[str]:
    from hjcamp.analyses.data import free_model_name

    effects = effects_to_add(tour.answer(2))
    return ["add", *effects, str(tour.folder), "--as", free_model_name(MODEL), "--json", str(tour.answer_file(3))]


def _compare_both(tour: Tour) -> list[str]:
    name = str(tour.answer(3).get("model"))
    models = ["--model", "published", "--model", name]
    # A folder of its own: the page of step 1 stays.
    return ["compare", str(tour.folder), *models, "--into", str(tour.folder / BOTH), "--json", str(tour.answer_file(4))]


def _fall(tour: Tour) -> list[tuple[str, float]]:
    error = tour.answer(3)["error"]
    found = [("published", error["start"]), ("constants estimated", error["before"]), (tour.answer(3)["model"], error["after"])]
    return [*found, ("repeatability", 1.0)]


STEPS = (
    Step(
        "How far is the model off, and where?",
        "The published model is driven with the measured motion of the pump and has to say what the arm and the two "
        "lines do. 'error' is by how much it is wrong. 'noise floor' is by how much repetitions of one test differ from "
        "each other: no model can do better. Look at 'error / noise floor' (1 would be perfect) and at the sentences after "
        "'where'. Open the page: in the overlay model and measurement part within a second. Some of that is only "
        "another specimen's friction: the map shows a missing force that changes its sign with the direction.",
        _compare,
        "compare",
    ),
    Step(
        "What is missing?",
        "This joint is not the published one, so friction, stiffness and mass are calibrated first: they are not "
        "called missing. Then every effect of the library is tried. Simulated tests in which nothing is missing "
        "show how much of an improvement is mere chance (p). Look at the line in capitals, at 'posterior' (how "
        "sure it is of this effect and no other), and at the errors: they are of tests that the fit has not seen. "
        "'Where' on the page tells which part of the rig is to blame once friction is right.",
        _diagnose,
        "diagnose",
    ),
    Step(
        "Add it to the model",
        "The effect is fitted together with the base parameters on all repetitions but the last of each condition; "
        "the table and the bars are the error on those last ones, on the scale of step 1. The new model is a file that "
        "you can read and change; it says where it comes from: the command, the intervals, the hashes of the logs.",
        _add,
    ),
    Step(
        "Compare again, both models",
        "The same tests, two models. Look at the bars, then at the page: in the overlay the new model lies on the "
        "measurement, and in the last picture its error stays at the repeatability level from the start. The row of the pump is as "
        "before: how it follows its command is a part of the model that nothing was added to.",
        _compare_both,
        BOTH,
    ),
    Step(
        "Open the sealed answer",
        "What really hides in the rig, next to what step 2 found. The rig is another program with other equations, so "
        "the numbers need not agree to the last digit; the 95 % interval is the diagnosis' own.",
        Tour.open_words,
    ),
)

JOINT = Kind(
    folder=Path("tour"),
    steps=STEPS,
    diagnosing=2,
    adding=3,
    lay_out=lay_out,
    sealed=SEALED,
    introduction="A rig was tested: {count} logs, 8 conditions with 3 repetitions each, are in {folder}/logs. Something hides in "
    "that rig that the published model does not know. Five steps find it. Each shows the command that it runs, so that you can "
    "repeat it. Where kernels are not compiled yet, the first two steps take one or two minutes longer.",
    fall=_fall,
    held_out="error / repeatability, on the tests that were not used for the fit",
    after=("hjcamp run campaign=controllers controller.model={model}", "hjcamp tour --plant"),
)
