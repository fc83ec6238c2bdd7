"""Build docs/gallery.md, its pictures and README's sample from the commands: python docs/gallery/build_gallery.py [--only CASE ...]

Each case is a command on committed recordings of one spindle; what is printed and drawn is what the command gave. `--work FOLDER`
keeps what was run there, and runs only what is missing in it. Some minutes on two cores.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
TOUR = ROOT / "hjcamp" / "plants" / "pump_joint" / "tour" / "spindle"
IMAGES = ROOT / "docs" / "images"
BEGIN, END = "<!-- sample: written by `make gallery` -->", "<!-- end of sample -->"
#: The sentences below the verdict that every case would repeat.
LEFT_OUT = ("No test was repeated", "noise floor unknown", "Whole tests:", "Nothing that depends on where the body")


@dataclass(frozen=True)
class Case:
    """One case: its name, heading, what the recordings hold, what the answer means, what to do next, its logs and picture."""

    name: str
    title: str
    holds: str
    means: str
    then: str
    logs: tuple[str, ...]
    picture: str
    caption: str
    map: str = "map.yaml"
    verb: str = "diagnose"


CASES = (
    Case(
        "effect",
        "An effect is missing",
        "Air brakes the spindle with the square of its speed; the file of its equations knows dry and viscous friction only.",
        "One effect explains all of the error in windows that it was not fitted to: no more is left than the sensor's noise. "
        "The friction of the bearing, which had taken the place of the drag, gets its true values.",
        "`hjcamp add quadratic_drag LOGS --as NAME` writes a model with it; compare that on a recording that was kept out.",
        ("train_1", "train_2"),
        "missing_before.svg",
        "The torque that the model lacks over the speed once its constants are estimated: fitted without a form, with its 95 % band, "
        "and the law of the effect through it.",
    ),
    Case(
        "one_of",
        "One of several effects",
        "A belt pulls the spindle one way. It turns round four times and never rests.",
        "A torque that pushes one way and a friction that is larger one way are the same law while the spindle moves: only at rest do "
        "they differ. The answer names the effects that explain the recording equally well.",
        "`hjcamp next LOGS` proposes tests that separate them; here a rest does.",
        ("turns",),
        "worst_test.svg",
        "The recording, the model's errors before, and with what was found.",
    ),
    Case(
        "one_of_outside",
        "One of several effects, and something outside the library",
        "A belt pulls the spindle one way, harder at some speeds than at others. No effect of the library pulls like that.",
        "What pulls one way has two names, as before, and neither has quite the form. Both explain nearly all of the error, so they are "
        "the answer; how much more the best model of all explains is said, and that the sensor's noise is not reached.",
        "A repeated test would show whether the residual is scatter; a rest in a recording would decide between the two names.",
        ("belt_1", "belt_2"),
        "worst_test.svg",
        "The worst recording: the error with the constants estimated, and with what was found.",
    ),
    Case(
        "outside",
        "Something outside the library, with its driver",
        "A seal rubs most at one speed, about 220 rad/s, and less at lower and higher ones. No effect of the library has that form.",
        "A function of one quantity, fitted without any form, predicts better than every named effect. The answer names the "
        "quantity and draws the function.",
        "`hjcamp effects new seal --from diagnose --form bell` writes an effect with that formula (without `--form` the curve as a "
        "table); diagnosed with it, the recordings give the seal's own values (`docs/formulas.md`).",
        ("seal_1", "seal_2"),
        "missing_before.svg",
        "Friction over speed that the model lacks, with its 95 % band.",
    ),
    Case(
        "nothing",
        "Nothing is missing",
        "The spindle is what the file says, but for the values of its constants.",
        "No effect, no pair of effects and no free function explains a tenth of what lies above the sensor's noise, on folds that were "
        "left out. That is a finding: the error is the sensor's noise.",
        "Use the constants that were estimated: `hjcamp calibrate LOGS --as NAME`.",
        ("plain_1", "plain_2"),
        "worst_test.svg",
        "The worst recording: the error is the sensor's noise.",
    ),
    Case(
        "cannot_tell",
        "These recordings cannot tell",
        "The first 3 s of a recording like those of the first case: the same air drag.",
        "Too few windows to leave any out. A fit would name something; it is not asked.",
        "Record for longer; the answer says how much is needed.",
        ("short",),
        "worst_test.svg",
        "The recording, and the error of the model with its constants estimated.",
    ),
    Case(
        "specimen",
        "Another specimen",
        "A second spindle of the same kind: its rotor is heavier, its bearing stiffer than the file says. Nothing is missing.",
        "Constants that differ from machine to machine are no missing effect. With the file's own constants the error is many times "
        "the noise; with those estimated here it is the noise, and nothing remains to be explained.",
        "`hjcamp calibrate LOGS --as NAME` keeps the constants of this specimen.",
        ("other_1",),
        "windows.svg",
        "The windows that are predicted worst, with the file's constants and with those estimated here.",
        verb="compare",
    ),
    Case(
        "specimens",
        "Two specimens in one set",
        "A recording of the spindle of *nothing is missing* and one of the second spindle, with no word which is which.",
        "No one set of constants fits both, and no effect explains that. Constants estimated for each recording alone do; those "
        "that differ are named with their values.",
        "Calibrate and diagnose each specimen with its own recordings; or give what differs with each test "
        "(`hjcamp explain 'differs by condition'`).",
        ("plain_1", "other_1"),
        "worst_test.svg",
        "The worst recording, and the error of one set of constants for both spindles.",
    ),
    Case(
        "wrong_log",
        "A log is wrong",
        "The spindle of *nothing is missing*, imported with the sign of the voltage turned round (`docs/gallery/wrong_sign.yaml`).",
        "The constants run to their bounds, far from what is declared, and the answer asks whether a sign or a unit is wrong. What it "
        "names stands for that, and is not to be believed until the log is right.",
        "Look at the sign and the unit of what the answer points to, mend the map and import again.",
        ("plain_1",),
        "worst_test.svg",
        "Measured, and what the model makes of a voltage of the wrong sign.",
        "wrong_sign.yaml",
    ),
)
HEAD = """\
# Gallery: one worked case of each answer

