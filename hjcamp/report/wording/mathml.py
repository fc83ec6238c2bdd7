"""Equations of docstrings as MathML, which browsers draw by themselves."""

from __future__ import annotations

import re
from html import escape


def mathml(latex: str) -> str:
    """Return an equation as a block of MathML; what cannot be converted is shown as it is written."""
    from latex2mathml.converter import convert

    # it knows no \mathrel, by which our docstrings write += as one sign
    text = re.sub(r"\\mathrel\{([^{}]*)\}=", r"\\text{ \1= }", " ".join(latex.split()))
    # a subscript that is a word is one name, no product of its letters
    text = re.sub(r"_\{([A-Za-z]{2,})\}", r"_{\\text{\1}}", text)
    try:
        return str(convert(text, display="block"))
    except Exception:  # the library has no base class for what it does not know
        return f"<pre>{escape(latex)}</pre>"
