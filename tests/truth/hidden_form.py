"""What can be hidden in a machine of this package: an effect in one form, and what a diagnosis may say of it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

STRENGTHS = {"weak": 0.4, "medium": 1.0, "strong": 2.0}
Machine = TypeVar("Machine")
Changes = dict[str, float]


@dataclass(frozen=True)
class Form(Generic[Machine]):
    """One effect in one form: what it changes in a machine, and what is right and what is honest to say of it.

    `build` takes the machine, the strength (1: medium) and a generator, and returns the fields that it sets. `names`
    are the program's names of this kind (empty: outside its library, then `drivers` say what it depends on); `alike`
    are names of what these logs cannot tell from it. `ours` says that the program has this very law, `visible` that
    it can be seen at all: a gain that mass and friction take up cannot, and nothing is missing then.
    """

    effect: str
    name: str
    build: Callable[[Machine, float, np.random.Generator], Changes]
    names: tuple[str, ...] = ()
    ours: bool = True
    drivers: tuple[str, ...] = ()
    similar: tuple[str, ...] = ()
    visible: bool = True

    @property
    def verdict(self) -> str:
        """What a diagnosis should say."""
        if not self.visible:
            return "nothing_missing"
        return "effect" if self.names else "outside_library"

    def answer(self) -> dict[str, Any]:
        """Return the part of the sealed answer that is the same on each rig."""
        return {
            "effect": self.effect,
            "form": self.name,
            "form_in_library": self.ours and bool(self.names),
            "verdict": self.verdict,
            "effects": list(self.names),
            "alike": list(self.similar),
            "drivers": list(self.drivers),
        }


NOTHING: Form[Any] = Form("nothing", "nothing", lambda machine, level, random: {}, visible=False)


def find_form(forms: tuple[Form[Any], ...], effect: str, form: str | None, seed: int) -> Form[Any]:
    """Return the form of an effect, drawn by the seed where it is None; "nothing" is a null.

    Raises ValueError, with what is known, for an unknown effect or form.
    """
    if effect in ("", "nothing"):
        return NOTHING
    known = [one for one in forms if one.effect == effect]
    if not known:
        raise ValueError(f"effect {effect!r}: known are nothing, {', '.join(dict.fromkeys(f.effect for f in forms))}")
    if form is None:
        return known[int(np.random.default_rng([seed, 211]).integers(len(known)))]
    for one in known:
        if one.name == form:
            return one
    raise ValueError(f"form {form!r} of {effect}: known are {', '.join(one.name for one in known)}")


def level_of(strength: str | float) -> float:
    """Return the factor of a strength's name, or the number itself."""
    if isinstance(strength, str):
        if strength not in STRENGTHS:
            raise ValueError(f"strength {strength!r}: give one of {', '.join(STRENGTHS)}, or a factor")
        return STRENGTHS[strength]
    return float(strength)
