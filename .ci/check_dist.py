"""Build wheel and sdist into dist/, and check them as a stranger would: python .ci/check_dist.py [TAG]

The sdist is built first and the wheel from it. Both pass `twine check`; the wheel is installed into a new environment, whose size is
held against SIZE_MB and PACKAGES, and called in an empty folder; pytest collects every test of the unpacked sdist and runs some.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
#: A plain install under Python 3.11 had 702 MB in 64 packages on 2026-11-29, and two packages more since pages are templates.
SIZE_MB, PACKAGES = 710, 66
CALLS = (["--help"], ["--version"], ["plan", "campaign=robustness_vertical"], ["plants"])
#: Tests that are fast and read files all over the project.
QUICK = ("tests/project/test_release.py", "tests/project/test_readme.py", "tests/project/test_workflows.py")


def call(*words: object, folder: Path = ROOT) -> str:
    """Call a program and return what it prints; whatever fails ends the check."""
    kept = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "HJCAMP_CONF"))}
    done = subprocess.run([str(word) for word in words], cwd=folder, env=kept, capture_output=True, text=True)
    if done.returncode:
        print(done.stdout[-3000:], done.stderr[-3000:], sep="\n", file=sys.stderr)
        raise SystemExit(f"{' '.join(map(str, words))} ended with {done.returncode}")
    return done.stdout


def built() -> tuple[Path, Path]:
    """Build the sdist, the wheel from it, and check their metadata; return both."""
    shutil.rmtree(ROOT / "dist", ignore_errors=True)
    call(sys.executable, "-m", "build", "--no-isolation", "--outdir", ROOT / "dist")
    (wheel,), (sdist,) = (ROOT / "dist").glob("*.whl"), (ROOT / "dist").glob("*.tar.gz")
    call(sys.executable, "-m", "twine", "check", "--strict", wheel, sdist)
    return wheel, sdist


def check_wheel(wheel: Path, place: Path) -> str:
    """Install the wheel as a user does, hold its size against the limit, and call it in an empty folder; return the size."""
    call(sys.executable, "-m", "venv", "--without-pip", place / "venv")
    python, empty = place / "venv" / "bin" / "python", place / "empty"
    pip = [sys.executable, "-m", "pip", "--python", python, "install", "--quiet", "--no-compile"]
    call(*pip, "--constraint", ROOT / "constraints.txt", wheel)
    size = sum(file.lstat().st_blocks * 512 for file in (place / "venv").rglob("*")) / 2**20
    count = len(list((place / "venv").glob("lib/python3*/site-packages/*.dist-info")))
    said = f"{size:.0f} MB in {count} packages (at most {SIZE_MB} and {PACKAGES})"
    if size > SIZE_MB or count > PACKAGES:
        raise SystemExit(f"a plain install has {said}")
    empty.mkdir()
    for words in CALLS:
        call(place / "venv" / "bin" / "hjcamp", *words, folder=empty)
    if list(empty.iterdir()):
        raise SystemExit(f"hjcamp wrote into the empty folder: {sorted(empty.iterdir())}")
    return said


def check_sdist(sdist: Path, place: Path) -> str:
    """Unpack the sdist, collect every test there and run the quick ones; return how many there are."""
    with tarfile.open(sdist) as archive:
        archive.extractall(place, filter="data")
    folder = place / sdist.name.removesuffix(".tar.gz")
    pytest = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider"]
    collected = call(*pytest, "--collect-only", "-q", folder=folder)
    call(*pytest, *QUICK, folder=folder)
    count = sum(int(one) for one in re.findall(r"^tests/\S+\.py: (\d+)$", collected, re.MULTILINE))
    return f"{count} tests collected"


def main(tag: str | None) -> int:
    """Check, and say in a line what was found."""
    wheel, sdist = built()
    version = wheel.name.split("-")[1]
    if tag is not None and tag != f"v{version}":
        print(f"the tag is {tag}, the version {version}", file=sys.stderr)
        return 1
    with tempfile.TemporaryDirectory() as made:
        size, tests = check_wheel(wheel, Path(made)), check_sdist(sdist, Path(made))
    print(f"hjcamp {version}: {wheel.name} and {sdist.name} are whole; install {size}; {tests}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main(*sys.argv[1:2] or [None]))
