"""A user's plant whose file has no equations is refused by its file."""

from __future__ import annotations

from pathlib import Path

import pytest

from hjcamp import cli


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "it has no function 'equations'"),
        ("    equations = 3\n", "it has no function 'equations'"),
        ("    equations = lambda state: state\n", "line 4: plant bare: 'equations' is no function"),
    ],
)
def test_a_plant_without_equations(
    text: str, told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    bare = 'from hjcamp.plant import Plant\nclass Bare(Plant):\n    """A plant."""\n'
    (tmp_path / "plants" / "bare.py").write_text(bare + text)
    for words in (["bare"], ["test", "bare"]):
        assert cli.run(["plants", *words]) == 2
        said = capsys.readouterr().err
        assert "plants/bare.py: " in said and told in said, said
