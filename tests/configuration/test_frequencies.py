"""A frequency that the sampling cannot show is refused before anything is planned."""

from __future__ import annotations

import pytest

from hjcamp.configuration.check import check_configuration
from hjcamp.configuration.composer import Composer
from hjcamp.errors import UsageError


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        (
            ["trajectory=sine", "trajectory.frequency_hz=501"],
            "trajectory.frequency_hz is 501; a number from 0.0001 to 500",
        ),
        (
            ["trajectory=triangle", "trajectory.frequency_hz=600"],
            "trajectory.frequency_hz is 600; a number from 0.0001 to 500",
        ),
        (["controller.dither.frequency_hz=700"], "controller.dither.frequency_hz is 700; a number from 0.001 to 500"),
    ],
)
def test_above_half_the_sampling_rate(composer: Composer, lines: list[str], said: str) -> None:
    with pytest.raises(UsageError, match=said):
        check_configuration(composer.compose(lines).config)


def test_half_the_rate_is_allowed(composer: Composer) -> None:
    check_configuration(composer.compose(["trajectory=sine", "trajectory.frequency_hz=500"]).config)
