"""Load a generated kernel as a module that numba compiles once and keeps; what is damaged there is made again.

Beyond the text itself nothing in the folder is needed: every file there may be missing, cut off or changed.
"""

from __future__ import annotations

import atexit
import functools
import hashlib
import os
import shutil
import sys
import tempfile
import threading
import time
import types
from contextlib import suppress
from pathlib import Path

from hjcamp.storage import remove_files, user_folder, write_whole

TEMPORARY = "hjcamp_kernels_"
# The hot functions do without numba's reference counts (``_nrt``): with them a sample costs 100 ns instead of 20. Only what
# Python calls is cached, and what has one caller is put into its text: all else would be compiled and kept once more. What
# Python never calls has no wrapper to be called by: that is a tenth of the compiling.
NUMBA = """from numba import njit
entry = njit(cache={cache}, error_model="numpy", nogil=True, _nrt=False, no_cfunc_wrapper=True)
inner = {{"error_model": "numpy", "nogil": True, "_nrt": False, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}}
hot = njit(**inner)
inlined = njit(**inner, forceinline=True)
once = njit(error_model="numpy", nogil=True, _nrt=False, inline="always")
from hjcamp.model.compile.vectors import Apart, ahead, strided
loop = njit(cache={cache}, error_model="numpy", nogil=True, _nrt=False, no_cfunc_wrapper=True, pipeline_class=Apart)
"""
VECTORS = Path(__file__).with_name("vectors.py")
LEFT_OVER_S = 3600.0
_loading = threading.Lock()


def cache_folder() -> Path:
    """Return the folder for generated kernels: $HJCAMP_CACHE, else the user's cache folder, else a temporary one."""
    chosen = os.environ.get("HJCAMP_CACHE")
    own = user_folder("XDG_CACHE_HOME", ".cache")
    base = Path(chosen) if chosen else own / "hjcamp" if own else None
    if base is not None:
        with suppress(OSError):
            (base / "kernels").mkdir(parents=True, exist_ok=True)
            if os.access(base / "kernels", os.W_OK):
                return base / "kernels"
    return _temporary_folder()


@functools.cache
def _temporary_folder() -> Path:
    base = Path(tempfile.mkdtemp(prefix=TEMPORARY))
    (base / "kernels").mkdir()
    # Worker processes share it, and it goes with the process that made it.
    os.environ["HJCAMP_CACHE"] = str(base)
    owner = os.getpid()
    atexit.register(lambda: shutil.rmtree(base, ignore_errors=True) if os.getpid() == owner else None)
    say_once("the cache folder cannot be written")
    return base / "kernels"


@functools.cache
def say_once(problem: str) -> None:
    """Say on standard error, once, why compiled kernels are not kept."""
    print(f"hjcamp: {problem}; kernels are compiled again in this call", file=sys.stderr)


def kernel_name(source: str) -> str:
    """Return the name of the kernel's module: the hash of its text and of how it is compiled."""
    return f"hjcamp_kernel_{hashlib.sha256(_compiling() + source.encode()).hexdigest()[:16]}"


@functools.cache
def _compiling() -> bytes:
    return NUMBA.encode() + VECTORS.read_bytes()


def is_compiled(source: str, last: str = "follow") -> bool:
    """Return whether a process has compiled the kernel before, up to the function that is compiled ``last``.

    Numba keeps an index of each function in the cache folder: of what it compiled in which version and for which processor.
    """
    found = list((cache_folder() / "__pycache__").glob(f"{kernel_name(source)}.{last}-*.nbi"))
    if not found:
        return False
    from hjcamp.model.compile.kernel_objects import serves  # numba takes its time to import

    return any(map(serves, found))


@functools.lru_cache(maxsize=64)
def load_kernel(source: str) -> types.ModuleType:
    """Return ``source`` as a module, which threads get when it is whole, and not before.

    What is executed is ``source`` itself; its file, named by the hash of the text, is where numba keeps what it
    compiled. Where that file cannot be written the kernel is compiled for this process alone.
    """
    name = kernel_name(source)
    with _loading:
        if name not in sys.modules:
            sys.modules[name] = _loaded(name, source)
        return sys.modules[name]


def written_file(source: str) -> Path:
    """Return the file of a kernel in the cache folder, written where it is not there."""
    return _written(kernel_name(source), _cached(source))


def load_written(path: Path) -> types.ModuleType:
    """Return the kernel of a file in the cache folder as a module whose functions are kept when they are compiled."""
    from hjcamp.model.compile.kernel_objects import guard  # numba takes its time to import

    # numba looks its functions up by the name of their module
    sys.modules[path.stem] = module = _executed(path.stem, path.read_bytes().decode(), str(path))
    guard(module, say_once)
    return module


def _cached(source: str) -> str:
    return source.replace("{decorator}", NUMBA.format(cache=True))


def _loaded(name: str, source: str) -> types.ModuleType:
    from hjcamp.model.compile.kernel_objects import guard  # numba takes its time to import

    try:
        module = _executed(name, _cached(source), str(written_file(source)))
    except (OSError, RuntimeError) as problem:  # numba's RuntimeError: no folder takes what it compiles
        reason = getattr(problem, "strerror", None) or problem
        say_once(f"the cache folder {cache_folder()} cannot be written ({reason})")
        return _executed(name, source.replace("{decorator}", NUMBA.format(cache=False)), f"<{name}>")
    guard(module, say_once)
    return module


def _executed(name: str, text: str, place: str) -> types.ModuleType:
    module = types.ModuleType(name)
    module.__file__ = place
    # Not from Python's own compiled file: nobody compares that with the text.
    exec(compile(text, place, "exec"), vars(module))
    return module


def _written(name: str, text: str) -> Path:
    """Return the file that holds just ``text``; one that holds another was damaged, and so may be what came from it."""
    path = cache_folder() / f"{name}.py"
    with suppress(FileNotFoundError):
        if path.read_bytes() == text.encode():
            return path
        remove_files(path.parent.glob(f"__pycache__/{name}.*"))
    write_whole(path, text, shared=True)
    left_over = [*path.parent.glob("*.part"), *path.parent.glob("__pycache__/*.tmp.*")]
    remove_files(one for one in left_over if _age(one) > LEFT_OVER_S)
    return path


def _age(path: Path) -> float:
    try:
        return time.time() - path.stat().st_mtime
    except OSError:
        return 0.0
