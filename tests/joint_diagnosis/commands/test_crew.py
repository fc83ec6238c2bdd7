"""The same results in the same order with one worker, with several, and on a cluster."""

from __future__ import annotations

import pickle
import threading
import time

import pytest

from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.diagnosis.residuals.memo import Recent
from hjcamp.workers.pool import Crew, available


def _scaled(factor: float, item: int) -> float:
    return factor * item


@pytest.mark.parametrize("workers", [1, 2, 3])
def test_results_come_in_the_order_of_the_items(workers: int) -> None:
    crew = Crew(workers)
    try:
        assert list(crew.each(_scaled, 0.5, range(20))) == [0.5 * item for item in range(20)]
    finally:
        crew.close()


def test_work_inside_work_runs_without_waiting_for_a_free_thread() -> None:
    crew = Crew(2)
    try:
        sums = crew.together(lambda outer: sum(crew.together(lambda inner: outer * inner, range(4))), range(8))
        assert list(sums) == [6 * outer for outer in range(8)]
    finally:
        crew.close()


def test_a_failure_inside_work_is_told_and_the_rest_is_left() -> None:
    crew = Crew(2)
    done: list[int] = []

    def work(item: int) -> int:
        if item == 1:
            raise UsageError("no such test")
        time.sleep(1e-3)
        done.append(item)
        return item

    try:
        with pytest.raises(UsageError, match="no such test"):
            list(crew.together(work, range(1000)))
    finally:
        crew.close()
    assert len(done) < 999


def test_what_is_inside_is_shared_out_too() -> None:
    crew = Crew(2)
    seen: set[int] = set()
    both = threading.Barrier(2, timeout=20.0)

    def inner(item: int) -> int:
        both.wait()
        seen.add(threading.get_ident())
        return item

    try:
        assert list(crew.together(lambda outer: list(crew.together(inner, range(2))), [0])) == [[0, 1]]
    finally:
        crew.close()
    assert len(seen) == 2


def test_a_crew_in_another_process_is_one_worker() -> None:
    assert pickle.loads(pickle.dumps(Crew(4))).workers == 1
    assert available() >= 1


def test_a_scheduler_that_does_not_answer_is_one_message() -> None:
    with pytest.raises(UsageError, match=r"--cluster .*dask"):
        Crew(1, "nowhere")


def test_recent_computes_once_and_forgets_the_oldest() -> None:
    computed: list[int] = []

    def compute(key: int) -> int:
        computed.append(key)
        return key * key

    kept: Recent[int] = Recent(2)
    for key in (1, 2, 1, 3, 1, 2):
        assert kept.get(key, lambda key=key: compute(key)) == key * key
    assert computed == [1, 2, 3, 2]


def test_recent_serves_several_threads() -> None:
    kept: Recent[int] = Recent(4)
    found: list[int] = []
    threads = [threading.Thread(target=lambda key=key: found.append(kept.get(key % 4, lambda: key % 4))) for key in range(40)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(found) == sorted(key % 4 for key in range(40))


def test_linear_algebra_takes_one_thread() -> None:
    from threadpoolctl import threadpool_info, threadpool_limits

    with threadpool_limits(2, user_api="blas"):
        Crew(2)
        assert {row["num_threads"] for row in threadpool_info() if row["user_api"] == "blas"} == {1}
