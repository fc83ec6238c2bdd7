"""What the files of campaigns and models hold."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from hjcamp.configuration.run_keys import LARGEST
from hjcamp.schema import Group, between


class CampaignFile(Group):
    """A campaign: what is the same in all its tests (``fixed``), what varies, how often, with which seed and tables."""

    name: str | None = None
    description: str | None = None
    fixed: dict[str, Any] | None = None
    vary: dict[str, Any]
    repetitions: int = between(1, LARGEST, default=7)
    seed: int = between(0, LARGEST, default=1)
    tables: str | list[str] | None = None


class SavedModel(Group):
    """A model: base parameters that differ from the hardware's and added effects, SI; factors; where they come from.

    ``period_s`` (s between two samples) and ``plant`` are those of another plant than the usual one.
    """

    name: str
    plant: str | None = None
    period_s: float | None = between(1e-6, 1e6, default=None)
    parameters: dict[str, Any]
    effects: dict[str, Any]
    factors: dict[str, Any] = Field(default={})
    provenance: dict[str, Any] = Field(default={})
