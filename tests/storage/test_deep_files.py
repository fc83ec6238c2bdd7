"""Files that are nested without end, or hold what no file takes: one sentence, before anything is read into memory."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from hjcamp import cli, json_text, yaml_file
from hjcamp.errors import UsageError
from hjcamp.json_text import json_values, read_json
from hjcamp.yaml_file import check_yaml, yaml_values

DEEP_YAML = [
    *("a: " + "[" * deep for deep in (101, 5_000, 50_000, 500_000)),
    *("[" * deep + "]" * deep for deep in (101, 50_000)),
    *("{a: " * deep + "1" + "}" * deep for deep in (101, 50_000)),
    *("- " * deep + "1" for deep in (101, 50_000)),
    *("? " * deep + "1" for deep in (101, 50_000)),
    "\n".join(" " * place + "a:" for place in range(102)),
    "\n".join(f"x{one}: &x{one} [{f'*x{one - 1}' if one else 1}]" for one in range(2_000)),
    "\n".join(f"x{one}: &x{one} [{f'*x{one - 1}' if one else 1}]" for one in range(120)),
    "a: &a [*a]",
]
DEEP_JSON = [
    *("[" * deep for deep in (101, 100_000)),
    "[" * 101 + "]" * 101,
    '{"a":' * 50_000,
    '[{"a":' * 60 + "1" + "}]" * 60,
    '["\\"",' + "[" * 101,
    '["\\\\",' + "[" * 101,
]
NO_JSON = ["", "{", "[NaN]", "[Infinity]", '["\\ud800"]', '{"\\udfff": 1}', "1" * 5_000, "[1,]", "\x00", "{'a': 1}"]


@pytest.mark.parametrize("text", DEEP_YAML, ids=lambda text: f"{text[:6]!r}{len(text)}")
def test_yaml_that_is_nested_too_deeply_is_refused(tmp_path: Path, text: str) -> None:
    file = tmp_path / "deep.yaml"
    file.write_text(text)
    for read in (lambda: yaml_values(text), lambda: yaml_values(text.encode()), lambda: check_yaml(file)):
        with pytest.raises(UsageError, match="nested too deeply"):
            read()


@pytest.mark.parametrize("text", DEEP_JSON, ids=lambda text: f"{text[:6]!r}{len(text)}")
def test_json_that_is_nested_too_deeply_is_refused(tmp_path: Path, text: str) -> None:
    file = tmp_path / "deep.json"
    file.write_text(text)
    with pytest.raises(UsageError, match=r"deep\.json: is nested too deeply"):
        read_json(file)


@pytest.mark.parametrize("text", NO_JSON, ids=lambda text: f"{text[:6]!r}{len(text)}")
def test_what_is_no_json_is_refused(tmp_path: Path, text: str) -> None:
    file = tmp_path / "bad.json"
    file.write_text(text)
    with pytest.raises(ValueError, match=r"bad\.json: this is no JSON") as refused:
        read_json(file)
    assert isinstance(refused.value, UsageError) and "\n" not in str(refused.value)


@pytest.mark.parametrize("value", [{"a": ["[" * 500, '"' * 7, "\\" * 9]}, [[["{" * 300]]], "\U0001f600 é", 1.5, None])
def test_brackets_in_texts_are_no_depth_and_whole_pairs_are_text(value: Any) -> None:
    assert json_values(json.dumps(value).encode()) == value
    assert yaml_values(json.dumps(value, ensure_ascii=False)) == value


def test_a_hundred_levels_are_read() -> None:
    assert json_text.DEEPEST == yaml_file.DEEPEST == 100
    for read in (json_values, yaml_values):
        inside = read(b"[" * 100 + b"]" * 100)
        for _ in range(99):
            [inside] = inside
        assert inside == []


@pytest.mark.parametrize("schema", ["[1]", '{"a": 1}', "1", "null", '"hjcamp.diagnosis/9"'])
@pytest.mark.parametrize("command", [["paper", "a.json", "--as", "text"], ["effects", "new", "mine", "--from", "a.json"]])
def test_an_answer_of_no_schema_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], schema: str, command: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.json").write_text(f'{{"schema": {schema}}}')
    assert cli.run(command) == 2
    told = capsys.readouterr().err
    assert "a.json" in told and "internal error" not in told and len(told.splitlines()) == 1
    assert not Path("text").exists()


@pytest.mark.parametrize(
    "content",
    [
        {"calibration": {"a": {"value": "x", "unit": "N"}}, "tests": 1},
        {"calibration": {"a": {"value": 1.0, "unit": ["N"]}}, "tests": 1},
        {"calibration": {"a": {"value": 10**400, "unit": "N"}}, "tests": 1},
        {"calibration": {"a": {"value": 1.0, "unit": "N", "ci95": [1]}}, "tests": 1},
        {"calibration": {"a": {"value": 1.0, "unit": "N", "ci95": 7}}, "tests": 1},
        {"calibration": [1], "tests": 1},
        {"calibration": {}},
    ],
)
def test_an_answer_of_another_shape_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], content: dict[str, Any]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.json").write_text(json.dumps({"schema": "hjcamp.calibration/1", **content}))
    assert cli.run(["paper", "a.json", "--as", "text"]) == 2
    told = capsys.readouterr().err
    assert "not what its schema" in told and len(told.splitlines()) == 1
