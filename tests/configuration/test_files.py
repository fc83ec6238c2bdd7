"""Configuration files that cannot be read, refer to themselves, or grow without bounds: one message with the file's name."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from hjcamp.campaign.plan.planning import make_plan
from hjcamp.configuration.composer import Composer
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.calibrate.constants import attached_configuration
from hjcamp.records.elsewhere.import_map import read_import_map
from hjcamp.records.log import TestLog
from hjcamp.report.check import read_tolerances
from hjcamp.report.runs.indicators import configuration
from hjcamp.report.tables.declared import read_definition
from hjcamp.yaml_file import read_yaml

NINE = ["name: bomb", "x0: &x0 [a,a,a,a,a,a,a,a,a]"]
NINE += [f"x{depth}: &x{depth} [{','.join([f'*x{depth - 1}'] * 9)}]" for depth in range(1, 9)]
BOMB = "\n".join([*NINE, "vary: {controller: [pid]}\n"])


def plan_of(*lines: str) -> Any:
    composer = Composer()
    asked = composer.compose(lines)
    return make_plan(asked.config, asked.choices.get("campaign"), lines, composer)


def write(path: Path, content: str | bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content.encode() if isinstance(content, str) else content)


@pytest.mark.parametrize(
    ("file", "content", "line", "words"),
    [
        ("conf/payload/none.yaml", "defaults: [none]\nname: none\n", "seed=1", "refers to itself: the defaults of payload/none"),
        ("conf/payload/none.yaml", b"name: none\nmass_g: \xff\n", "seed=1", "none.yaml: line 2: this is not UTF-8 text"),
        ("conf/payload/none.yaml", "a: &a [*a]\n", "seed=1", "none.yaml: a value holds itself"),
        ("conf/payload/none.yaml", "mass_g: ${payload.mass_g}\n", "seed=1", "Recursive interpolation"),
        ("conf/payload/none.yaml", f"mass_g: {'1' * 5000}\n", "seed=1", "Exceeds the limit (4300 digits)"),
        ("conf/tubing/bomb.yaml", BOMB, "tubing=bomb", "bomb.yaml holds 4.9e+08 values"),
        ("conf/tubing/bomb.yaml", "- a\n- b\n", "tubing=bomb", "bomb.yaml: names with values are needed"),
        ("conf/tubing/bomb.yaml", "3", "tubing=bomb", "bomb.yaml: names with values are needed"),
        ("campaigns/mine.yaml", BOMB, "campaign=mine", "mine.yaml holds 4.9e+08 values"),
        ("campaigns/mine.yaml", b"name: \xff", "campaign=mine", "mine.yaml: line 1: this is not UTF-8 text"),
        ("campaigns/mine.yaml", "", "campaign=mine", "mine.yaml holds no keys"),
        ("campaigns/mine.yaml", "[1]", "campaign=mine", "mine.yaml holds no keys"),
        ("campaigns/mine.yaml", "vary: [", "campaign=mine", "mine.yaml: while parsing"),
        ("campaigns/mine.yaml/file", "", "campaign=mine", "mine.yaml cannot be read: Is a directory"),
    ],
)  # fmt: skip
def test_refused_by_name(empty_folder: Path, file: str, content: str | bytes, line: str, words: str) -> None:
    write(empty_folder / file, content)
    with pytest.raises(UsageError) as caught:
        plan_of(line)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("reader", [read_import_map, read_tolerances, read_definition, read_yaml], ids=lambda one: one.__name__)
def test_aliases_of_aliases_in_other_files(empty_folder: Path, reader: Callable[[Path], object]) -> None:
    begin = time.monotonic()
    for content, words in (
        (BOMB.encode(), "holds 4.9e+08 values"),
        (b"a: &a [*a]\n", "holds itself"),
        (b"[" * 5000, ""),
        (b"a: 2001-99-99\n", ""),
        (b"a: \xff\n", "line 1: this is not UTF-8 text"),
    ):
        write(empty_folder / "mine.yaml", content)
        with pytest.raises(UsageError) as caught:
            reader(empty_folder / "mine.yaml")
        assert "mine.yaml" in str(caught.value) and words in str(caught.value) and "\n" not in str(caught.value)
    assert time.monotonic() - begin < 20.0


def test_a_log_with_aliases_of_aliases_counts_as_one_without_configuration() -> None:
    begin = time.monotonic()
    assert (
        configuration(BOMB.encode()) == {} and attached_configuration(TestLog({}, {}, {"config.yaml": BOMB.encode()})) is None
    )
    assert time.monotonic() - begin < 20.0


def test_two_files_that_refer_to_each_other(empty_folder: Path) -> None:
    write(empty_folder / "conf/payload/none.yaml", "defaults: [/payload/other]\nname: none\n")
    write(empty_folder / "conf/payload/other.yaml", "defaults: [/payload/none]\n")
    with pytest.raises(UsageError, match="the defaults of payload/none, payload/other"):
        plan_of()


def test_a_loop_of_links_is_named(empty_folder: Path) -> None:
    (empty_folder / "campaigns").mkdir()
    (empty_folder / "campaigns" / "mine.yaml").symlink_to("mine.yaml")
    with pytest.raises(UsageError, match=r"mine\.yaml cannot be read: Too many levels"):
        plan_of("campaign=mine")


def test_aliases_are_fine_where_they_are_few(empty_folder: Path) -> None:
    text = "name: mine\nvary:\n  case:\n    a: {controller.positive: &gains {kp: 1.0, ki: 1.0, kd: 0.1}}\n"
    write(empty_folder / "campaigns/mine.yaml", text + "    b: {controller.negative: *gains}\n")
    assert len(plan_of("campaign=mine").conditions) == 2


def test_a_million_conditions_and_a_billion_repetitions_are_refused_at_once(empty_folder: Path) -> None:
    values = ", ".join(f"{number / 1000}" for number in range(100))
    axes = "".join(f"  controller.positive.{name}: [{values}]\n" for name in ("kp", "ki", "kd"))
    write(empty_folder / "campaigns/mine.yaml", f"name: mine\nvary:\n{axes}")
    begin = time.monotonic()
    with pytest.raises(UsageError, match=r"100 x 100 x 100 = 1000000 conditions; .* most_tests=1000000"):
        plan_of("campaign=mine")
    with pytest.raises(UsageError) as caught:
        plan_of("campaign=controllers", "repetitions=1000000000")
    assert "14 conditions x 1000000000 repetitions = 14000000000 tests, some 1.62e+05 days" in str(caught.value)
    with pytest.raises(UsageError, match=r"1 condition x 3 repetitions = 3 tests.*unless you say most_tests=3"):
        plan_of("repetitions=3", "most_tests=2")
    assert time.monotonic() - begin < 60.0
    assert len(plan_of("repetitions=3", "most_tests=3").tests) == 3
