"""The page of the hidden-effect benchmark."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path

from benchmarks import ROOT
from benchmarks.hidden_effects.cases import FIRST_SEED, SAME, TAKEN_OUT, HiddenCase
from benchmarks.hidden_effects.detectable import BASE, DETECTABLE
from benchmarks.hidden_effects.judging import Line, verdict_of
from benchmarks.hidden_effects.measure import Measure, at_least
from benchmarks.hidden_effects.measures import all_measures
from benchmarks.hidden_effects.quantities import times
from benchmarks.hidden_effects.tables import (
    amplitude_table,
    bound_text,
    confusion_table,
    failures_table,
    forms_table,
    measures_table,
    strengths_table,
    table,
    value_text,
)

# each benchmark takes rigs from the next ten thousand seeds, that nothing has looked at
TEN_THOUSAND = 10_000
READING = Path(__file__).with_name("reading.md")


def page(lines: Sequence[Line], cases: Sequence[HiddenCase], effort: str, tag: str, command: str, cores: int) -> str:
    """Return the page for the results of one version of the code, judged at one effort."""
    order = {case.name: place for place, case in enumerate(sorted(cases, key=lambda case: (case.kind, case.seed)))}
    ours = [line for line in lines if line["effort"] == effort and line["name"] in order]
    ours.sort(key=lambda line: order[line["name"]])
    timed = [one for name in sorted({line["effort"] for line in lines}) for one in times(lines, name)]
    reading = READING.read_text(encoding="utf-8").strip() if READING.exists() else ""
    parts = [
        "# Hidden effects: how often the diagnosis is right",
        _origin(ours, len(cases), effort, tag, command, cores),
        "## Measures",
        measures_table([*all_measures(ours), *_elsewhere(), *timed]),
        *([reading] if reading else []),
        "## How it is counted",
        _counting(),
        "## By effect and strength",
        strengths_table(ours),
        "## By contact and by law",
        "An effect that has several laws follows one drawn by the rig's seed. No law of the library is among them but where physics "
        "leaves one only (a weight, a mass, a constant error). Right: with groups, as below.",
        forms_table(ours),
        "## Hidden and said",
        confusion_table(ours),
        "## Amplitudes",
        amplitude_table(ours),
        "## Every case that is not strictly right",
        "`visible` is the measure of detectability above; p is the chance of the first gain on null replicates. "
        "The logs of a case: `python -m tests.truth OUT --effect NAME --strength STRENGTH --seed SEED --contact CONTACT --form "
        "random`, with the contact as the ledger has it.",
        failures_table(ours),
    ]
    others = _efforts(lines, effort)
    if others:
        parts += ["## Other efforts", others]
    return "\n\n".join(parts) + "\n"


def _origin(lines: Sequence[Line], planned: int, effort: str, tag: str, command: str, cores: int) -> str:
    kinds = {kind: sum(line["kind"] == kind for line in lines) for kind in FIRST_SEED}
    broken = sum(verdict_of(line) == "failed" for line in lines)
    part = "" if len(lines) >= planned else f" **Only {len(lines)} of {planned} planned cases are finished.**"
    seeds = [line["seed"] for line in lines]
    seen = min(seeds) // TEN_THOUSAND * TEN_THOUSAND
    return f"""Written by `{command}`,
code at commit {tag}, effort {effort}, on a machine with {cores} cores, each case in one process with one thread.{part}
The cases were run in random order; they stand in `benchmarks/results/hidden_effects.jsonl`.

{len(lines)} cases, each on a rig of its own with 8 conditions of 3 repetitions and one of four contacts:
{kinds["single"]} with one effect of the library, {kinds["null"]} with nothing hidden, {kinds["pair"]} with two effects,
{kinds["outside"]} with an effect that was never in the library, and {kinds["taken_out"]} with one that was taken out of it.
{broken} diagnoses broke off; they count as wrong.

**What this does not show.** The truth plant (`tests/truth`) shares no code with the model: other integrator, other friction
law, other noise, its own writer. But the same people wrote both, so what they did not think of is in neither. The rigs
have seeds {min(seeds)} to {max(seeds)}; development has looked at many below {seen}. The plant's effects and strengths are
those that development looked at, and ten laws of the library were widened or changed after seeing those of this plant
(`docs/decisions/effects.md`). Thresholds come from null replicates of each campaign and from rigs with nothing missing
(docs/levels.md), or stand by hand (`docs/decisions/decision.md`)."""


def _counting() -> str:
    groups = "; ".join(" and ".join(sorted(group)) for group in SAME)
    return f"""* **Detectable** is told by the truth plant alone, before any diagnosis: its five open-loop conditions are run
  with and without the effect with the same draws of scatter, three repetitions each. The change of the mean log is
  divided by the standard deviation of one repetition, and what {len(BASE)} groups of base parameters can imitate is
  taken off (bounded least squares: friction +-60 %,
  stiffness +-30 % together and +-2 % apart, mass +-15 %; for offsets of the pressure sensors also the very friction that
  balances them). The effect is detectable where the root mean square of
  the rest over a test is at least {DETECTABLE:g} in some channel of some condition. Of two effects, both must be.
* **Strictly** right: EFFECT with the hidden names and no others. **With groups**: the other name of the same thing is right, too
  ({groups}), and so is ONE OF that group alone; nothing_missing is right where the effect is not detectable.
* **Named with certainty**: the verdict EFFECT. ONE OF names something on a null, but is not a wrong name.
* **Taken out**: the diagnosis runs without the effect and those that are the same thing ({len(TAKEN_OUT)} effects, strong).
* **Removable error**: of detectable cases of the library with an error on held-out tests of 1.1 times the best possible at least,
  whatever was said. Best possible: the median of what the calibrated model leaves on the rigs with nothing hidden, and
  again with the noise floor itself.
* **Coverage**: where the verdict was strictly right; base parameters that an effect of another law redefines are left out.
* **Intervals** of shares in brackets: 95 %, Wilson. Amplitudes: of effects that were named."""


def _elsewhere() -> list[Measure]:
    """Return what `benchmarks.next_value` measured, from its committed page."""
    path = ROOT / "docs" / "next_value.md"
    text = path.read_text(encoding="utf-8") if path.exists() else ""
    means = re.search(r"([\d.]+) times fewer, over (\d+)", text)
    each = re.search(r"mean of the ratios\): ([\d.]+) times", text)
    count, aim = int(means.group(2)) if means else 0, at_least("not tried", 2, 3)
    title = "tests needed to separate two rivals, times fewer than random choice (see [next.md](next.md))"
    return [
        Measure(f"{title}, of the means", float(means.group(1)) if means else math.nan, count, aim, unit="x"),
        Measure("... duel by duel, geometric mean", float(each.group(1)) if each else math.nan, count, aim, unit="x"),
    ]


def _efforts(lines: Sequence[Line], effort: str) -> str:
    others = sorted({line["effort"] for line in lines} - {effort})
    columns = {one: all_measures([line for line in lines if line["effort"] == one]) for one in others}
    if not columns:
        return ""
    first = columns[others[0]]
    rows = []
    for place, measure in enumerate(first):
        if measure.aim.good is not None:
            cells = [f"{value_text(columns[one][place])}, {columns[one][place].count} cases" for one in others]
            rows.append((measure.title.split(" (best")[0], bound_text(measure.aim.good, measure.unit), *cells))
    return table(("measure", "good", *others), rows)
