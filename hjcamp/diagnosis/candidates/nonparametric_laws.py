"""Unknowns: laws without a form, hats over what may drive them. They compete with the named effects and are never named.

Each gives a place what no law says: a force over position, friction over speed, a loss over level
(Kennedy & O'Hagan 2001, doi:10.1111/1467-9868.00294, with a piecewise linear basis instead of a Gaussian process).
"""

from __future__ import annotations

import linecache
import re
from collections.abc import Callable
from functools import lru_cache
from math import floor, hypot
from types import new_class
from typing import Any

from hjcamp.diagnosis.data.segments import NUMBER
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter
from hjcamp.model.declare.table import Table

BIG = (-1e9, 1e9)
# Names of its own that no state or parameter of a plant is likely to have.
ENDS, KNOT, AT = ("knots_from", "knots_to"), "knot_", "knots_at"
# Where a law has a course of its own for each condition these stand so far apart on its axis.
APART = "conditions_apart"


class _Hats:
    r"""Gives a law the parameters and the methods of h, piecewise linear through ``knots`` knots from the one of `ENDS` to the other.

    .. math:: h(x) = \sum_k a_k \max(0, 1 - |w - k|), \quad w = (n - 1) \min(\max(\tfrac{x - low}{high - low}, 0), 1)

    ``on`` are the slots on which it acts, in units of the last one, ``against`` those that it takes from; ``over`` is what drives
    it, a name or a formula. A law that ``changes`` its slot comes after all that add to it; one that is a share of something is
    so many ``times`` that, and its driver is in ``unit``.
    One that is ``positive`` leaves h + sqrt(1 + h^2) times its slot, whatever h is. One that ``turns`` repeats from end to end.
    """

    positive = False

    def __init_subclass__(
        cls, on: str, over: str, knots: int, changes: bool = False, times: str = "", unit: str = "",
        positive: bool = False, against: str = "", turns: bool = False,
    ) -> None:  # fmt: skip
        slots, unit = on.split(), unit or ("s" if over == "time" else over.partition(" ")[0])
        own = {ENDS[0]: Parameter(unit, -1.0, BIG), ENDS[1]: Parameter(unit, 1.0, (-9e8, 1.1e9))}
        own |= {f"{KNOT}{k}": Parameter("1" if times else slots[-1], 0.0, BIG, off=0.0) for k in range(knots)}
        for name, parameter in own.items():
            setattr(cls, name, parameter)
            parameter.__set_name__(cls, name)
        for slot in (*slots, *against.split()):
            taken = slot in against.split()
            setattr(
                cls, slot, staticmethod(_sum_of_hats(cls.__name__, slot, over, knots, changes, times, positive, taken, turns))
            )
        cls.positive = positive
        super().__init_subclass__()


def _sum_of_hats(
    law: str, slot: str, over: str, knots: int, changes: bool, times: str, positive: bool, taken: bool, turns: bool
) -> Callable[..., Any]:
    """Return the method of a slot; its text is kept where ``inspect``, and so the kernel, finds it."""
    first = [*([slot] if changes or times == slot else []), *re.findall(r"[A-Za-z_]\w*", over), *([times] if times else [])]
    names = [*dict.fromkeys(first), *ENDS, *(f"{KNOT}{k}" for k in range(knots))]
    factor = f"{times} * " if times else ""
    hats = [f"{factor}{KNOT}{k} * max(0.0, 1.0 - abs({AT}{f' - {k}.0' if k else ''}))" for k in range(knots)]
    share = " + ".join(one.removeprefix(factor) for one in hats)
    whole = f"{slot} * (({share}) + hypot(1.0, {share}))" if positive else f"-({share})" if taken else ""
    share_of = f"({over} - {ENDS[0]}) / ({ENDS[1]} - {ENDS[0]})"
    within = f"({share_of} - floor({share_of}))" if turns else f"min(max({share_of}, 0.0), 1.0)"
    text = (
        f"def {slot}({', '.join(names)}):\n"
        f'    """Value at this {over}."""\n'
        f"    {AT} = {knots - 1}.0 * {within}\n"
        f"    return {whole or ' + '.join([*([slot] if slot in names else []), *hats])}\n"
    )
    file = f"<{__name__}.{law}.{slot}.{knots}>"
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    scope: dict[str, Any] = {"__name__": __name__, "hypot": hypot, "floor": floor}
    exec(compile(text, file, "exec"), scope)
    method: Callable[..., Any] = scope[slot]
    sum_of = "interpolated({{table}}, {share}, {start}, {factor})".format
    both = {"share": f"{share_of} - floor({share_of})" if turns else share_of}
    plain = sum_of(**both, start="0.0", factor="1.0")
    scaled = sum_of(**both, start=slot if slot in names else "0.0", factor=times or "1.0")
    read = f"{slot} * rooted({plain})" if positive else f"-{plain}" if taken else scaled
    vars(method)["table"] = Table(f"{KNOT}0", knots, read)
    return method