Written by `make gallery`: every box is what the command printed (sentences that all cases share are left out), every picture is from
its page. One machine, a spindle, is all in one file:

```python
{plant}
```

The recordings are made by [make_logs.py](gallery/make_logs.py), which shares no code with `hjcamp`; each holds something else.
`hjcamp tour --plant` writes this file and the recordings of the first case, and walks through it.
"""


def command(case: Case) -> list[str]:
    """Return the words of the command of a case after ``hjcamp``."""
    effort = ["--effort", "quick"] if case.verb == "diagnose" else []
    return [case.verb, *(f"logs/{name}.mcap" for name in case.logs), *effort]


def hjcamp(words: Sequence[str], folder: Path) -> str:
    """Run a command in ``folder`` and return what it printed."""
    program = f"import sys; sys.path.insert(0, {str(ROOT)!r}); from hjcamp.cli import main; main()"
    done = subprocess.run([sys.executable, "-c", program, *words], cwd=folder, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"hjcamp {' '.join(words)}: {done.stderr}")
    return done.stdout


def run(case: Case, folder: Path) -> None:
    """Import the recordings of a case and run its command in ``folder``; the answer is ``out.txt``, the page in a folder."""
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "plants").mkdir(parents=True)
    shutil.copyfile(TOUR / "plant.txt", folder / "plants" / "spindle.py")
    files = [next(place / f"{name}.csv" for place in (HERE, TOUR) if (place / f"{name}.csv").is_file()) for name in case.logs]
    rules = HERE / case.map if (HERE / case.map).is_file() else TOUR / case.map
    hjcamp(["import", *map(str, files), "--map", str(rules), "--into", "logs"], folder)
    text = hjcamp(command(case), folder)
    (folder / "out.txt").write_text(text, encoding="utf-8")


def shown(text: str) -> str:
    """Return what a command printed without its progress, its page, and the sentences that all cases share."""
    kept, skipping = [], False
    for line in text.splitlines():
        begins = line.startswith("        ") and not line.startswith("          ")
        skipping = (skipping and not begins and line.startswith("          ")) or (begins and line.strip().startswith(LEFT_OUT))
        if not skipping and not re.match(r" +\d+:\d\d  |page    ", line):
            kept.append(line.rstrip())
    return "\n".join(kept).strip("\n")


def part_of(case: Case, folder: Path) -> str:
    """Return the part of the page for a case, and copy its picture."""
    picture = f"gallery_{case.name}.svg"
    shutil.copyfile(folder / case.verb / case.picture, IMAGES / picture)
    inside = {name: (HERE / f"{name}.csv").is_file() for name in case.logs}
    data = ", ".join(f"[{name}.csv](gallery/{name}.csv)" if ours else f"`{name}.csv`" for name, ours in inside.items())
    box = f"$ hjcamp {' '.join(command(case))}\n{shown((folder / 'out.txt').read_text(encoding='utf-8'))}"
    return (
        f"\n## {case.title}\n\n**In the recordings** ({data}): {case.holds}\n\n```\n{box}\n```\n\n{case.means}\n\n"
        f"![{case.caption}](images/{picture})\n\n*{case.caption}*\n\n**Next.** {case.then}\n"
    )


def sample(folder: Path) -> str:
    """Return README's sample: the verdict and the errors of the first case, and its picture."""
    lines = shown((folder / "out.txt").read_text(encoding="utf-8")).splitlines()
    words = ("EFFECT", "  effect", "error")
    first, table, error = (next(n for n, line in enumerate(lines) if line.startswith(word)) for word in words)
    kept = [*lines[first:table], *lines[table : table + 3], *lines[error : error + 3]]
    box = "\n".join([f"$ hjcamp {' '.join(command(CASES[0]))}", *kept])
    said = "Two recordings of a spindle, whose file of equations knows dry and viscous friction:"
    picture = f"![{CASES[0].caption}](docs/images/gallery_effect.svg)\n\n*{CASES[0].caption}*"
    return f"{BEGIN}\n{said}\n\n```\n{box}\n```\n\n{picture}\n\n{END}"


def main() -> None:
    """Run the cases, then write the page, its pictures and README's sample."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--work", type=Path, help="keep what is run in this folder")
    parser.add_argument("--only", nargs="*", default=[case.name for case in CASES], help="run these alone and write nothing")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        work = (asked.work or Path(name)).resolve()
        for case in CASES:
            if case.name in asked.only and not (work / case.name / "out.txt").is_file():
                run(case, work / case.name)
        if set(asked.only) != {case.name for case in CASES}:
            return
        plant = (TOUR / "plant.txt").read_text(encoding="utf-8").strip()
        page = HEAD.replace("{plant}", plant) + "".join(part_of(case, work / case.name) for case in CASES)
        (ROOT / "docs" / "gallery.md").write_text(page, encoding="utf-8")
        readme = ROOT / "README.md"
        text = readme.read_text(encoding="utf-8")
        before, after = text.partition(BEGIN)[0], text.partition(END)[2]
        readme.write_text(before + sample(work / "effect") + after, encoding="utf-8")


if __name__ == "__main__":
    main()
