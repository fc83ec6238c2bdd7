"""The tour of a machine that is not the joint: a spindle in a file of its own, three recordings, and what its model leaves out."""

from __future__ import annotations

from pathlib import Path

from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.tour.kinds import Kind, Step, Tour, effects_to_add
from hjcamp.plants.pump_joint.tour.samples import check_ours
from hjcamp.storage import write_whole

FILES = Path(__file__).with_name("spindle")
PLANT = Path("plants") / "spindle.py"
MODEL = "spindle_model"
HELD_OUT = "compare_held_out"
FITTED = ("train_1", "train_2")
ABOUT = """\
Recordings of `hjcamp tour --plant`: a spindle under a voltage that is switched, three times 15 s, speed and voltage.
In it acts something that plants/spindle.py does not know. The recordings are made by docs/gallery/make_logs.py, which
shares no code with hjcamp. This folder may be deleted; `hjcamp tour --plant` makes it again.
"""


def lay_out(folder: Path) -> int:
    """Write the plant, where there is none of that name, and the recordings; returns how many there are."""
    check_ours(folder, ABOUT)
    text = (FILES / "plant.txt").read_text(encoding="utf-8")
    if not PLANT.exists():
        write_whole(PLANT, text)
    elif PLANT.read_text(encoding="utf-8") != text:
        raise UsageError(f"{PLANT}: this is another plant than that of the tour; take the tour in another folder")
    for path in (*FILES.glob("*.csv"), FILES / "map.yaml"):
        if not (folder / "measured" / path.name).exists():
            write_whole(folder / "measured" / path.name, path.read_bytes())
    return len(list(FILES.glob("*.csv")))


def _logs(tour: Tour) -> list[str]:
    tour.answer(1)  # says that they have to be taken in before
    return [str(tour.folder / "logs" / f"{name}.mcap") for name in FITTED]


def _import(tour: Tour) -> list[str]:
    files = [str(tour.folder / "measured" / f"{name}.csv") for name in (*FITTED, "held_out")]
    place = ["--map", str(tour.folder / "measured" / "map.yaml"), "--into", str(tour.folder / "logs")]
    return ["import", *files, *place, "--json", str(tour.answer_file(1))]


def _compare(tour: Tour) -> list[str]:
    return ["compare", *_logs(tour), "--into", str(tour.folder / "compare"), "--json", str(tour.answer_file(2))]


def _diagnose(tour: Tour) -> list[str]:
    return ["diagnose", *_logs(tour), "--effort", tour.effort, "--json", str(tour.answer_file(3))]


def _add(tour: Tour) -> list[str]:
    from hjcamp.analyses.data import free_model_name

    names = effects_to_add(tour.answer(3))
    return ["add", *names, *_logs(tour), "--as", free_model_name(MODEL), "--json", str(tour.answer_file(4))]


def _judge(tour: Tour) -> list[str]:
    models = ["--model", "published", "--model", str(tour.answer(4).get("model"))]
    place = ["--into", str(tour.folder / HELD_OUT), "--json", str(tour.answer_file(5))]
    return ["compare", str(tour.folder / "logs" / "held_out.mcap"), *models, *place]


def _fall(tour: Tour) -> list[tuple[str, float]]:
    return [*((str(one["name"]), float(one["score"])) for one in tour.answer(5)["models"]), ("noise floor", 1.0)]


SPINDLE = Kind(
    folder=Path("tour_plant"),
    steps=(
        Step(
            "Take the recordings in",
            "Three CSV files, as a logger wrote them: time in ms, speed in rpm, voltage. measured/map.yaml says which column is "
            "which quantity, in which unit. plants/spindle.py holds the equations: a motor, a body, a bearing with friction.",
            _import,
            writes=tuple(f"logs/{name}.mcap" for name in (*FITTED, "held_out")),
        ),
        Step(
            "How far is the model off?",
            "Each recording is cut into short windows; the model predicts each from its first sample on, under the voltage as logged. "
            "'published' has the constants of the file, 'calibrated' those that fit these recordings best: another spindle of the same "
            "kind may have another inertia, and that is no missing effect. The residual after that is.",
            _compare,
            "compare",
        ),
        Step(
            "What is missing?",
            "Every effect of the library that fits this machine is tried, and judged on windows that it was not fitted to. p is how "
            "often chance would gain as much. Look at the line in capitals, at the errors, and on the page at the first picture: the "
            "torque that is missing, over the speed, and the law of the effect through it.",
            _diagnose,
            "diagnose",
        ),
        Step(
            "Add it to the model",
            "The effect is fitted together with the constants. The new model is a file that you can read and change.",
            _add,
        ),
        Step(
            "A recording that nothing was fitted to",
            "held_out was in no fit. The model as it was, and the model with what was found, predict it from its first sample to its "
            "last.",
            _judge,
            HELD_OUT,
        ),
        Step(
            "Open the sealed answer",
            "What acts in the spindle, next to what was found. The recordings come from a program that shares no code with this one.",
            Tour.open_words,
        ),
    ),
    diagnosing=3,
    adding=4,
    lay_out=lay_out,
    sealed=FILES / "answer.sealed",
    introduction="A spindle was measured: {count} recordings are in {folder}/measured, its equations in plants/spindle.py. Something "
    "brakes it that the equations do not know. Six steps find it. Each shows the command that it runs; with your own file and "
    "recordings the commands are the same.",
    fall=_fall,
    held_out="error / noise floor, on the recording that nothing was fitted to",
    after=("hjcamp plants new my_machine", "hjcamp tour"),
    option=("--plant",),
    written=(str(PLANT),),
)
