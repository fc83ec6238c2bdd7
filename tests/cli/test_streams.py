"""Closed streams, a language without letters, and files of the user's that fail in odd ways: one sentence, the right code."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from hjcamp import cli
from hjcamp.configuration.composer import Composer
from hjcamp.errors import UsageError
from hjcamp.memory import NEEDED_MB
from hjcamp.model.files.user_file import load_module
from hjcamp.records.recover import verify_log

HJCAMP = [sys.executable, "-m", "hjcamp"]
RUN = ["run", "campaign=controllers", "conditions=ramp_pos__pid", "repetitions=1", "workers=1"]


def called(words: list[str], closed: str = "", **environment: str) -> subprocess.CompletedProcess[str]:
    """Return what a call of the installed program gave, with the streams of some numbers closed before it begins."""
    shell = f'exec "$@" {" ".join(f"{number}>&-" for number in closed)}'
    given = {**os.environ, **environment}
    text = {"text": True, "encoding": "utf-8", "errors": "replace"}
    return subprocess.run(["sh", "-c", shell, "sh", *HJCAMP, *words], env=given, capture_output=True, timeout=300, **text)


CALLS = [(["explain", "floor"], 0, "1"), (["nosuch"], 2, "1"), (["explain", "floor"], 0, "012"), (["plan", "x=1"], 2, "012")]


@pytest.mark.parametrize(("words", "code", "closed"), CALLS)
def test_a_stream_that_is_closed_changes_no_answer(empty_folder: Path, words: list[str], code: int, closed: str) -> None:
    done = called(words, closed)
    assert done.returncode == code
    assert "Traceback" not in done.stdout + done.stderr and not list(empty_folder.iterdir())
    if "2" not in closed:
        assert len(done.stderr.splitlines()) == (code != 0)


WITHOUT_LETTERS = {"PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "LC_ALL": "C"}


@pytest.mark.skipif(os.name == "nt", reason="Windows names files in Unicode")
def test_a_run_without_streams_in_a_language_without_letters_is_whole(empty_folder: Path) -> None:
    assert called([*RUN, "run_dir='r ä'"], "12", **WITHOUT_LETTERS).returncode == 0
    assert [one.name for one in empty_folder.iterdir()] == ["r ä"]
    [log] = Path("r ä").rglob("*.mcap")
    assert b"hjcamp:" not in log.read_bytes() and verify_log(log).whole


@pytest.mark.skipif(os.name == "nt", reason="Windows names files in Unicode")
def test_a_language_without_letters_is_no_hindrance_to_what_is_printed(empty_folder: Path) -> None:
    done = called(["plan", "campaign=ä"], **WITHOUT_LETTERS)
    assert done.returncode == 2 and "Traceback" not in done.stderr and len(done.stderr.splitlines()) == 1
    assert "ä" in done.stderr or r"\xe4" in done.stderr


@pytest.mark.study
@pytest.mark.skipif(os.name == "nt", reason="Windows names files in Unicode")
def test_an_encoding_of_output_without_these_letters_is_no_hindrance(empty_folder: Path) -> None:
    done = called([*RUN, "run_dir='r ä'"], **(WITHOUT_LETTERS | {"LC_ALL": "C.UTF-8", "PYTHONIOENCODING": "latin-1"}))
    assert done.returncode == 0, done.stderr
    assert [one.name for one in empty_folder.iterdir()] == ["r ä"] and len(list(Path("r ä").rglob("*.mcap"))) == 1


FAILS = "class Mute(Exception):\n    def __str__(self):\n        raise ValueError('no text')\n\n    __repr__ = __str__\n\n\n"


RAISED = ["raise Mute", "raise SystemExit(Mute())", "raise RuntimeError from Mute()", "raise TypeError(Mute())"]


@pytest.mark.parametrize("raised", RAISED)
def test_an_exception_that_cannot_say_itself_is_one_sentence(empty_folder: Path, raised: str) -> None:
    (empty_folder / "effects").mkdir()
    (empty_folder / "effects" / "mine.py").write_text(f"{FAILS}{raised}\n")
    with pytest.raises(UsageError, match=r"effects/mine\.py: line 8: ") as told:
        load_module(Path("effects/mine.py"))
    assert "\n" not in str(told.value)


@pytest.mark.parametrize("group", ["controller", "trajectory"])
def test_a_choice_that_puts_itself_elsewhere_is_named(empty_folder: Path, group: str) -> None:
    (empty_folder / "conf" / group).mkdir(parents=True)
    (empty_folder / "conf" / group / "mine.yaml").write_text("# @package _global_\na: 1\n")
    with pytest.raises(UsageError, match=f"{group}=mine: this choice gives no '{group}'"):
        Composer().compose([f"{group}=mine"])


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="asks Linux")
def test_little_memory_is_told_from_a_mistake() -> None:
    code = "import resource, sys\nfrom hjcamp.memory import LIBRARY_MB, memory_is_short\n"
    code += "assert not memory_is_short()\n"
    code += "used = int(open('/proc/self/statm').read().split()[0]) * resource.getpagesize()\n"
    code += "resource.setrlimit(resource.RLIMIT_AS, (used + LIBRARY_MB * 2**19,) * 2)\nassert memory_is_short()\n"
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="asks Linux")
@pytest.mark.parametrize("library", NEEDED_MB)
def test_a_library_that_has_no_room_is_not_loaded(library: str) -> None:
    needed = NEEDED_MB[library]
    lines = (
        "import resource",
        "from hjcamp import cli, memory",
        "used = int(open('/proc/self/statm').read().split()[0]) * resource.getpagesize()",
        f"resource.setrlimit(resource.RLIMIT_AS, (used + {needed - 20} * 2**20, resource.RLIM_INFINITY))",
        "memory.guard_memory()",
        f"cli.app = lambda **words: __import__('{library}')",
        "raise SystemExit(cli.run(['ls']))",
    )
    done = subprocess.run([sys.executable, "-c", "\n".join(lines)], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1, done.stderr
    assert re.fullmatch(rf"hjcamp: not enough memory: .* leaves \d+ MB, and {library} takes {needed}\n", done.stderr)


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_a_second_interrupt_in_the_midst_of_the_first_ends_with_its_code() -> None:
    code = (
        # a shell lets what it starts in the background ignore Ctrl-C
        "import os, signal, sys\nsignal.signal(signal.SIGINT, signal.default_int_handler)\nfrom hjcamp import cli\n"
        "def once(text, code):\n    os.kill(os.getpid(), signal.SIGINT)\n"
        "cli._say, cli.app = once, lambda **words: os.kill(os.getpid(), signal.SIGINT)\n"
        "import atexit\natexit.register(lambda: os.kill(os.getpid(), signal.SIGINT))\ncli.main()\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 130 and not done.stderr


def test_an_interrupt_that_a_library_turns_into_another_error_is_one(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def loads(**words: object) -> None:
        try:
            raise KeyboardInterrupt
        except KeyboardInterrupt as reason:
            raise ImportError("initialization failed") from reason

    monkeypatch.setattr(cli, "app", loads)
    assert cli.run(["ls"]) == 130 and capsys.readouterr().err == "hjcamp: interrupted\n"
