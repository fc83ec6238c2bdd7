"""No verdict rules the library out from a base at its bound or from short windows, and none says "nothing" far above the noise."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hjcamp.diagnosis.decision import borne_out, verdict
from hjcamp.diagnosis.decision.doubts import doubt_of_nothing, doubt_of_outside
from hjcamp.diagnosis.decision.verdict import CANNOT_TELL, OUTSIDE, Verdict
from hjcamp.diagnosis.estimation.gauss_newton import Fitted, Free
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.parameter import Parameter

PERIOD, WIDTH = 1.0, 24


def analysis_of(
    held: tuple[str, ...] = (),
    delay: float = 0.0,
    lag: float = 6.0,
    share: float = 0.5,
    source: str = "sensor",
    rms: float = 1.0,
    memory: int = 0,
) -> Any:
    """A stand-in for an analysis: a base with a delay, and a look that has fitted a lag, which leaves a share of the error."""
    free = (Free("", "delay.pump", 1.0, -1.0, 2.0),)
    features = np.full((32, 2), rms)
    fitted = Fitted(Candidate({"delay.pump": delay}, {}), free, features, np.ones((32, 2, 1)), 0.0)
    base = SimpleNamespace(fitted=fitted, features=features)
    lagging = SimpleNamespace(
        beyond=lambda before: ("sensor_lag",), fitted=SimpleNamespace(candidate=Candidate({}, {"sensor_lag": {"lag": lag}}))
    )
    step = SimpleNamespace(before=base, named=(lagging,), unknown=(), p_value=0.01, claims=0.05, level=0.05)
    effect = SimpleNamespace(
        states={"late": None}, parameters={"lag": Parameter("s", 5.0, (0.1, 200.0), "log-uniform", off=0.0)}
    )
    search = SimpleNamespace(
        steps=[step],
        blocks=np.repeat(np.arange(8), 4),
        library={"sensor_lag": effect},
        error_ratio=lambda one, before: share,
        takes_a_share=lambda one, before, level: False,
        t=lambda one, before: (1.0, 8.0),
    )
    sensors = (SimpleNamespace(quantity="level"),)
    measured = SimpleNamespace(period=PERIOD, sensors=sensors, plant=SimpleNamespace(loop="own"))
    layout = SimpleNamespace(measured=measured, width=WIDTH, memory=memory, short=False, basis=np.ones((WIDTH, 2)))
    windows = SimpleNamespace(layout=layout, starts=np.zeros((32, 1)))
    noise_floor = SimpleNamespace(source=source)
    return SimpleNamespace(held=held, base=base, search=search, windows=windows, measured=measured, noise_floor=noise_floor)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"lag": 2.0}, ""),
        ({"held": ("mass",)}, "mass was driven to its bound"),
        ({"lag": 2.0, "delay": 2.0}, "the delay of pump is at the largest that the base may have"),
        ({"lag": 6.0}, "sensor_lag explains 50 % of the error, but windows of 24 s are only 4 times its 6 s"),
        ({"lag": 3.9}, ""),
        ({"lag": 4.1}, "windows of 24 s are only 5.9 times its 4.1 s"),
        ({"lag": 6.0, "share": 0.95}, ""),
        ({"lag": 6.0, "memory": 200}, ""),
    ],
)
def test_what_speaks_against_ruling_out_the_library_makes_that_cannot_tell(changed: dict[str, Any], said: str) -> None:
    analysis = analysis_of(**changed)
    doubt = doubt_of_outside(analysis, None, 0.01)
    assert bool(doubt) == bool(said) and said in doubt
    outside = Verdict(OUTSIDE, (), analysis.base, 0.01, (), 1.0, None, ())
    found = verdict._doubted(analysis, outside)
    assert (found.word, found.lacking) == ((CANNOT_TELL, (doubt,)) if said else (OUTSIDE, ()))
    swinging = Verdict(OUTSIDE, (), analysis.base, 0.01, (), 1.0, None, (), swing=SimpleNamespace())  # type: ignore[arg-type]
    assert verdict._doubted(analysis, swinging) is swinging


@pytest.mark.parametrize(("held", "delay"), [(("mass",), 0.0), ((), 2.0)])
def test_a_base_that_leaves_its_bound_with_what_was_found_speaks_against_nothing(held: tuple[str, ...], delay: float) -> None:
    analysis = analysis_of(lag=2.0, held=held, delay=delay)
    free: Any = analysis_of(lag=2.0).base
    assert doubt_of_outside(analysis, None, 0.01) and not doubt_of_outside(analysis, free, 0.01)
    assert bool(doubt_of_outside(analysis, analysis.base, 0.01)) == (delay > 0.0)


@pytest.mark.parametrize(("law", "lag", "doubted"), [(9.0, 4.0, True), (3.0, 4.0, False), (9.0, 6.0, False)])
def test_whole_tests_decide_where_an_effect_takes_most_of_their_error_and_a_free_law_does_not(
    monkeypatch: pytest.MonkeyPatch, law: float, lag: float, doubted: bool
) -> None:
    analysis = analysis_of(lag=2.0)
    monkeypatch.setattr(borne_out, "_left", lambda analysis, models: [10.0, law, lag])
    said = doubt_of_outside(analysis, analysis.base, 0.01)
    assert bool(said) == doubted and ("sensor_lag takes 60 % of the error of whole tests" in said) == doubted


@pytest.mark.parametrize("p_value", [0.01, 0.4])
@pytest.mark.parametrize("source", ["repetitions", "near_replicates", "sensor"])
@pytest.mark.parametrize("rms", [0.9, 1.9, 2.2, 5.0])
def test_nothing_is_not_said_where_the_error_lies_far_above_the_noise_and_no_test_was_repeated(
    source: str, rms: float, p_value: float
) -> None:
    said = doubt_of_nothing(analysis_of(source=source, rms=rms, share=0.95), p_value)
    assert bool(said) == (source != "repetitions" and rms > 2.0)
    if said:
        assert f"level errs by {rms:.2g} times its own noise (third differences)" in said and "repeat a test" in said
        assert ("no more of it than chance" in said) == (p_value > 0.05)
