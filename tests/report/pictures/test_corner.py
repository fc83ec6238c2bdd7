"""The corner plot: contours by the definition, correlations by hand, and what is written beside them."""

from __future__ import annotations

import numpy as np
import pytest

from hjcamp.commands.shared.corner import Estimate, how_well_known, known_rows
from hjcamp.report.pictures.corner import MOST, RADII, correlation_of, draw_corner, ellipse


@pytest.mark.parametrize("correlation", [0.0, 0.8, -0.99])
def test_a_contour_holds_its_share_of_a_normal_pair(correlation: float) -> None:
    matrix = np.array([[1.0, correlation], [correlation, 1.0]])
    points = ellipse(correlation, 1.5)
    assert np.einsum("in,ij,jn->n", points, np.linalg.inv(matrix), points) == pytest.approx(np.full(73, 2.25))
    drawn = np.random.default_rng(3).multivariate_normal([0.0, 0.0], matrix, 20_000)
    size = np.einsum("ni,ij,nj->n", drawn, np.linalg.inv(matrix), drawn)
    assert [np.mean(size < radius**2) for radius in RADII] == pytest.approx([0.68, 0.95], abs=0.01)


def test_correlations_by_hand() -> None:
    found = correlation_of(np.array([[4.0, 3.0, 0.0], [3.0, 9.0, 0.0], [0.0, 0.0, 0.0]]))
    assert found == pytest.approx(np.array([[1.0, 0.5, 0.0], [0.5, 1.0, 0.0], [0.0, 0.0, 1.0]]))


def test_the_picture_says_names_values_and_correlations() -> None:
    svg = draw_corner(["mass", "spring stiffness"], ["80 ± 0.2 kg", "0.14 ± 0.01 N/mm"], np.array([[1.0, -0.79], [-0.79, 1.0]]))
    for said in ("mass", "stiffness", "80 ± 0.2 kg", "0.14 ± 0.01 N/mm", "−0.79"):
        assert said in svg
    many = [f"p{k}" for k in range(MOST + 2)]
    assert f">p{MOST}<" not in draw_corner(many, many, np.eye(len(many)))


def estimate(name: str, effect: str = "") -> Estimate:
    return Estimate(effect, f"{effect} {name}".strip(), 0.002, "m", (0.001, 0.003), 0.00054, name == "low")


def test_the_table_says_value_interval_and_what_is_hardly_told_apart() -> None:
    similar = np.array([[1.0, -0.97, 0.001], [-0.97, 1.0, 0.0], [0.001, 0.0, 1.0]])
    rows = known_rows([estimate("one"), estimate("two"), estimate("low")], similar)
    assert rows[0] == ["one", "2.0 mm", "1.0 to 3.0", "two", "-0.97", "hardly distinguishable"]
    assert rows[2][-2:] == ["0", "at its bound"]
    assert similar[0, 0] == 1.0


def test_where_room_is_short_effects_come_first_then_what_is_most_alike() -> None:
    found = [*(estimate(f"p{k}") for k in range(MOST + 3)), estimate("size", "spring")]
    correlation = np.eye(len(found))
    correlation[1, 2] = correlation[2, 1] = 0.8
    parts, pictures = how_well_known(found, correlation)
    assert ">spring<" in pictures["corner"] and ">p2<" in pictures["corner"] and "2.00 ± 0.54 mm" in pictures["corner"]
    assert f">p{MOST}<" not in pictures["corner"] and f"{MOST} of {len(found)}" in "".join(parts)
    assert how_well_known(found[:1], np.eye(1))[1] == {} and how_well_known([], np.eye(0)) == ([], {})
