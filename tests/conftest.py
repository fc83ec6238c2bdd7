"""A composer that is made once, an empty working folder, and a look at every answer for programs."""

from __future__ import annotations

import gc
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

# Before numpy is loaded: as many processes as processors run tests, and threads that wait for each other only take time.
os.environ["OPENBLAS_NUM_THREADS"] = "1"

import pytest
from answer_schemas import check_answer

from hjcamp.commands.shared import session
from hjcamp.configuration.composer import Composer


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """One process more than there are processors: tests of clocks, servers and other processes wait a fifth of the time."""
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return usable + 1


#: Folders whose files take minutes, longest first: where they begin last, the other processes wait for them.
LONG = ("diagnosis", "notebook", "project", "joint_diagnosis", "effects", "plants", "rig", "model")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the files that take longest."""
    rank = {name: place for place, name in enumerate(LONG)}
    here = Path(__file__).parent
    items.sort(key=lambda item: rank.get(item.path.relative_to(here).parts[0], len(LONG)))


def pytest_collection_finish() -> None:
    """Let the collector of garbage pass over what is loaded by now, and look less often: a tenth of all the time."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000, 10, 10)


@pytest.fixture(scope="session")
def composer() -> Composer:
    """One composer over our own configuration."""
    return Composer()


@pytest.fixture(scope="session", autouse=True)
def nothing_is_compiled_ahead() -> Iterator[None]:
    """Compile what a test needs where it needs it: all processors work already, and much that a user may need no test does."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("hjcamp.diagnosis.residuals.kernels.compile_ahead", lambda sources: None)
        yield


@pytest.fixture
def empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in an empty folder without the user's settings."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("HJCAMP_CONF", raising=False)
    return tmp_path


@pytest.fixture(scope="session", autouse=True)
def every_answer_meets_its_schema() -> Iterator[None]:
    """Hold whatever a command answers in any test against its schema, whether or not the answer is written."""
    write = session.write_answer

    def checked(path: Path | None, answer: dict[str, Any]) -> None:
        check_answer(answer)
        write(path, answer)

    session.write_answer = checked
    yield
    session.write_answer = write
