"""What the likelihood makes of features that are no numbers, or of which the squares are none."""

import numpy as np
import pytest

from hjcamp.diagnosis.estimation.likelihood import loss, size


def test_of_white_features_the_size_is_their_spread_and_a_unit_of_noise() -> None:
    features = np.random.default_rng(5).standard_normal((20000, 3)) * 2.0
    assert size(features) == pytest.approx(np.sqrt(2.0**2 + 1.0), rel=0.02)
    assert loss(features) == pytest.approx(0.5 * 20000 * 3 * np.log(5.0), rel=0.01)


@pytest.mark.parametrize("wrong", [np.inf, np.nan, 1e200])
def test_what_runs_away_is_infinitely_bad_without_a_warning(wrong: float) -> None:
    features = np.ones((30, 3))
    features[4, 1] = wrong
    assert loss(features) == np.inf and size(features) == np.inf
