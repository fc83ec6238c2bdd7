"""The cache of kernels: threads and processes may want one kernel at once, and any file of it may be damaged."""

from __future__ import annotations

import errno
import os
import pickle
import subprocess
import sys
import threading
import time
import types
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

import hjcamp
from hjcamp.model.compile import kernel_cache
from hjcamp.model.compile.kernel_cache import cache_folder, is_compiled, kernel_name, load_kernel

TINY = '''"""A kernel that takes its time to load."""
import time
{decorator}
time.sleep(0.05)


@hot
def added(x, y):
    return x + y


@entry
def prepare(x):
    return added(x, 1.0)
'''
pytestmark = pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="nothing is compiled")


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cold cache."""
    monkeypatch.setenv("HJCAMP_CACHE", str(tmp_path / "cache"))
    kernel_cache.say_once.cache_clear()
    return tmp_path / "cache" / "kernels"


def fresh(source: str = TINY) -> types.ModuleType:
    """Load the kernel as a process does that has not had it before."""
    load_kernel.cache_clear()
    sys.modules.pop(kernel_name(source), None)
    return load_kernel(source)


def made_of(pattern: str) -> Path:
    """Return the one file of the tiny kernel's ``prepare`` that the pattern names."""
    return next((cache_folder() / "__pycache__").glob(f"{kernel_name(TINY)}.prepare-{pattern}"))


def test_threads_get_a_whole_kernel() -> None:
    for number in range(5):
        source = TINY + f"\n# {number}\n"
        together = threading.Barrier(4)

        def load(source: str = source, together: threading.Barrier = together) -> types.ModuleType:
            together.wait()
            module = load_kernel(source)
            assert hasattr(module, "prepare"), "a half-executed module"
            return module

        with ThreadPoolExecutor(4) as pool:
            assert len(set(pool.map(lambda _: load(), range(4)))) == 1


def test_a_kernel_that_fails_is_not_kept() -> None:
    broken = TINY + "\nif not broken:\n    pass\n"
    for _ in range(2):
        with pytest.raises(NameError):
            load_kernel(broken)
        assert kernel_name(broken) not in sys.modules