class ForceOverPosition(_Hats, Effect, on="force", over="position", knots=12):
    r"""A force on a body that depends on its position, the same in both directions.

    .. math:: F \mathrel{+}= h(x)
    """

    acts_on = "body"


class FineForceOverPosition(_Hats, Effect, on="force", over="position", knots=48):
    r"""The same with knots four times as near: a force that repeats along the travel, as of teeth, poles or the turns of a screw.

    .. math:: F \mathrel{+}= h(x)
    """

    acts_on = "body"


class TurningForceOverPosition(_Hats, Effect, on="force", over="position", knots=49, turns=True):
    r"""A force on a body that repeats with each turn, and many times in it: the cogging of a motor, teeth, a coupling that runs out.

    .. math:: M \mathrel{+}= h(\varphi \bmod 2\pi)
    """

    acts_on = "body"


class ForceOverVelocity(_Hats, Effect, on="force", over="velocity", knots=6):
    r"""A force on a body that depends on its velocity.

    .. math:: F \mathrel{+}= h(v)
    """

    acts_on = "body"


class ForceOverTime(_Hats, Effect, on="force", over="time", knots=6):
    r"""A force on a body that changes during a test.

    .. math:: F \mathrel{+}= h(t)
    """

    acts_on = "body"


class FrictionOverTravel(_Hats, Effect, on="static coulomb", over="travel", knots=12):
    r"""Dry friction of a contact that depends on where it is, against the motion.

    .. math:: F_s, F_c \mathrel{+}= h(x)
    """

    acts_on = "contact"


class FrictionOverSpeed(_Hats, Effect, on="coulomb", over="speed", knots=6):
    r"""Friction of a sliding contact that depends on its speed, the same in both directions.

    .. math:: F_c \mathrel{+}= h(|v|)
    """

    acts_on = "contact"


class FrictionOverTime(_Hats, Effect, on="static coulomb", over="time", knots=6):
    r"""Dry friction of a contact that changes during a test.

    .. math:: F_s, F_c \mathrel{+}= h(t)
    """

    acts_on = "contact"


class FrictionOverLoad(_Hats, Effect, on="static coulomb", over="load", knots=6):
    r"""Dry friction of a contact that depends on its load.

    .. math:: F_s, F_c \mathrel{+}= h(N)
    """

    acts_on = "contact"


class DampingOverTravel(_Hats, Effect, on="viscous", over="travel", knots=6):
    r"""Viscous friction of a contact that depends on where it is: a magnet next to a disc, a film of oil that is squeezed.

    .. math:: C_v \mathrel{+}= h(x)
    """

    acts_on = "contact"


class DampingOverTime(_Hats, Effect, on="viscous", over="time", knots=6):
    r"""Viscous friction of a contact that changes during a test, as where oil warms.

    .. math:: C_v \mathrel{+}= h(t)
    """

    acts_on = "contact"


class LossOverLevel(_Hats, Effect, on="loss", over="level", knots=6):
    r"""A loss of a store that depends on its level.

    .. math:: q \mathrel{+}= h(p)
    """

    acts_on = "store"


class LossOverTime(_Hats, Effect, on="loss", over="time", knots=6):
    r"""A loss of a store that changes during a test: a room that warms, a valve that somebody opens.

    .. math:: q \mathrel{+}= h(t)
    """

    acts_on = "store"


class LossOverDifference(_Hats, Effect, on="loss", against="loss_beyond", over="level - level_beyond", knots=6):
    r"""What leaks from one store into another one that no path joins, depending on the difference of their levels.

    .. math:: q_1 \mathrel{+}= h(p_1 - p_2), \quad q_2 \mathrel{-}= h(p_1 - p_2)
    """

    acts_on = "partition"


