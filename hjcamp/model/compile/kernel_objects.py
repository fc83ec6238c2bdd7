"""What numba keeps of a compiled kernel: a damaged file is compiled again, and a disk that refuses is no fault."""

from __future__ import annotations

import gc
import hashlib
import os
import pickle
import sys
import time
import types
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any

import numba
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher
from numba.core.registry import cpu_target

from hjcamp.storage import remove_files

# A large kernel takes 20 s of a processor, and minutes where others use it too. Another process that holds a lock may be stopped:
# then the function is compiled twice.
PATIENCE_S = 240.0
# Asked for while this file is imported: two threads that ask numba first would get a compiler each.
PROCESSOR = cpu_target.target_context.codegen().magic_tuple()
SEAL = b"hjcamp"  # stands before the hash at the end of an object file; numba itself reads no further than its pickle


def guard(module: types.ModuleType, say_once: Callable[[str], None]) -> None:
    """Let every compiled function of a kernel keep its code in files that may be damaged."""
    found: list[Any] = [one for one in vars(module).values() if isinstance(one, Dispatcher)]
    for function in found:
        # what a kernel imports from the file that all share is guarded there
        if isinstance(function._cache, FunctionCache) and not isinstance(function._cache, KernelCache):
            function._cache = KernelCache(function._cache, say_once)
            function.compile = _one_process(function)


def serves(index: Path) -> bool:
    """Return whether what an index of numba's names is there, and was compiled by this version for this processor."""
    try:
        with index.open("rb") as stream:
            if pickle.load(stream) != numba.__version__:
                return False
            _, overloads = pickle.load(stream)
        return any(made_for == PROCESSOR and (index.parent / name).exists() for (_, made_for, _), name in overloads.items())
    except Exception:  # pickle raises almost anything; what cannot be read is compiled again
        return False


def _one_process(function: Any) -> Callable[[Any], Any]:
    """Return what compiles the function, or waits while another process does, and reads what that has made."""
    compiled, path = function.compile, Path(function._cache._cache_path) / f"{function._cache._impl.filename_base}.lock"

    def compile_alone(sig: Any) -> Any:
        # numba's own lock first: another thread that holds it may want this one
        with global_compiler_lock, _held(path), _uncollected():
            return compiled(sig)

    return compile_alone


@contextmanager
def _uncollected() -> Iterator[None]:
    """Let the collector of garbage wait: a tenth of compiling, which makes many objects and keeps most."""
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()


@contextmanager
def _held(path: Path) -> Iterator[None]:
    """Hold a lock that other processes wait for, each for a while; without it where the disk gives none."""
    descriptor = -1
    with suppress(OSError):
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        _wait_for(descriptor)
    try:
        yield
    finally:
        if descriptor >= 0:
            # who comes later has no need of it: what was compiled is there
            remove_files([path])
            os.close(descriptor)


def _wait_for(descriptor: int) -> None:
    if sys.platform == "win32":
        return
    import fcntl

    last = time.monotonic() + PATIENCE_S
    while time.monotonic() < last:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            time.sleep(0.02)
        else:
            return


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
            remove_files(Path(self._cache_path).glob(f"{self._impl.filename_base}.*"))
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
        if content[length:].startswith(SEAL) and content[length + len(SEAL) :] != hashlib.sha256(content[:length]).digest():
            raise ValueError(f"{name} is damaged")
        return pickle.loads(content)

    @contextmanager
    def _open_for_write(self, filepath: str) -> Iterator[IO[bytes]]:
        with super()._open_for_write(filepath) as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
