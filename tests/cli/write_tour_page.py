"""Takes the tour and writes docs/tour.md with what it really printed: python tests/cli/write_tour_page.py (1 min)."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from hjcamp.storage import write_whole

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "tour.md"
PICTURE = ROOT / "docs" / "images" / "tour_overlay.svg"
HEAD = """\
# Ten minutes with sample logs

Written by `python tests/cli/write_tour_page.py`, which took the tour: every line in a box is what was printed.

```
hjcamp tour              # lays out the sample logs in ./tour, then five steps; Enter goes on, q stops
hjcamp tour              # later: goes on where it stopped
hjcamp tour --step 2     # one step alone, again
hjcamp tour --open       # the sealed answer
```

The logs (24 tests, 0.7 MB in the package) come from a simulated rig that shares no code with `hjcamp`: other equations,
friction, stiffness, noise and scatter (`tests/truth`). One effect hides in it. If you want to find it yourself, do not
read on: what follows names it. The tour writes to `tour/` and one model to `conf/model/`; its last lines say how to
clear both away. `--into FOLDER` takes another place, `--effort standard` a more careful diagnosis, `--yes` does not
wait between the steps. Where the name `tour_model` is taken, the new model is `tour_model_2`, and so on.
"""
TAIL = """
![Measurement, published model and tour_model](images/tour_overlay.svg)

*The overlay of step 4. The published model stays behind, because it believes in another friction and loses no water;
the new one lies on the measurement.*

The machine worked for {seconds:.0f} s in all, kernels compiled before. The sample logs and the sealed answer are made anew by
`python tests/cli/make_tour_data.py`.
"""


def page_of(text: str, seconds: float) -> str:
    """Return the page from what the tour printed."""
    steps = re.split(r"\nStep \d of \d: ", text)[1:]
    parts = [HEAD]
    for number, step in enumerate(steps, start=1):
        spoken, _, printed = step.partition("\n$ ")
        title, _, look = spoken.partition("\n")
        box = "\n".join(line.rstrip() for line in printed.strip().splitlines())
        parts.append(f"\n## {number}. {title}\n\n{look.strip()}\n\n```\n$ {box}\n```\n")
    return "".join(parts) + TAIL.format(seconds=seconds)


def main() -> None:
    """Take the tour in an empty folder; write the page and its picture."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve()
        program = f"import sys; sys.path.insert(0, {str(ROOT)!r}); from hjcamp.cli import main; main()"
        call = [sys.executable, "-c", program, "tour", "--yes"]
        began = time.perf_counter()
        answer = subprocess.run(call, cwd=folder, check=True, capture_output=True, text=True)
        text = page_of(answer.stdout.replace(folder.as_uri(), "file:///..."), time.perf_counter() - began)
        shutil.copyfile(folder / "tour" / "compare_both" / "overlay.svg", PICTURE)
    write_whole(PAGE, text)


if __name__ == "__main__":
    main()
