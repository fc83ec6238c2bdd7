"""Keep the results of a function of classes."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import ParamSpec, TypeVar, cast

Given = ParamSpec("Given")
Found = TypeVar("Found")


def cached(function: Callable[Given, Found]) -> Callable[Given, Found]:
    """Return `functools.cache` of a function whose arguments are classes, with its own signature for the type checker."""
    return cast("Callable[Given, Found]", functools.cache(function))