class FlowOverHead(_Hats, Effect, on="flow", over="head", knots=6, changes=True):
    r"""A flow of a path that depends on its head: what is upstream of it, less what is downstream where the path has that.

    .. math:: q \mathrel{+}= h(p)
    """

    acts_on = "path"


class CommandOverDemand(_Hats, Effect, on="command", over="command", knots=6, changes=True):
    r"""A drive that delivers another amount than its demand, depending on the demand as it arrives, behind a lag.

    .. math:: u \mathrel{+}= h(u)
    """

    acts_on = "actuator"


class OutputOverInput(_Hats, Effect, on="output", over="input", knots=12, changes=True):
    r"""A transmission that passes on another motion than comes in, depending on that: a shaft that stiffens, a gap, a tooth.

    .. math:: y \mathrel{+}= h(x)
    """

    acts_on = "transmission"


class OutputOverTwist(_Hats, Effect, on="output", over="twist", knots=12, changes=True):
    r"""A transmission that passes on another motion than comes in, depending on how far what is driven lags: a shaft that stiffens.

    .. math:: y \mathrel{+}= h(x - y_d)

    Its values are as large as the twist, however far the whole turns.
    """

    acts_on = "transmission"
    sized = "twist"


class ReadingOverTrue(_Hats, Effect, on="reading", over="reading", knots=12, changes=True):
    r"""A sensor whose error depends on the value, behind a lag.

    .. math:: y \mathrel{+}= h(x)
    """

    acts_on = "sensor"


LAWS: tuple[type[Effect], ...] = (
    ForceOverPosition, FineForceOverPosition, TurningForceOverPosition, ForceOverVelocity, ForceOverTime, FrictionOverTravel,
    FrictionOverSpeed, FrictionOverTime, FrictionOverLoad, DampingOverTravel, DampingOverTime, LossOverLevel, LossOverTime,
    LossOverDifference, FlowOverHead, CommandOverDemand, OutputOverInput, OutputOverTwist, ReadingOverTrue,
)  # fmt: skip


@lru_cache(maxsize=32)
def over_time_of_each(knots: int) -> tuple[type[Effect], ...]:
    r"""Return the force on a body and the loss of a store that change during a test, otherwise in each condition.

    .. math:: F \mathrel{+}= h(t + n\,a)

    for condition n, a as far apart as `APART` says: a room, a wind or a load that no log has. ``knots`` are those of all conditions.
    """
    own = {NUMBER: Parameter("1", 0.0, BIG), APART: Parameter("s", 1.0, BIG)}
    made = []
    for acts_on, slot in (("body", "force"), ("store", "loss")):
        about = {"on": slot, "over": f"time + {NUMBER} * {APART}", "knots": knots, "unit": "s"}
        body = {**own, "acts_on": acts_on}
        law: type[Effect] = new_class(f"{slot.capitalize()}OverTimeOfEach", (_Hats, Effect), about, _with(body))
        made.append(law)
    return tuple(made)


@lru_cache(maxsize=256)
def gain_over(
    plant: str, slot: str, times: str, driver: str, unit: str, positive: bool = False, of: str = "gain", subsystem: str = "gain"
) -> type[Effect]:
    r"""Return the law of a drive, a path or a store whose gain depends on a state of the plant, or changes during a test, in its names.

    .. math:: u \mathrel{+}= u_d\,h(x)

    ``times`` is what is asked of it (u_d), ``unit`` that of the ``driver``. What slips under pressure, a motor whose field
    weakens, an amplifier that warms, a pipe that clogs; a store that takes more the less is in it, a coil that saturates. Where
    ``slot`` and ``times`` are a parameter of the plant, that is no constant: oil that thins as it warms, an inertia that differs.
    """
    about = {"on": slot, "over": driver, "knots": 6, "times": times, "unit": unit, "positive": positive}
    own = {"subsystem": subsystem, "name": f"unknown_{of}_of_{slot}_over_{driver}"}
    # the text of its method is kept by the class' name
    made: type[Effect] = new_class(f"{of.capitalize()}_{plant}_{slot}_{driver}", (_Hats, Effect), about, _with(own))
    return made


def _with(own: dict[str, Any]) -> Callable[[dict[str, Any]], None]:
    """Return what gives the body of a class its own names."""
    return lambda body: body.update(own)


def amplitudes_of_law(law: type[Effect]) -> tuple[str, ...]:
    """Return the names of the values at a law's knots, in order."""
    return tuple(name for name in law.parameters if name.startswith(KNOT))
