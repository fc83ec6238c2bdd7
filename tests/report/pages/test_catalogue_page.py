"""The catalogue as pages: equations that a browser draws, what a docstring says, links that lead somewhere."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from hjcamp import cli
from hjcamp.commands.shared import catalogue
from hjcamp.effects import effect_files
from hjcamp.known_plants import find_plant
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter
from hjcamp.report.pages.catalogue_page import EffectEntry, described, effect_page, equations
from hjcamp.report.wording.mathml import mathml


class Cable(Effect):
    r"""A cable <pulls> the arm back.

    .. math:: F = -k\,\theta,
              \quad k > 0

    with k its rate.
    Seen as: a force with one sign (see spring).
    Not for: what rubs (see position_friction).
    Source: Hooke.
    """

    subsystem = "joint"
    rate = Parameter("N/rad", 0.5, (0.0, 10.0), text="force for one rad", off=0.0)

    @staticmethod
    def load_force(arm_angle, rate):  # type: ignore[no-untyped-def]
        """Force."""
        return -rate * arm_angle


def test_every_equation_of_ours_becomes_mathml() -> None:
    found = {name: equations(effect) for name, effect in effect_files([]).items()}
    assert all(found.values())
    for name, lines in found.items():
        for line in lines:
            drawn = mathml(line)
            assert drawn.startswith("<math") and "\\" not in drawn, (name, line)


def test_an_equation_that_cannot_be_converted_stands_as_it_is_written() -> None:
    assert mathml("a_1_2 < b") == "<pre>a_1_2 &lt; b</pre>"


def test_a_page_says_what_the_docstring_says_and_links_what_has_a_page() -> None:
    assert equations(Cable) == [r"F = -k\,\theta, \quad k > 0"]
    html = effect_page(EffectEntry("cable", Cable, ["pump_joint"]), ["spring", "position_friction"])
    assert "A cable &lt;pulls&gt; the arm back." in html and html.count("<math") == 1
    for said in (
        "<b>Seen as:</b> a force",
        "<b>Not for:</b> what rubs",
        "<b>Source:</b> Hooke.",
        "fits pump_joint",
        "0 ... 10",
    ):
        assert said in html
    assert set(re.findall(r'href="([^"]+)"', html)) == {"spring.html", "position_friction.html", "index.html"}
    assert "href" not in described(Cable)


@pytest.mark.parametrize(("name", "plant"), [("spring", "two_pumps"), ("gravity_load", "pump_joint")])
def test_the_picture_of_an_effect_shows_what_it_changes(name: str, plant: str) -> None:
    from hjcamp.effects import library_of

    library = library_of(plant, folders=[])
    effect = library.effects[library.names[name][0]]
    svg = catalogue.picture_of(effect, find_plant(plant, folders=[]))
    assert "without" in svg and "with" in svg and "change" in svg and "time (s)" in svg


def test_pages_take_no_name_and_no_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["effects", "spring", "--pages", str(tmp_path / "x")]) == 2
    assert "takes no name" in capsys.readouterr().err
    (tmp_path / "file").write_text("")
    assert cli.run(["effects", "--pages", str(tmp_path / "file")]) == 2
    assert "give a folder" in capsys.readouterr().err
