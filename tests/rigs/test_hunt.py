"""hjcamp hunt: rounds until one verdict stands, no test tells more or the budget is spent; stopped anywhere it goes on."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hunted import Script, contents, course, hunt, hunted, said
from lab_of_rigs import RIG

from hjcamp.campaign import conclude, runner
from hjcamp.commands.diagnosing import hunt as command
from hjcamp.commands.hunting import any_plant, record, turns
from hjcamp.commands.hunting.budget import seconds_of
from hjcamp.errors import UsageError

ONE_OF = said("one_of", "spring", "soft_stop")
SPRING = said("effect", "spring")
OR_OUTSIDE = said("outside_library") | {"confidence_set": [["spring"], ["soft_stop"]]}
Follow = Callable[..., Script]


@pytest.fixture
def follow(lab: Path, monkeypatch: pytest.MonkeyPatch) -> Follow:
    """Return the function that lets a hunt be diagnosed by a script."""

    def by(script: Script, reports: bool = False) -> Script:
        monkeypatch.setattr(any_plant, "judged", script.judged)
        if not reports:  # the tables and the page of each run, which take most of the time
            monkeypatch.setattr(conclude, "_report", lambda folder, console: None)
        return script

    return by


def test_rounds_until_one_verdict_stands(follow: Follow, capsys: pytest.CaptureFixture[str]) -> None:
    script = follow(Script(ONE_OF, said("cannot_tell"), SPRING), reports=True)
    assert hunt("run_dir=out", "--json", "answer.json") == 0, capsys.readouterr().err
    found = hunted()
    assert (found["state"], found["reason"], found["verdict"], found["effects"]) == ("ended", "verdict", "effect", ["spring"])
    assert [len(conditions) for conditions in script.seen] == [1, 2, 3]  # each diagnosis is of all tests so far
    assert [one["run"] for one in found["rounds"]] == ["00_campaign", "01_tests", "02_tests"]
    logs = list(Path("out").rglob("*.mcap"))
    assert len(logs) == 6 and found["spent_s"] == pytest.approx(6 * 0.4, abs=0.02)
    page = Path("out/index.html").read_text()
    assert "cycloid: effect: spring" in page or "effect: spring" in page
    assert all(text in page for text in ("a larger motion, 0", "After round 0: spring, soft_stop", "One verdict stands"))
    assert "hjcamp add spring out/00_campaign out/01_tests out/02_tests --as with_spring" in capsys.readouterr().out
    before = Path("out/hunt.json").read_bytes()
    assert hunt("run_dir=out") == 0  # it has ended: nothing is made again
    assert Path("out/hunt.json").read_bytes() == before


@pytest.mark.parametrize(
    ("script", "words", "budget", "reason", "rounds"),
    [
        (Script(SPRING), (), "1min", "verdict", 1),
        (Script(said("outside_library")), (), "1min", "verdict", 1),
        (Script(said("effect", "spring", p=None)), (), "1min", "verdict", 1),
        # one of these names, or something outside: further tests
        (Script(OR_OUTSIDE, SPRING), (), "1min", "verdict", 2),
        # not at the level, or more than the noise floor is left: further tests
        (Script(said("effect", "spring", p=0.04), SPRING), ("--level", "0.02"), "1min", "verdict", 2),
        (Script(said("effect", "spring", error=3.0), SPRING), (), "1min", "verdict", 2),
        (Script(said("effect", "spring", error=3.0)), ("--within", "4"), "1min", "verdict", 1),
        # that nothing is missing stands once no test could show what the tests so far do not
        (Script(said("nothing_missing"), tests=0), (), "1min", "verdict", 1),
        (Script(said("nothing_missing")), (), "2s", "budget", 3),
        (Script(ONE_OF, tests=0), (), "1min", "no_test", 1),
        (Script(ONE_OF), (), "3s", "budget", 4),
    ],
)
def test_how_a_hunt_ends(follow: Follow, script: Script, words: tuple[str, ...], budget: str, reason: str, rounds: int) -> None:
    follow(script)
    assert hunt("run_dir=out", *words, budget=budget) == 0
    found = hunted()
    assert (found["state"], found["reason"], len(found["rounds"])) == ("ended", reason, rounds)
    assert found["spent_s"] <= found["budget_s"]


def test_what_the_budget_leaves_is_used_for_fewer_tests_and_repetitions(follow: Follow) -> None:
    follow(Script(ONE_OF, tests=2))
    assert hunt("run_dir=out", budget="2.1s") == 0  # 0.8 s for the campaign: two tests once each and, in what is left, one once
    assert [(len(one["tests"]), one["repetitions"]) for one in hunted()["rounds"]] == [(1, 2), (1, 2), (1, 1)]
    assert hunt("run_dir=out", budget="4s") == 0  # a larger budget goes on
    found = hunted()
    assert found["reason"] == "budget" and len(found["rounds"]) > 3 and found["budget_s"] == 4.0


class Killed(BaseException):
    """The process is gone: nothing that it would still do is done."""


def test_a_hunt_that_was_killed_goes_on_and_ends_as_one_that_was_not(follow: Follow, monkeypatch: pytest.MonkeyPatch) -> None:
    follow(Script(ONE_OF, ONE_OF, SPRING))
    assert hunt("run_dir=whole") == 0
    places = [(turns, "save"), (turns, "write_json"), (turns, "write_page"), (runner, "_run")]
    for at in range(1, 15, 3):
        writes, out = [0], Path(f"out{at}")

        def dying(real: Callable[..., Any], at: int = at, writes: list[int] = writes) -> Callable[..., Any]:
            def write(*given: Any, **more: Any) -> Any:
                writes[0] += 1
                if writes[0] >= at:
                    raise Killed
                return real(*given, **more)

            return write

        with monkeypatch.context() as dead:
            for module, name in places:
                dead.setattr(module, name, dying(getattr(module, name)))
            with pytest.raises(Killed):
                hunt(f"run_dir={out}")
        assert hunt(f"run_dir={out}") == 0
        assert course(hunted(out)) == course(hunted("whole")) and contents(out) == contents("whole")


@pytest.mark.parametrize("run_dir", [True, False])
def test_ctrl_c_keeps_what_is_there_and_the_same_call_goes_on(
    follow: Follow, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], run_dir: bool
) -> None:
    script = follow(Script(ONE_OF, SPRING))
    words = ("run_dir=out",) if run_dir else ()

    def interrupted(*given: Any) -> Any:
        if len(given[0].paths) == 2:
            raise KeyboardInterrupt
        return script.judged(*given)

    with monkeypatch.context() as pressed:
        pressed.setattr(any_plant, "judged", interrupted)
        assert hunt(*words) == 130
    [folder] = [path.parent for path in Path(".").rglob("hunt.json")]
    found = hunted(folder)
    assert found["state"] == "interrupted" and [one["made"] for one in found["rounds"]] == [True, True]
    assert f"run_dir={folder} goes on" in capsys.readouterr().err
    logs = contents(folder)
    assert hunt(*words) == 0
    assert contents(folder) == logs and hunted(folder)["reason"] == "verdict"
    if not run_dir:
        assert hunt(*words) == 0 and len(list(Path("hunts").rglob("hunt.json"))) == 2  # one that has ended is left alone


@pytest.mark.parametrize(
    ("words", "budget", "says"),
    [
        ((), "", "--budget is missing"),
        ((), "30", "with its unit, such as 90s, 30min or 2h"),
        ((), "-3min", "with its unit"),
        ((), "0s", "with its unit"),
        ((), "nan min", "with its unit"),
        ((), "31000h", "at most 30 days"),
        ((), "0.5s", "shorter than the campaign, which takes 0.0133 min"),
        (("--tests", "0"), "1min", "--tests 0: give a number from 1 to 12"),
        (("--level", "0"), "1min", "--level 0"),
        (("--within", "0.9"), "1min", "--within 0.9"),
        (("--within", "nan"), "1min", "--within nan"),
        (("--effort", "great"), "1min", "unknown effort 'great'"),
        (("--seed", "-1"), "1min", "--seed -1"),
        (("campaign=nowhere",), "1min", "nowhere"),
        (("run_dir=plants",), "1min", "run_dir=plants is there and is no hunt"),
        (("--only", "sprng"), "1min", "did you mean 'spring'"),
    ],
)
def test_a_call_that_makes_no_sense(
    lab: Path, capsys: pytest.CaptureFixture[str], words: tuple[str, ...], budget: str, says: str
) -> None:
    assert hunt(*words, budget=budget) == 2
    assert says in capsys.readouterr().err
    if "--only" not in words:
        assert not Path("hunts").exists()


def test_a_folder_with_another_hunt_is_refused_and_stays_as_it_is(follow: Follow, capsys: pytest.CaptureFixture[str]) -> None:
    follow(Script(SPRING))
    assert hunt("run_dir=out") == 0
    before = Path("out/hunt.json").read_bytes()
    for words in (("trajectory.amplitude_m=0.004",), ("--level", "0.01"), ("--seed", "2")):
        assert hunt("run_dir=out", *words) == 2
        assert "holds a hunt with another campaign or other settings" in capsys.readouterr().err
    assert Path("out/hunt.json").read_bytes() == before
    Path("out/hunt.json").write_bytes(before[:-20])
    assert hunt("run_dir=out") == 2 and "not JSON" in capsys.readouterr().err
    with pytest.raises(UsageError, match="campaign is missing"):
        Path("out/hunt.json").write_text(f'{{"schema": "{record.SCHEMA}"}}')
        record.read(Path("out"))


@pytest.mark.parametrize(("text", "seconds"), [("90s", 90.0), (" 30 min", 1800.0), ("1.5h", 5400.0)])
def test_budgets(text: str, seconds: float) -> None:
    assert seconds_of(text) == seconds


def test_a_real_rig_moves_only_where_somebody_says_so_and_it_was_checked(
    follow: Follow, lab: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    follow(Script(ONE_OF))
    (lab / "rigs" / "bench.py").write_text(
        RIG.replace('plant = "axis1"', 'plant = "axis1"\n    interlock = "mat at the bench"')
    )
    words = ("backend=rig", "rig=bench", "run_dir=out")
    assert hunt(*words) == 2  # nobody can be asked here
    assert "--yes-between lets it make the tests that stay within its limits" in capsys.readouterr().err
    assert not Path("out").exists()
    assert hunt(*words, "--yes-between") == 1
    assert "hjcamp rig check plant=axis1 rig=bench" in capsys.readouterr().err
    assert hunted()["state"] == "stopped" and not list(Path("out").rglob("*.mcap"))


def test_what_is_not_confirmed_is_not_made(follow: Follow, monkeypatch: pytest.MonkeyPatch) -> None:
    follow(Script(ONE_OF, SPRING))
    asked: list[str] = []
    answers = iter([False, True])

    def ask(text: str) -> bool:
        asked.append(text)
        return next(answers)

    monkeypatch.setattr(command, "question", lambda plan, yes_between: ask)
    assert hunt("run_dir=out") == 130 and len(hunted()["rounds"]) == 1
    assert hunt("run_dir=out") == 0 and hunted()["reason"] == "verdict"
    assert asked == ["a larger motion, 0"] * 2
