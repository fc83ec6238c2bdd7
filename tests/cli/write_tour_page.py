"""Takes both tours, writes docs/tour.md and docs/tour_plant.md with what they print: python tests/cli/write_tour_page.py [PAGE]."""

from __future__ import annotations

import re
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from hjcamp.storage import write_whole

ROOT = Path(__file__).parents[2]
IMAGES = ROOT / "docs" / "images"
HEAD = """\
# A few minutes with sample logs

Written by `python tests/cli/write_tour_page.py`, which took the tour: every line in a box is what was printed.

```
hjcamp tour              # lays out the sample logs in ./tour, then five steps; Enter goes on, q stops
hjcamp tour              # later: goes on where it stopped
hjcamp tour --step 2     # one step alone, again
hjcamp tour --open       # the sealed answer
hjcamp tour --plant      # the same for a machine that is not the joint: tour_plant.md
```

The logs (24 tests, 0.7 MB in the package) come from a simulated rig that shares no code with `hjcamp`: other equations,
friction, stiffness, noise and scatter (`tests/truth`). One effect hides in it. If you want to find it yourself, do not
read on: what follows names it. The tour writes to `tour/` and one model to `conf/model/`; its last lines say how to
clear both away. `--into FOLDER` takes another place, `--effort standard` a more careful diagnosis, `--yes` does not
wait between the steps. Where the name `tour_model` is taken, the new model is `tour_model_2`, and so on.
"""
TAIL = """
![The error on the tests that were not used for the fit: published, constants estimated, tour_model](images/tour_falls.svg)

![Measurement, published model and tour_model](images/tour_overlay.svg)

*The overlay of step 4. The published model stays behind, because it believes in another friction and loses no water;
the new one lies on the measurement.*

It took {seconds:.0f} s of processor time in all, kernels compiled before. The sample logs and the sealed answer are made by
`python tests/cli/make_tour_data.py`.
"""
PLANT_HEAD = """\
# The same for a machine that is not the joint

Written by `python tests/cli/write_tour_page.py`, which took the tour: every line in a box is what was printed.

```
hjcamp tour --plant              # plants/spindle.py and three recordings, then six steps; Enter goes on, q stops
hjcamp tour --plant --step 3     # one step alone, again
```

A motor turns a spindle. Its file of equations (33 lines) knows a body and a bearing with friction; something else brakes it. With a
crane, an oven or a pump the commands are the same: [a rig of your own](own_plant.md). What follows names what hides.
"""
PLANT_TAIL = """
![The error on the recording that nothing was fitted to: published, spindle_model, noise floor](images/tour_plant_falls.svg)

It took {seconds:.0f} s of processor time in all, kernels compiled before. The recordings are made by
`python docs/gallery/make_logs.py`, which shares no code with `hjcamp`.
"""


def page_of(text: str, seconds: float, head: str, tail: str) -> str:
    """Return the page from what a tour printed."""
    steps = re.split(r"\nStep \d of \d: ", text)[1:]
    parts = [head]
    for number, step in enumerate(steps, start=1):
        spoken, _, printed = step.partition("\n$ ")
        title, _, look = spoken.partition("\n")
        lines = [line.rstrip() for line in printed.strip().splitlines() if not re.match(r" +\d+:\d\d  ", line)]
        box = "\n".join(lines)
        parts.append(f"\n## {number}. {title}\n\n{look.strip()}\n\n```\n$ {box}\n```\n")
    return "".join(parts) + tail.format(seconds=seconds)


def take(option: list[str], page: str, head: str, tail: str, pictures: dict[str, str]) -> None:
    """Take a tour in an empty folder; write its page and the pictures (in its folder -> in docs/images)."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve()
        program = f"import sys; sys.path.insert(0, {str(ROOT)!r}); from hjcamp.cli import main; main()"
        call = [sys.executable, "-c", program, "tour", *option, "--yes"]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        answer = subprocess.run(call, cwd=folder, check=True, capture_output=True, text=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        text = page_of(answer.stdout.replace(folder.as_uri(), "file:///..."), seconds, head, tail)
        for picture, place in pictures.items():
            shutil.copyfile(folder / picture, IMAGES / place)
    write_whole(ROOT / "docs" / page, text)


def main() -> None:
    """Take the tours that are asked for by their page, both by default."""
    wanted = sys.argv[1:] or ["tour.md", "tour_plant.md"]
    if "tour.md" in wanted:
        pictures = {"tour/compare_both/overlay.svg": "tour_overlay.svg", "tour/error_falls.svg": "tour_falls.svg"}
        take([], "tour.md", HEAD, TAIL, pictures)
    if "tour_plant.md" in wanted:
        pictures = {"tour_plant/error_falls.svg": "tour_plant_falls.svg"}
        take(["--plant"], "tour_plant.md", PLANT_HEAD, PLANT_TAIL, pictures)


if __name__ == "__main__":
    main()
