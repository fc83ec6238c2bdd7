"""Equations of docstrings as MathML, which browsers draw by themselves."""

from __future__ import annotations

import re
from html import escape


def mathml(latex: str) -> str:
    """Return an equation as a block of MathML; what cannot be converted is shown as it is written."""
    from latex2mathml.converter import convert

    # it knows no \mathrel, by which our docstrings write += as one sign
    text = re.sub(r"\\mathrel\{([^{}]*)\}=", r"\\text{ \1= }", " ".join(latex.split()))
    try:
        return str(convert(text, display="block"))
    except Exception:  # the library has no base class for what it does not know
        return f"<pre>{escape(latex)}</pre>"
