"""Modules that lie in the working folder run in no process that a command starts."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

EVIL = (
    "import pathlib; pathlib.Path(__file__).with_name('PWNED').open('a').write(__file__)\nraise ImportError('not this one')\n"
)
MODULES = (
    "hjcamp", "json", "subprocess", "multiprocessing", "pickle", "numpy", "numba", "joblib", "typing", "sitecustomize", "usercustomize",
)  # fmt: skip
START = {
    "live page": "from hjcamp.live.process import LiveAsk, _started, _let_go\n"
    "process, address = _started(0)\nprint(address)\nprocess.stdin.close()\n_let_go(process)",
    "compiled ahead": "from hjcamp.model.compile import compiled_ahead as one\nprocess = one._started()\n"
    "print(process.communicate(b'', 60), process.returncode)",
    "helpers": "import os\nfrom hjcamp.workers.processes import Helpers\n"
    "import tempfile\nhelpers = Helpers(1, os.getpid)\nprint(list(helpers.each(max, 1, [1, 2, 3])))\nhelpers.close()",
    "workers": "from hjcamp.campaign.execution.workers import LOKY\nfrom hjcamp.children import safe_children\n"
    "from joblib import Parallel, delayed, parallel_config\n"
    "with safe_children(), parallel_config(**LOKY):\n    print(Parallel(n_jobs=2)(delayed(abs)(-one) for one in range(3)))",
}
SHOWN = {"live page": "http://127.0.0.1:", "compiled ahead": "0", "helpers": "[1, 2, 3]", "workers": "[0, 1, 2]"}


@pytest.fixture
def hostile(empty_folder: Path) -> Path:
    for name in MODULES:
        (empty_folder / f"{name}.py").write_text(EVIL)
    return empty_folder


def started(words: Sequence[str]) -> subprocess.CompletedProcess[str]:
    environment = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONSAFEPATH")}
    return subprocess.run(words, env=environment, capture_output=True, text=True, timeout=180)


@pytest.mark.parametrize("what", START)
def test_a_process_that_is_started_imports_what_is_installed(
    hostile: Path, what: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    # as the installed command: its own folder of modules is not the working folder
    script = tmp_path_factory.mktemp("bin") / "starts.py"
    script.write_text(f"if __name__ == '__main__':\n    {START[what].replace(chr(10), chr(10) + '    ')}\n")
    done = started([sys.executable, str(script)])
    assert not (hostile / "PWNED").exists(), (hostile / "PWNED").read_text()
    assert done.returncode == 0 and SHOWN[what] in done.stdout, done.stderr


def test_a_notebooks_own_processes_stay_as_they_are() -> None:
    from hjcamp.children import SAFE, safe_children

    before = os.environ.get(SAFE)
    with safe_children():
        pass
    assert os.environ.get(SAFE) == before


def test_the_command_keeps_its_children_safe(hostile: Path) -> None:
    command = Path(sys.executable).with_name("hjcamp")
    code = "import os; print('safe', os.environ.get('PYTHONSAFEPATH'))"
    (hostile / "effects").mkdir()
    (hostile / "effects" / "asks.py").write_text(code)
    done = started([str(command), "effects"])
    assert "safe 1" in done.stdout and not (hostile / "PWNED").exists(), done.stderr
