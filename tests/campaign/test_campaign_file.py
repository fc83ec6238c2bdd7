"""Campaign files: what is refused, and with which words."""

from __future__ import annotations

from typing import Any

import pytest

from hjcamp.campaign.plan.campaign_file import read_campaign
from hjcamp.errors import UsageError

GOOD: dict[str, Any] = {"name": "mine", "fixed": {"payload": "none"}, "vary": {"controller": ["pid", "ffwd_pid"]}}


def test_a_campaign_is_read() -> None:
    campaign = read_campaign(GOOD, "mine")
    assert campaign.fixed == {"payload": "none"}
    assert campaign.axes[0].cases == {"pid": {"controller": "pid"}, "ffwd_pid": {"controller": "ffwd_pid"}}


def test_values_and_cases_get_readable_names() -> None:
    vary = {"controller.positive.kp": [1.0, 1.05], "case": {"low friction": {"friction": "reduced", "seal": 1}}}
    one, other = read_campaign({"vary": vary}, "mine").axes
    assert list(one.cases) == ["kp=1.0", "kp=1.05"]
    assert list(other.cases) == ["low-friction"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"varry": {}}, "unknown key 'varry' in campaign 'mine'; did you mean 'vary'"),
        ({"name": "other"}, "must be the name of its file"),
        ({"vary": {}}, "varies nothing"),
        ({"vary": None}, "varies nothing"),
        ({"vary": {"controller": []}}, "varies nothing"),
        ({"vary": {"case": {}}}, "varies nothing"),
        ({"vary": {"controller": "pid"}}, "a list of values or a mapping"),
        ({"vary": {"controller": ["pid", "pid"]}}, "the same thing twice"),
        (
            {"vary": {"a": {"x": {"friction": "reduced"}, "y": {"friction": "reduced"}}}},
            "the same thing twice: 'x' and 'y'",
        ),
        ({"vary": {"payload": ["none", "brass_8p5g"]}}, "sets 'payload' twice: in 'fixed' and in the axis 'payload'"),
        ({"vary": {"friction": ["reduced"], "a": {"x": {"friction": "reduced"}}}}, "varies 'friction' twice"),
        ({"vary": {"workers": [1, 2]}}, "belongs to the run"),
        ({"fixed": {"repetitions": 3}}, "belongs to the run"),
        ({"fixed": {"controller.scale": float("inf")}}, "a finite number is needed"),
        ({"fixed": ["payload"]}, "a mapping of groups"),
    ],
)
def test_what_is_refused(change: dict[str, Any], words: str) -> None:
    with pytest.raises(UsageError) as caught:
        read_campaign({**GOOD, **change}, "mine")
    assert words in str(caught.value)
    assert "mine" in str(caught.value)
