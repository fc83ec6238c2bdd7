"""Effects added to a model, in Python: by name, or as a diagnosis found them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from hjcamp.errors import UsageError
from hjcamp.notebook.data import Tests, data_of
from hjcamp.notebook.diagnosis import Diagnosis
from hjcamp.notebook.models import Added, added


def add(
    effects: str | Sequence[str] | Diagnosis,
    tests: Tests | None = None,
    *,
    as_: str,
    model: object = "published",
    progress: Callable[[str, float], None] | None = None,
) -> Added:
    """Fit effects in addition to the base of ``model``, save the new model as conf/model/NAME.yaml, and return it; `hjcamp add`.

    What is returned stands for its name: ``hjcamp.compare(data, model=["published", mine])``.

    ``effects`` are names, or a diagnosis whose effects and tests are taken. Raises ``UsageError`` for unknown effects, effects
    that the model has, and a name that is taken.

    >>> mine = hjcamp.add("spring", "logs", as_="mine")
    >>> mine.helps
    True
    >>> [row["parameter"] for row in mine.frame.to_dicts()]
    ['stiffness', 'rest_position']
    """
    if not isinstance(effects, str | Sequence):
        if tests is None:
            return effects.add(as_)
        effects = effects.effects
    if tests is None:
        raise UsageError("no logs were named: hjcamp.add(EFFECTS, TESTS, as_=NAME)")
    names = effects.replace(",", " ").split() if isinstance(effects, str) else list(effects)
    return added(names, data_of(tests), as_, str(model), progress)
