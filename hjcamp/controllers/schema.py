"""What the group ``controller`` may hold: the parameters of the chosen law, and the settings that all laws share."""

from __future__ import annotations

import functools
from typing import Any, Literal

from pydantic import create_model

from hjcamp.controllers.controller import Controller
from hjcamp.model.declare.parameter import Parameter
from hjcamp.schema import Group, between

SIDES = ("positive", "negative")
FASTEST_DITHER_HZ = 500.0  # a half period is at least one sample


class Dither(Group):
    """The square wave on a motor's voltage."""

    amplitude_v: float = between(0.0, 1000.0)
    frequency_hz: float = between(1e-3, FASTEST_DITHER_HZ)
    full_scale_v: float = between(0.1, 1000.0, default=10.0)
    waveform: Literal["square"] = "square"


class FeedforwardSettings(Group):
    """How the feedforward is formed."""

    variant: str = ""
    gain: float = between(0.0, 100.0)
    static_friction: bool
    friction_direction: Literal["reference", "positive"]


class ControllerSettings(Group):
    """What every law may be given besides its parameters."""

    name: str
    model: str = "published"
    gain_direction_at_rest: Literal["last_commanded"] = "last_commanded"
    dither: Dither | None = None
    input: str | None = None


@functools.lru_cache(maxsize=64)
def controller_schema(law: type[Controller]) -> type[Group]:
    """Return the schema of a law: its parameters with their bounds, ``positive_kp`` as ``positive.kp``.

    A name that ends in ``_samples`` is a whole number.
    """
    flat: dict[str, Any] = {}
    sides: dict[str, dict[str, Any]] = {}
    for name, parameter in law.parameters.items():
        side, _, gain = name.partition("_")
        if side in SIDES and gain:
            sides.setdefault(side, {})[gain] = _field(gain, parameter)
        elif name != "first_direction":
            flat[name] = _field(name, parameter)
    for side, fields in sides.items():
        flat[side] = (create_model(f"{law.name}_{side}", __base__=Group, **fields), None)
    # A law without feedforward ignores its settings, so that one campaign can fix them for all controllers.
    flat["feedforward"] = (FeedforwardSettings, ...) if law.uses_feedforward else (FeedforwardSettings | None, None)
    return create_model(law.name, __base__=ControllerSettings, **flat)


def _field(name: str, parameter: Parameter) -> tuple[Any, Any]:
    return (int if name.endswith("_samples") else float), between(*parameter.bounds, default=parameter.default)
