"""Run the cases of a benchmark on a dask cluster whose workers see this folder."""

from __future__ import annotations

import pickle
from collections.abc import Iterator, Sequence
from typing import Any

from benchmarks import ROOT
from hjcamp.cluster import as_done, connected, imported


def there(module: str, function: str, calls: Sequence[tuple[Any, ...]], address: str) -> Iterator[Any]:
    """Yield ``function(*call)`` of a module of the benchmarks for each call as it ends; what a lost worker had is done again.

    The answers are those of a local run; processor seconds are right with one thread a worker.
    """
    folder = str(ROOT)
    work = [(folder, module, function, pickle.dumps(call)) for call in calls]
    client = connected(address)
    try:
        for _, result in as_done(client, imported, work):
            yield result
    finally:
        client.close()
