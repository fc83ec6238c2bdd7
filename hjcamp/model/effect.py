"""Where effects of users were told to import from before there was `hjcamp.effect`."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect

__all__ = ["Effect"]
