"""All that an effect's file needs: ``from hjcamp.effect import Effect, Parameter, State``."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State

__all__ = ["Effect", "Parameter", "State"]
