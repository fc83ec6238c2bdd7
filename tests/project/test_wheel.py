"""The installed wheel, called from a user's folder: it carries our configuration, and takes the user's own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SOURCES = ("hjcamp", "conf", "campaigns", "pyproject.toml", "README.md", "LICENSE")
CAMPAIGN = """\
name: mine
description: my first campaign
fixed:
  trajectory: my_nudge
  procedure.adjustment.enabled: false
vary:
  case: {as_published: {friction: bidirectional}, sticky: {effects.my_effect.extra: 2.0}}
repetitions: 1
"""
TRAJECTORY = "name: my_nudge\nkind: ramp\namplitude_deg: 5.0\nrise_time: 0.2\nduration: 0.25\n"
EFFECT = '''\
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class MyEffect(Effect):
    """A constant that is added to the sliding friction."""

    subsystem = "joint"
    extra = Parameter("N", 1.0, (0.0, 10.0), text="added friction", off=0.0)

    @staticmethod
    def friction_coulomb(extra):
        """Force, N."""
        return extra
'''


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the wheel from a copy of the sources."""
    copy = tmp_path_factory.mktemp("sources")
    for name in SOURCES:
        (copy / name).symlink_to(ROOT / name)
    command = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(copy / "dist"), str(copy)]
    subprocess.run(command, check=True, capture_output=True, text=True)
    return next((copy / "dist").glob("hjcamp-*.whl"))


@pytest.fixture(scope="module")
def program(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Install the wheel into an environment of its own that borrows the packages of this one; return its ``hjcamp``."""
    place = tmp_path_factory.mktemp("installed")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(place)], check=True)
    python = place / "bin" / "python"
    packages = next((place / "lib").glob("python3*/site-packages"))
    (packages / "borrowed.pth").write_text(sysconfig.get_path("purelib") + "\n")
    install = [sys.executable, "-m", "pip", "--python", str(python), "install", "--quiet", "--no-deps", "--no-index"]
    subprocess.run([*install, str(wheel)], check=True, capture_output=True)
    return place / "bin" / "hjcamp"


RACE = """
import sys, threading
from concurrent.futures import ThreadPoolExecutor
from hjcamp.model.compile.kernel_cache import load_kernel

def load(number):
    together.wait()
    return load_kernel(sys.argv[1]).prepare(float(number))

together = threading.Barrier(4)
with ThreadPoolExecutor(4) as pool:
    print(list(pool.map(load, range(4))))
"""
SLOW_KERNEL = """import time
{decorator}
time.sleep(0.1)

@entry
def prepare(x):
    return x + 1.0
"""


def called(program: Path, folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Call the installed program in ``folder``; nothing is compiled, the tests of these campaigns are short."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "HJCAMP"))}
    environment |= {"NUMBA_DISABLE_JIT": "1", "HJCAMP_CACHE": str(folder.parent / "cache"), "MPLBACKEND": "agg"}
    return subprocess.run([str(program), *arguments], cwd=folder, env=environment, capture_output=True, text=True)


def test_the_wheel_carries_configuration_and_campaigns(wheel: Path) -> None:
    names = set(zipfile.ZipFile(wheel).namelist())
    for folder in ("conf", "campaigns"):
        files = [path.relative_to(ROOT).as_posix() for path in (ROOT / folder).rglob("*.yaml")]
        assert files and not [file for file in files if f"hjcamp/_configuration/{file}" not in names]


def test_an_empty_folder_is_enough(program: Path, tmp_path: Path) -> None:
    answer = called(program, tmp_path, "plan", "campaign=robustness_vertical", "--json", "-")
    assert answer.returncode == 0, answer.stderr
    assert len(json.loads(answer.stdout)["tests"]) == 56
    assert "site-packages/hjcamp/_configuration/conf" in called(program, tmp_path, "doctor").stdout
    assert not list(tmp_path.iterdir())


def test_campaign_trajectory_and_effect_of_the_user(program: Path, tmp_path: Path) -> None:
    for name, text in {
        "campaigns/mine.yaml": CAMPAIGN,
        "conf/trajectory/my_nudge.yaml": TRAJECTORY,
        "effects/my_effect.py": EFFECT,
    }.items():
        (tmp_path / name).parent.mkdir(parents=True)
        (tmp_path / name).write_text(text)
    answer = called(program, tmp_path, "run", "campaign=mine", "workers=1", "run_dir=first")
    assert answer.returncode == 0, answer.stderr
    logs = sorted(path.parent.name for path in (tmp_path / "first").rglob("*.mcap"))
    assert logs == ["as_published", "sticky"]
    assert (tmp_path / "first" / "report.html").stat().st_size > 10_000


def test_the_first_call_may_load_a_kernel_in_threads(program: Path, tmp_path: Path) -> None:
    """As `diagnose`, `add` and `next` do with a cold cache."""
    kept = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "HJCAMP", "NUMBA"))}
    environment = kept | {"HJCAMP_CACHE": str(tmp_path / "cache")}
    command = [str(program.with_name("python")), "-c", RACE, SLOW_KERNEL]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stdout) == (0, "[1.0, 2.0, 3.0, 4.0]\n"), done.stderr
    assert list((tmp_path / "cache").rglob("*.nbc"))
