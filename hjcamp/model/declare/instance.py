"""A generic effect under a plant's own name for it, with the plant's own numbers."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import ClassVar

from hjcamp.errors import UsageError
from hjcamp.model.declare.parameter import Parameter, State, declared


class Instance:
    """What a plant calls a generic effect at one or several of its places; a subclass is called like its class, in small letters.

    ``of`` is the effect's file, ``at`` names the places. For each it maps parameters and states of the effect to their
    names here, and names of the kind to others of the plant. A ``Parameter`` or ``State`` that is declared here, under
    its name here and in SI units, takes the place of the effect's own; a docstring does, too. ``without`` names slots of
    the effect that stay as they are here; parameters that only they read are left out.
    """

    name: ClassVar[str] = ""
    of: ClassVar[str] = ""
    at: ClassVar[Mapping[str, Mapping[str, str]]] = {}
    without: ClassVar[tuple[str, ...]] = ()
    same_as: ClassVar[tuple[str, ...]] = ()
    exact_in: ClassVar[tuple[str, ...]] = ()
    declared: ClassVar[Mapping[str, Parameter | State]] = {}

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        cls.name = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", cls.__name__).lower()
        if not cls.of or not cls.at:
            raise UsageError(
                f"effect {cls.name}: write of = ..., the generic effect that it is, and at = {{PLACE: {{}}}}, where it acts"
            )
        cls.declared = {**declared(cls, Parameter), **declared(cls, State)}