def cut(path: Path) -> None:
    """Leave the first half."""
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def zeros(path: Path) -> None:
    """Leave zeros where the end was, as a power cut does."""
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2] + bytes(len(content) - len(content) // 2))


def one_wrong_byte(path: Path) -> None:
    """Change a byte in the middle of the machine code."""
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0xFF
    path.write_bytes(content)


def other_version(path: Path) -> None:
    """Write what another version of numba would."""
    path.write_bytes(pickle.dumps("0.0.1") + b"nobody can read this")


@pytest.mark.parametrize("name", ["*.nbi", "*.nbc"])
@pytest.mark.parametrize("damage", [cut, zeros, one_wrong_byte, other_version, lambda path: path.write_bytes(b"")])
def test_what_numba_keeps_may_be_damaged(name: str, damage: Callable[[Path], None]) -> None:
    assert fresh().prepare(1.0) == 2.0
    assert sum(fresh().prepare.stats.cache_hits.values()) == 0
    damage(made_of(name))
    again = fresh()
    assert again.prepare(1.0) == 2.0 and not again.prepare.stats.cache_hits, "damaged, and yet it was used"
    healed = fresh()
    assert healed.prepare(1.0) == 2.0 and healed.prepare.stats.cache_hits, "not kept again"


@pytest.mark.parametrize("text", ["", "# cut off\n", TINY.replace("{decorator}", "from numba import njit\n"), "\x00\xff"])
def test_a_changed_text_is_not_executed(text: str, own_cache: Path) -> None:
    assert fresh().prepare(1.0) == 2.0
    path = own_cache / f"{kernel_name(TINY)}.py"
    whole = path.read_bytes()
    path.write_text(text)
    assert fresh().prepare(1.0) == 2.0
    assert path.read_bytes() == whole


def test_a_line_that_somebody_added_is_not_executed(own_cache: Path, tmp_path: Path) -> None:
    fresh()
    path = own_cache / f"{kernel_name(TINY)}.py"
    path.write_text(path.read_text() + f"\nopen({str(tmp_path / 'marker')!r}, 'w')\n")
    fresh()
    assert not (tmp_path / "marker").exists() and "marker" not in path.read_text()


def test_what_a_killed_process_left_does_not_hinder_and_goes(own_cache: Path) -> None:
    fresh().prepare(1.0)
    old = [own_cache / f"{kernel_name(TINY)}.py.0123.part", Path(f"{made_of('*.nbi')}.tmp.0123")]
    new = own_cache / "of_another_process.part"
    for path in (*old, new):
        path.write_bytes(b"half")
    for path in old:
        os.utime(path, (time.time() - 1e5,) * 2)
    made_of("*.nbc").unlink()
    assert fresh().prepare(1.0) == 2.0
    fresh(TINY + "\n# another\n")
    assert not any(path.exists() for path in old) and new.exists()


def test_a_cache_of_another_version_or_processor_is_known_as_none() -> None:
    assert not is_compiled(TINY, "prepare")
    assert fresh().prepare(1.0) == 2.0
    assert is_compiled(TINY, "prepare")
    index = made_of("*.nbi")
    with index.open("rb") as stream:
        version, (stamp, overloads) = pickle.load(stream), pickle.load(stream)

    def kept(by: str, made: dict[Any, str]) -> bool:
        index.write_bytes(pickle.dumps(by) + pickle.dumps((stamp, made)))
        return is_compiled(TINY, "prepare")

    assert kept(version, overloads)
    assert not kept("0.1.0", overloads)
    (signature, (triple, _, features), code), name = next(iter(overloads.items()))
    elsewhere = {(signature, (triple, "another processor", features), code): name}
    assert not kept(version, elsewhere)
    assert kept(version, elsewhere | overloads)
    made_of("*.nbc").unlink()
    assert not is_compiled(TINY, "prepare")
    index.write_bytes(b"cut off")
    assert not is_compiled(TINY, "prepare")
    assert fresh().prepare(1.0) == 2.0


def test_two_processes_compile_one_kernel(own_cache: Path) -> None:
    script = (
        f"from hjcamp.model.compile.kernel_cache import load_kernel\nmodule = load_kernel({TINY!r})\n"
        "print(module.prepare(1.0), sum(module.prepare.stats.cache_hits.values()))"
    )
    environment = {**os.environ, "PYTHONPATH": str(Path(hjcamp.__file__).parents[1])}
    both = [
        subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment)
        for _ in range(2)
    ]
    # one compiles, and the other waits for what that makes
    assert sorted(process.communicate(timeout=120)[0] for process in both) == [b"2.0 0\n", b"2.0 1\n"]
    third = fresh()
    assert third.prepare(1.0) == 2.0 and third.prepare.stats.cache_hits
    assert not [*own_cache.rglob("*.part"), *own_cache.rglob("*.tmp.*"), *own_cache.rglob("*.lock")]


def test_a_kernel_that_calls_what_others_share_does_not_wait_for_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    def waits(seconds: float) -> None:
        raise AssertionError("no other process holds the lock")

    fresh()
    source = TINY.replace("time.sleep(0.05)", f"from {kernel_name(TINY)} import prepare as shared")
    source = source.replace("added(x, 1.0)", "shared(x)")
    monkeypatch.setattr("hjcamp.model.compile.kernel_objects.time.sleep", waits)
    assert fresh(source).prepare(1.0) == 2.0


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EACCES])
def test_a_disk_that_refuses(
    number: int, own_cache: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The text cannot be written; then it can, but what numba compiled cannot."""

    def refuse(*arguments: object) -> None:
        raise OSError(number, os.strerror(number))

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", refuse)
        assert fresh().prepare(1.0) == 2.0
    assert not list(own_cache.rglob("*"))
    module = fresh()
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", refuse)
        assert module.prepare(1.0) == 2.0
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 2 and all("cannot be written" in line and os.strerror(number) in line for line in told), told
    assert fresh().prepare(1.0) == 2.0 and not capsys.readouterr().err


def test_no_folder_at_all_takes_what_numba_compiles(
    own_cache: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from numba.core import caching

    def refuse(self: object) -> None:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    monkeypatch.setattr(caching._CacheLocator, "ensure_cache_path", refuse)
    assert fresh().prepare(1.0) == 2.0
    assert "cannot be written" in capsys.readouterr().err


def test_a_kernel_without_a_home(monkeypatch: pytest.MonkeyPatch) -> None:
    def homeless() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("HJCAMP_CACHE")
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(Path, "home", homeless)
    kernel_cache._temporary_folder.cache_clear()
    assert cache_folder().parent.name.startswith(kernel_cache.TEMPORARY)
    assert fresh().prepare(1.0) == 2.0
    kernel_cache._temporary_folder.cache_clear()
