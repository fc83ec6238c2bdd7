"""The words of the answers, one sentence each, for ``hjcamp explain`` and as tooltips on the pages."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from html import escape

#: Names in the order of a reader's way through an answer; others of the same meaning stand in `ALSO`.
WORDS: Mapping[str, str] = {
    "noise floor": "Repeatability, the error below which no model can go: what repetitions of a test do not share, else what "
    "near-replicates differ by, else (a lower bound) the sensor's noise.",
    "simulated through": "Predicted from the start of a test to its end, not window by window: so it is with short tests of a "
    "plant that forgets its start within them.",
    "whole tests": "Each test simulated from its first sample to its last, begun where it fits best: what grows slowly shows there, "
    "and in windows hardly.",
    "diverges": "A model diverges where its free simulation exceeds all bounds or never forgets its initial state, though the "
    "machine does: it predicts only windows that are re-initialised.",
    "memory": "The time in which a plant's readings forget where a test began (to 37 %): how long it remembers.",
    "delay": "The time by which an input acts later than its log says, fitted with the base from one sample early to two late; "
    "more of it is an effect (command_delay, sensor_lag).",
    "normalised error": "Errors divided by their noise floor, of all channels and of all shapes that an error has "
    "within a window together: "
    "1 is as good as repetitions allow, 2 is twice that (a geometric mean, so that each shape counts by its own noise "
    "floor; it is not the "
    "quotient of two rms).",
    "calibrated": "With the base parameters fitted to these tests first, so that a constant that is merely different on this rig "
    "is not called a missing effect.",
    "base parameter": "A constant of the plant's own equations that differs from rig to rig, such as a mass or a friction.",
    "effect": "A physical law that the plant's equations leave out, one file of the library or of your own; as a verdict: this one "
    "is missing.",
    "one of": "The verdict that several sets of effects explain these tests equally well; other tests would distinguish them.",
    "outside the library": "The verdict that something is missing which no effect of the library explains; its curve is shown.",
    "nothing missing": "The verdict that nothing explains a tenth of the error above repeatability on blocks left out, nor could.",
    "cannot tell": "The verdict that these tests are too few, too short or too still for any other verdict.",
    "non-parametric term": "A function of one quantity, such as a force over position, given by fitted values at knots with "
    "straight lines in between; it competes with the named effects and is never named itself.",
    "drivers": "The measured quantities on which what is missing depends, the most likely one first.",
    "law left": "The share of what the best model explains that the named effect's own law does not explain; 0 where its form is "
    "right (law_left in the answer for programs).",
    "candidate": "An effect that was fitted in addition to the calibrated model, with its parameters and what it explains.",
    "posterior weight": "How probable it is, from tests that it was not fitted to, that a model with an effect predicts better than "
    "one without; it may be near 1 of several effects, unless the weights of those that were weighed add up to 1.",
    "held-out": "Not used for the fit: the error on held-out tests is what a model is judged by, since a fit alone can only fall.",
    "residual share": "The share of the calibrated model's held-out error that remains with an effect added: 30 % residual is 70 % "
    "explained.",
    "explained": "One less the mean square of a model's errors over that of the readings about their mean in each window (or whole "
    "test): 100 % is no error, and below 0 the mean is nearer.",
    "block": "A cross-validation fold, a part of the measurements that is held out as a whole to judge a fit of the "
    "others: a condition, a test, or a "
    "part of a test.",
    "window": "A short stretch of a test that a model predicts from a start of its own, so that what drifts does not hide what it "
    "misses.",
    "smooth part": "What eight smooth curves hold of the errors in a window: what is missing shows in it, most of a sensor's "
    "noise does not; errors of whole tests hold all of the noise.",
    "confidence set": "Every set of effects that these tests do not rule out; where it holds more than one, more tests are needed.",
    "t": "Student's t of the paired differences between two models' errors over held-out blocks: how far their mean is from 0, in its "
    "own standard errors.",
    "p-value": "How probable a gain as large as this one is where nothing is missing; below 0.05 something is claimed.",
    "published": "The model as it is declared, with the values of the plant's file (of the joint: of the thesis), before "
    "anything is fitted.",
    "gain": "By how much an effect raises the log-likelihood of the tests.",
    "chance": "What effects gain where none of them is missing, found from surrogate data.",
    "surrogate data": "Data as noisy as the measured ones in which nothing is missing: circularly shifted residuals, or simulated "
    "null replicates.",
    "null replicate": "A simulation of the measured tests by the calibrated model with the rig's scatter and nothing missing "
    "(parametric bootstrap); what effects gain on null replicates is chance.",
    "residual": "What is measured less what the model predicts.",
    "autocorrelation": "The correlation of a residual with itself some time later; outside its band it is not noise, and something is "
    "missing.",
    "cross-correlation": "The correlation of a residual with an input some time before; outside its band the model does not use that "
    "input correctly.",
    "band": "The range that holds 95 % of what chance, or the uncertainty of a curve, makes.",
    "95 % interval": "The range that holds the true value of a parameter in 95 of 100 such measurements.",
    "condition": "Tests that are meant to be replicates, the same in all but scatter.",
    "repetition": "One of several tests of a condition; what repetitions do not share is the noise floor.",
    "identifiable": "Determined by these tests: the data, not its bounds, give the value of a parameter an interval.",
    "distinguishable": "Two effects are distinguishable where their responses in these tests differ by more than noise and base "
    "parameters can explain.",
    "near-replicates": "Moments of the tests at which state and input are nearly equal: what follows should be, too, and what "
    "differs is an estimate of the noise floor where nothing was repeated (Gamma test).",
    "end of a sensor": "The largest or smallest value that it can show: it reads that again and again, though it is noisy elsewhere.",
    "cosine": "The correlation of the responses of two effects in these tests: at 1 or -1 the tests cannot distinguish them.",
    "smallest that would have been seen": "The amplitude from which on an effect would have been claimed in these tests.",
    "exploratory": "Without repetitions, so that the scatter of the rig is assumed and probabilities are a guide only.",
    "place": "An element of a plant's equations on which effects act: a contact, body, store, path, sensor, actuator or transmission.",
    "slot": "A quantity of the equations that an effect may add to or change.",
    "horizon": "The time since a model was last set to the measured state; an error that grows with it comes from the rates.",
    "samples looked at": "Of long logs 32 000 samples, in runs of windows that are spread evenly (--effort quick: 12 000, "
    "thorough: all); fewer than 384 samples (24 windows of 16) give no answer, and a test that is given twice is looked at once.",
    "differs by condition": "Base parameters that differ between conditions, and by how much: said where a base for each condition "
    "explains more than all that was found (by_condition).",
    "given constant": "A constant of the plant's file that, estimated with the base, explains as much as what was found: a mass "
    "that was weighed without its bolts looks like a sensor's wrong gain (constants).",
    "parameter that varies": "A base parameter that depends on a state, an input or time, such as the friction of oil that thins as it "
    "warms; tried where no effect and no non-parametric term explains what exceeds the noise; an effect of your own "
    "may act on one by a "
    "method of the parameter's name.",
    "missing quantity": "The force, flow, command or reading that would have to be added to the calibrated model, instant by "
    "instant, for it to agree with the measurement.",
}
#: Other spellings, and words of earlier versions, by the word that answers for them.
_ALSO: Mapping[str, tuple[str, ...]] = {
    "memory": ("remembers",),
    "whole tests": ("whole test",),
    "diverges": ("runs_away", "runs away", "divergence", "run away"),
    "delay": ("delays",),
    "normalised error": ("over the floor", "over_floor"),
    "surrogate data": (
        "circularly shifted residuals",
        "circularly shifted effects",
        "residuals moved in time",
        "residuals drawn at random",
        "surrogates",
    ),
    "noise floor": ("floor", "repeatability", "excess error"),
    "identifiable": ("told",),
    "distinguishable": ("told apart",),
    "block": (
        "chapter",
        "fold",
        "cross-validation fold",
        "blocks",
        "chapters left out",
        "held-out blocks",
        "chapters",
    ),
    "null replicate": ("twin", "null replicates", "twins"),
    "non-parametric term": ("unknown", "free law", "nonparametric term", "unknowns", "knots", "free laws"),
    "residual share": ("left", "unexplained"),
    "near-replicates": ("alike moments", "gamma test"),
    "published": ("nominal",),
    "base parameter": ("nominal parameters", "base parameters"),
    "cosine": ("most like", "confounded"),
    "drivers": ("driver",),
    "law left": ("law_left",),
    "held-out": ("heldout", "held out", "left out"),
    "posterior weight": ("posterior", "weight"),
    "window": ("windows",),
    "p-value": ("p", "p value"),
    "one of": ("one_of",),
    "outside the library": ("outside_library", "outside library"),
    "nothing missing": ("nothing_missing",),
    "cannot tell": ("cannot_tell",),
    "95 % interval": ("confidence interval", "interval", "95 %"),
    "smallest that would have been seen": ("minimum detectable", "minimum_detectable"),
    "calibrated": ("calibration", "calibrated first"),
    "repetition": ("repetitions",),
    "condition": ("conditions",),
    "residual": ("residuals",),
    "candidate": ("candidates",),
    "confidence set": ("confidence_set",),
    "chance": ("null",),
    "end of a sensor": ("ends",),
    "differs by condition": ("by_condition", "by condition", "specimen"),
    "given constant": ("constants",),
    "samples looked at": ("samples", "long logs"),
}
ALSO: Mapping[str, str] = {other: word for word, others in _ALSO.items() for other in others}
# On a page these are everyday words more often than terms.
EVERYDAY = frozenset(
    {
        "effect",
        "ends",
        "constants",
        "samples",
        "by condition",
        "specimen",
        "left",
        "t",
        "p",
        "weight",
        "null",
        "one of",
        "place",
        "gain",
        "interval",
        "unknown",
        "told",
        "told apart",
        "alike moments",
        "nominal",
        "fold",
        "block",
        "blocks",
        "divergence",
        "most like",
        "unexplained",
        "95 %",
        "conditions",
        "condition",
    }
)


def plain_word(text: str) -> str:
    """Return a word as it stands in `WORDS` where that is only a matter of capitals, ``-`` and ``_``."""
    asked = " ".join(text.lower().replace("_", " ").split())
    spelled = {one.replace("-", " ").replace("_", " "): one for one in (*ALSO, *WORDS)}
    found = spelled.get(asked.replace("-", " "), asked)
    return ALSO.get(found, found)


@cache
def _pattern() -> re.Pattern[str]:
    names = sorted({*WORDS, *ALSO} - EVERYDAY, key=len, reverse=True)
    return re.compile(r"(?<![\w-])(" + "|".join(re.escape(escape(name)) for name in names) + r")(?![\w-])", re.IGNORECASE)


def glossed(text: str) -> str:
    """Return text as HTML with a tooltip on the first use of each word of the glossary."""
    seen: set[str] = set()

    def marked(found: re.Match[str]) -> str:
        word = plain_word(found[0])
        if word in seen:
            return found[0]
        seen.add(word)
        return f'<abbr title="{escape(WORDS[word])}">{found[0]}</abbr>'

    return _pattern().sub(marked, escape(text))


def words_of(html: str) -> str:
    """Return the words that have a tooltip in a page as a list with their sentences, empty where there is none.

    A finger opens no tooltip, and paper has none.
    """
    found = {plain_word(one) for one in re.findall(r"<abbr [^>]*>([^<]*)</abbr>", html)}
    if not found:
        return ""
    rows = "".join(f"<dt>{escape(word)}</dt><dd>{escape(said)}</dd>" for word, said in WORDS.items() if word in found)
    return f'<details class="words"><summary>Words on this page</summary><dl>{rows}</dl></details>'
