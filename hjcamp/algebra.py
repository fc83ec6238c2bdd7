"""How many threads linear algebra takes."""

from __future__ import annotations


def take_one_thread() -> None:
    """Let the linear algebra of this process, loaded before, use one thread: sums in another order round otherwise.

    The matrices are small, and threads that wait for each other take more time than they save.
    """
    import scipy.linalg  # noqa: F401
    from threadpoolctl import threadpool_limits

    threadpool_limits(1, user_api="blas")
