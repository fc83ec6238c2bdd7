"""A model to look at: what the diagnosis varies."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Mapping
from dataclasses import dataclass, field
from functools import cached_property


@dataclass(frozen=True)
class Candidate:
    """A model to look at: base parameters by name and effects with their parameters, all SI."""

    base: Mapping[str, float]
    effects: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    @cached_property
    def key(self) -> tuple[Hashable, ...]:
        """What tells this model from others, as something that a dictionary can be asked for."""
        effects = ((name, *sorted(values.items())) for name, values in sorted(self.effects.items()))
        return (*sorted(self.base.items()), *effects)

    def with_effect(self, name: str, parameters: Mapping[str, float]) -> Candidate:
        """Return this model with one effect added or replaced."""
        return Candidate(self.base, {**self.effects, name: dict(parameters)})

    def without(self, names: Collection[str]) -> Candidate:
        """Return this model without some of its effects."""
        return Candidate(self.base, {name: values for name, values in self.effects.items() if name not in names})

    def with_base(self, base: Mapping[str, float]) -> Candidate:
        """Return this model with other base parameters."""
        return Candidate({**self.base, **base}, self.effects)
