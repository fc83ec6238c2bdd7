"""What numba keeps of a compiled kernel: a damaged file is compiled again, and a disk that refuses is no fault."""

from __future__ import annotations

import hashlib
import os
import pickle
import types
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.dispatcher import Dispatcher

from hjcamp.model.kernel_cache import remove

SEAL = b"hjcamp"  # stands before the hash at the end of an object file; numba itself reads no further than its pickle


def guard(module: types.ModuleType, say_once: Callable[[str], None]) -> None:
    """Let every compiled function of a kernel keep its code in files that may be damaged."""
    found: list[Any] = [one for one in vars(module).values() if isinstance(one, Dispatcher)]
    for function in found:
        if isinstance(function._cache, FunctionCache):
            function._cache = KernelCache(function._cache, say_once)


class KernelCache(FunctionCache):
    """numba's cache of one function, in which a damaged file means: compile it again, and a full disk: do not keep it."""

    def __init__(self, plain: FunctionCache, say_once: Callable[[str], None]) -> None:
        vars(self).update(vars(plain))
        self._say_once = say_once
        self._cache_file = SealedFile(plain._cache_path, plain._impl.filename_base, plain._cache_file._source_stamp)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return what was compiled for these types, or None where it is not there or cannot be read."""
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # pickle raises almost anything; whatever it is, the text is there to be compiled
            remove(Path(self._cache_path).glob(f"{self._impl.filename_base}.*"))
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep what was compiled, if the disk takes it."""
        try:
            super().save_overload(sig, data)
        except OSError as problem:
            self._say_once(f"the cache folder {self._cache_path} cannot be written ({problem.strerror or problem})")


class SealedFile(IndexDataCacheFile):
    """numba's index and object files; each is on the disk before it has its name, and an object file ends with its hash.

    Machine code with one wrong byte would be executed, not refused.
    """

    def _save_data(self, name: str, data: Any) -> None:
        content = self._dump(data)
        with self._open_for_write(self._data_path(name)) as stream:
            stream.write(content + SEAL + hashlib.sha256(content).digest())

    def _load_data(self, name: str) -> Any:
        content = Path(self._data_path(name)).read_bytes()
        length = len(content) - len(SEAL) - hashlib.sha256().digest_size
        # One without a seal was written by numba alone; it is whole if its pickle is.
        if (
            content[length:].startswith(SEAL)
            and content[length + len(SEAL) :] != hashlib.sha256(content[:length]).digest()
        ):
            raise ValueError(f"{name} is damaged")
        return pickle.loads(content)

    @contextmanager
    def _open_for_write(self, filepath: str) -> Iterator[IO[bytes]]:
        with super()._open_for_write(filepath) as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
