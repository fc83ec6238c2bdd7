"""What the docstring of an effect or a plant says: its first sentence and its equation."""

from __future__ import annotations

import inspect


def docstring_sentence(owner: type) -> str:
    """Return the first sentence of the docstring."""
    return " ".join(inspect.cleandoc(owner.__doc__ or "").partition("\n\n")[0].split())


def docstring_equation(owner: type) -> str:
    """Return the equation of the docstring (the text of its ``.. math::`` block), or an empty string."""
    text: list[str] = []
    inside = False
    for line in inspect.cleandoc(owner.__doc__ or "").splitlines():
        if line.startswith(".. math::"):
            inside = True
            text.append(line.removeprefix(".. math::").strip())
        elif inside and line.startswith("   "):
            text.append(line.strip())
        elif inside and line.strip():
            break
    return " ".join(part for part in text if part)
