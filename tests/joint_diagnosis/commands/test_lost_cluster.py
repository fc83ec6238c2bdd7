"""A dask scheduler that is killed in the middle of the work is one message, soon."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import CancelledError
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from hjcamp.errors import HjcampError
from hjcamp.workers.pool import Crew

SCHEDULER = """
import sys
from distributed import LocalCluster
if __name__ == "__main__":
    with LocalCluster(n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None,
                      scheduler_port=0, protocol="tcp") as cluster:
        print(cluster.scheduler_address, flush=True)
        sys.stdin.read()
"""


@pytest.fixture
def scheduler(tmp_path: Path) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Yield a process that is scheduler and worker, and its address."""
    pytest.importorskip("distributed")
    (tmp_path / "cluster.py").write_text(SCHEDULER)
    command = [sys.executable, str(tmp_path / "cluster.py")]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        yield process, process.stdout.readline().strip()
        process.kill()


class KilledError(Exception):
    """What dask raises for a task whose workers die again and again."""


class LostClient:
    """A client whose cluster is lost at one of its calls."""

    def __init__(self, call: str, error: Exception) -> None:
        self.call, self.error = call, error

    def _answer(self, call: str) -> Any:
        if call == self.call:
            raise self.error
        return self

    def scatter(self, *context: object, **options: object) -> Any:
        return self._answer("scatter")

    def submit(self, *task: object, **options: object) -> Any:
        return self._answer("submit")

    def result(self) -> Any:
        return self._answer("result")

    def cancel(self, futures: object) -> None:
        raise OSError("nobody answers")

    def close(self) -> None:
        pass


@pytest.mark.parametrize("call", ["scatter", "submit", "result"])
@pytest.mark.parametrize("error", [CancelledError("lost dependencies"), OSError("closed"), KilledError("4 workers died")])
def test_whatever_is_lost_is_one_message(call: str, error: Exception, monkeypatch: pytest.MonkeyPatch) -> None:
    names = {"client": {"CancelledError": CancelledError}, "scheduler": {"KilledWorker": KilledError}}
    for name, content in {"": {}, **names}.items():
        module = ModuleType(f"distributed.{name}".rstrip("."))
        vars(module).update(content)
        monkeypatch.setitem(sys.modules, module.__name__, module)
    crew = Crew(1)
    crew._client = LostClient(call, error)
    with pytest.raises(HjcampError, match=f"the dask cluster is gone: {error}"):
        list(crew.each(pow, 2.0, range(3)))


@pytest.mark.filterwarnings("ignore")
def test_a_scheduler_that_is_killed_is_one_message(scheduler: tuple[subprocess.Popen[str], str]) -> None:
    process, address = scheduler
    crew = Crew(1, address)

    def late(seconds: float, item: int) -> float:  # in here, so that it goes to the worker by value
        time.sleep(seconds)
        return float(item)

    try:
        results = crew.each(late, 0.2, range(50))
        assert next(results) == 0.0
        process.kill()
        with pytest.raises(HjcampError, match="the dask cluster is gone: "):
            list(results)
    finally:
        crew.close()
