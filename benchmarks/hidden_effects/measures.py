"""All measures of the hidden-effect benchmark, in the order of the page."""

from __future__ import annotations

from collections.abc import Sequence

from benchmarks.hidden_effects.judging import Line, detectable
from benchmarks.hidden_effects.measure import Measure
from benchmarks.hidden_effects.quantities import amplitudes, coverage, removed
from benchmarks.hidden_effects.shares import names, naming, outside, pairs


def all_measures(lines: Sequence[Line]) -> list[Measure]:
    """Return the measures of results of one version of the code and one effort."""
    of = {kind: [line for line in lines if line["kind"] == kind] for kind in ("single", "null", "pair")}
    beyond = [line for line in lines if line["kind"] in ("outside", "taken_out")]
    library = of["single"] + of["pair"]
    return [
        *naming(of["single"], of["null"]),
        *names(of["single"] + of["pair"] + of["null"], lines),
        *outside(beyond),
        *pairs(of["pair"]),
        *removed([line for line in library if detectable(line)], of["null"]),
        *amplitudes(library),
        *coverage(library, of["null"]),
    ]
