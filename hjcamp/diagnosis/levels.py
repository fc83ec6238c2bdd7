"""Every number that decides a verdict, with the level that it stands for."""

from __future__ import annotations

# One claim in twenty may be wrong: chance of the screening, paired comparisons of models over blocks.
LEVEL = 0.05
# Equal readings in a row at the largest or smallest of all are the sensor's end where chance makes such a row anywhere in the logs,
# at either end of any sensor, less often than this: one claim in twenty (`hjcamp.diagnosis.data.saturation` counts them).
ENDS = LEVEL
# A verdict is decided by two numbers: the level of the whole answer, and the smallest share of the error that matters.
ALPHA, DELTA = LEVEL, 0.10
# Every dry contact gives way before it slips, by micrometres where it travels centimetres (Armstrong-Helouvry et al. 1994,
# doi:10.1016/0005-1098(94)90209-7, section 2.1): up to this share of its travel that is how a contact is, no effect.
GRANTED = 2e-4
# A law is that kind where it takes most of what the freest law over the same driver takes.
MOST_OF_IT = 0.5
# A curved law is begun from so many promises, and from its usual values; so many of these are fitted, for so many rounds.
TRIED_STARTS = 4
FITTED_STARTS = 2
TRIED_ROUNDS = 3
# A curve is called none of the formulas where even the best leaves more than its knots' errors would, less often than this: the best of
# two dozen forms is flexible, so that true ones are lost less often still.
NO_FORMULA = 0.01
