# ruff: noqa: F841, RET504 - lines of a plant and of a part are read, not run
"""Lines that are written once: written out with names of their own, for plants, laws and effects alike."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from hjcamp.errors import UsageError
from hjcamp.model.compile.compose import Composition
from hjcamp.model.compile.function_sources import rates_source, signals_source
from hjcamp.model.compile.source_text import copied_function
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.law import Law, Memory, law_function
from hjcamp.model.declare.part import whole_code, whole_definition
from hjcamp.model.language.effect_names import check_effect
from hjcamp.model.language.effect_units import check_units
from hjcamp.model.language.vocabulary import read_vocabulary
from hjcamp.plant import Input, Measured, Parameter, Plant, State, part, sensor, signal, slot
from hjcamp.plants.pump_joint import PumpJoint


def lag(target, level, parameter, rate):  # type: ignore[no-untyped-def]
    missing = slot(target - level, "m", "what is missing")
    pace = missing / parameter.time
    rate[level] = pace
    return pace


class Chain(Plant):
    """Two lags in a row."""

    name = "chain"
    first = State("m", typical=1.0)
    second = State("m", typical=1.0)
    drive = Input("m")
    time = Parameter("s", 2.0, base=True)
    second_m = Measured("gauge", of="second")

    @staticmethod
    def equations(state, parameter, drive, rate):  # type: ignore[no-untyped-def]
        fast = part(lag, 2.0 * drive.drive, state.first, parameter, rate)
        slow = part(lag, level=state.second, target=state.first, parameter=parameter, rate=rate)
        both = signal(fast + slow, "m/s", "sum")
        gauge = sensor(state.second)


class WrittenTwice(Plant):
    """The same, line by line."""

    name = "chain"
    first = State("m", typical=1.0)
    second = State("m", typical=1.0)
    drive = Input("m")
    time = Parameter("s", 2.0, base=True)
    second_m = Measured("gauge", of="second")

    @staticmethod
    def equations(state, parameter, drive, rate):  # type: ignore[no-untyped-def]
        fast_target = 2.0 * drive.drive
        fast_missing = slot(fast_target - state.first, "m", "what is missing")
        fast = fast_missing / parameter.time
        rate.first = fast
        slow_missing = slot(state.first - state.second, "m", "what is missing")
        slow = slow_missing / parameter.time
        rate.second = slow
        both = signal(fast + slow, "m/s", "sum")
        gauge = sensor(state.second)


def test_equations_of_parts_are_those_written_line_by_line() -> None:
    made, by_hand = (Composition(plant) for plant in (Chain, WrittenTwice))
    assert made.vocabulary.slots.keys() >= {"fast_missing", "slow_missing"}
    assert rates_source(made) == rates_source(by_hand)
    assert signals_source(made) == signals_source(by_hand)


def test_a_line_of_a_part_is_told_by_the_line_that_uses_it() -> None:
    of_part = read_vocabulary(Chain).slots["slow_missing"].line
    text = Path(__file__).read_text(encoding="utf-8").splitlines()[of_part - 1]
    assert text.strip().startswith("slow = part(lag")


def proportional(error, sample, parameter, memory, total):  # type: ignore[no-untyped-def]
    memory[total] = memory[total] + error * sample.period
    if error > 0.0:
        share = 1.0
    else:
        share = 0.5
    return share * (parameter.gain * error + memory[total]), memory[total]


class TwoLoops(Law):
    """Two loops of one part, each with a memory of its own."""

    samples = ("one", "two", "period")
    results = ("first", "second", "total")
    gain = Parameter("1", 3.0)
    total1 = Memory()
    total2 = Memory()

    @staticmethod
    def step(sample, parameter, memory):  # type: ignore[no-untyped-def]
        first, held1 = part(proportional, sample.one, sample, parameter, memory, "total1")
        second, held2 = part(proportional, sample.two - first, sample, parameter, memory, total="total2")
        return first, second, held1 + held2


def test_a_law_uses_a_part_twice_with_two_memories() -> None:
    step, memory = law_function(TwoLoops, {}), TwoLoops.fresh_memory()
    # by hand: total1 = 0.1 -> 3.1; error of the second 0.5 - 3.1 = -2.6 -> total2 = -0.26, 0.5 (3 (-2.6) - 0.26)
    assert step(1.0, 0.5, 0.1, TwoLoops.vector({}), memory) == pytest.approx((3.1, -4.03, -0.16))
    assert memory == pytest.approx([0.1, -0.26])


def capped(force, most, share):  # type: ignore[no-untyped-def]
    kept = force * share
    return min(kept, most)


class Capped(Effect):
    """A cap on both frictions."""

    name = "capped"
    subsystem = "joint"
    most = Parameter("N", 1.0, (0.0, 9.0))

    @staticmethod
    def friction_static(friction_static, most):  # type: ignore[no-untyped-def]
        return part(capped, friction_static, most, 0.5)

    @staticmethod
    def friction_coulomb(friction_coulomb, most):  # type: ignore[no-untyped-def]
        whole = part(capped, share=1.0, force=friction_coulomb, most=most)
        return whole


def test_an_effect_uses_a_part_and_its_units_are_checked() -> None:
    check_effect(Capped, PumpJoint)
    check_units(Capped, PumpJoint)
    text = copied_function("capped__static", Capped.terms["friction_static"].function)
    assert text.endswith("kept = friction_static * 0.5\n    return min(kept, most)\n\n")
    assert Capped.terms["friction_coulomb"].function(5.0, 2.0) == 2.0  # plain Python calls the part

    class Wrong(Effect):
        """Its part is given a length."""

        name = "wrong"
        subsystem = "joint"
        most = Parameter("m", 1.0, (0.0, 9.0))

        @staticmethod
        def friction_static(friction_static, most):  # type: ignore[no-untyped-def]
            return part(capped, friction_static, most, 0.5)

    with pytest.raises(UsageError, match=r"effect wrong, method 'friction_static': adds kg\*m/s\^2 and m"):
        check_units(Wrong, PumpJoint)


def around(x):  # type: ignore[no-untyped-def]
    again = part(back, x)
    return again


def back(x):  # type: ignore[no-untyped-def]
    found = part(around, x)
    return found


def early(x):  # type: ignore[no-untyped-def]
    if x > 0.0:
        return x
    return -x


def fixed(x, rate):  # type: ignore[no-untyped-def]
    rate.level = x
    return x


def assigning(x):  # type: ignore[no-untyped-def]
    x = x + 1.0
    return x


def of_itself(x):  # type: ignore[no-untyped-def]
    y = part(around, x)
    return y


def of_nothing(x):  # type: ignore[no-untyped-def]
    y = part(capd, x)  # type: ignore[name-defined]  # noqa: F821
    return y


def of_an_element(x):  # type: ignore[no-untyped-def]
    y = part(signal, x, "m", "a mark is no part")
    return y


def of_a_wrong_argument(x):  # type: ignore[no-untyped-def]
    y = part(capped, x, most=1.0, sahre=2.0)
    return y


def of_too_little(x):  # type: ignore[no-untyped-def]
    y = part(capped, x)
    return y


def of_an_early_end(x):  # type: ignore[no-untyped-def]
    y = part(early, x)
    return y


def within_an_expression(x):  # type: ignore[no-untyped-def]
    return 1.0 + part(capped, x, 1.0, 1.0)


def owned_twice(x, rate):  # type: ignore[no-untyped-def]
    y = part(fixed, x, rate)
    z = part(fixed, y, rate)
    return y + z


def assigned(x):  # type: ignore[no-untyped-def]
    y = part(assigning, x)
    return y


def clashing(x):  # type: ignore[no-untyped-def]
    y_kept = 1.0
    y = part(capped, x, y_kept, 1.0)
    return y


def of_two_names(x):  # type: ignore[no-untyped-def]
    y = z = part(capped, x, 1.0, 1.0)
    return y + z


def starred(x):  # type: ignore[no-untyped-def]
    y = part(capped, *x)
    return y


REFUSED: dict[Callable[..., Any], str] = {
    of_itself: r"part 'around' calls itself \(around -> back -> around\)",
    of_nothing: "unknown part 'capd'.*did you mean 'capped'",
    of_a_wrong_argument: "unknown argument 'sahre' in .*part 'capped'; did you mean 'share'",
    of_too_little: "part 'capped' lacks 'most'; it takes force, most, share",
    of_an_early_end: "part 'early': its one return must be its last line",
    within_an_expression: r"write NAME = part\(\.\.\.\) on a line of its own",
    of_two_names: r"write NAME = part\(\.\.\.\) on a line of its own",
    starred: "part 'capped': it takes its arguments one by one",
    owned_twice: r"'rate.level' is set by part 'fixed' before, and a state of its own serves one part only.*rate\[level\]",
    assigned: "part 'assigning': it assigns its argument 'x'",
    clashing: "part 'capped': its 'y_kept' is also a name here",
}


@pytest.mark.parametrize("function", REFUSED, ids=lambda function: function.__name__)
def test_what_is_wrong_with_a_part_is_told_with_file_and_line(function: Callable[..., Any]) -> None:
    with pytest.raises(UsageError, match=REFUSED[function]) as refused:
        whole_definition(function)
    assert re.match(r".*test_parts\.py: line \d+: |unknown .* in .*test_parts\.py: line \d+", str(refused.value))


def test_an_unknown_parameter_in_a_part_is_told() -> None:
    class Wrong(Law):
        samples, results = TwoLoops.samples, TwoLoops.results
        gane = Parameter("1", 3.0)
        total1, total2 = Memory(), Memory()
        step = TwoLoops.step

    with pytest.raises(UsageError, match=r"unknown parameter 'gain'.*did you mean 'gane'"):
        law_function(Wrong, {})


def into_an_array(x, memory):  # type: ignore[no-untyped-def]
    memory.errors[0] = part(capped, x, 1.0, share=2.0)


def test_a_result_may_go_into_an_array() -> None:
    lines = [ast.unparse(line) for line in whole_definition(into_an_array).body]
    assert lines == ["memory_errors_0_kept = x * 2.0", "memory.errors[0] = min(memory_errors_0_kept, 1.0)"]


def shadowed(x):  # type: ignore[no-untyped-def]
    x = part(grown, x)
    return x


def grown(value):  # type: ignore[no-untyped-def]
    total = 1.0
    total = total + value
    return total


def test_a_name_that_an_argument_uses_is_not_overwritten_too_early() -> None:
    scope: dict[str, Any] = {}
    tree = ast.Module([whole_definition(shadowed)], [])
    exec(compile(ast.fix_missing_locations(tree), "<test>", "exec"), scope)
    assert scope["shadowed"](5.0) == shadowed(5.0) == 6.0
    assert "part" not in whole_code(shadowed).co_names
