"""Compose a plant's equations with effects into the flat source of three functions: rates, contact, readings."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from hjcamp.errors import UsageError
from hjcamp.model.effect import Effect, Term
from hjcamp.model.effect_names import check_effect
from hjcamp.model.parameter import Contact, Cut, Parameter, State
from hjcamp.model.plant import Plant
from hjcamp.model.source_text import GATES, behind_one_test, copied_function, function_source, live, names_in
from hjcamp.model.vocabulary import Statement, Vocabulary, read_vocabulary

MOST_GATED = 52


@dataclass(frozen=True)
class Composition:
    """A plant with effects, some of its states driven by measurements (``cut``): names and their positions.

    With ``gated`` every effect has a parameter ``gate.<effect>``; at 0 the effect is absent. The source tests a bit of
    their sum: one test for a whole slot is much faster than a comparison for each effect.
    """

    plant: type[Plant]
    effects: tuple[type[Effect], ...] = ()
    cut: Cut = Cut("whole")
    gated: bool = False

    def __post_init__(self) -> None:
        for effect in self.effects:
            check_effect(effect, self.plant)
        if self.gated and len(self.effects) > MOST_GATED:
            raise UsageError(
                f"{len(self.effects)} effects in the library; at most {MOST_GATED} can be compared at once"
            )

    @cached_property
    def vocabulary(self) -> Vocabulary:
        """The plant's slots and signals."""
        return read_vocabulary(self.plant)

    @cached_property
    def states(self) -> dict[str, State]:
        """All states by full name: the plant's, then ``effect.state``."""
        found = dict(self.plant.states)
        for effect in self.effects:
            found.update({f"{effect.name}.{name}": state for name, state in effect.states.items()})
        return found

    @cached_property
    def parameters(self) -> dict[str, Parameter]:
        """All parameters by full name: the plant's, then ``effect.parameter``, then the gates."""
        found = dict(self.plant.parameters)
        for effect in self.effects:
            found.update({f"{effect.name}.{name}": parameter for name, parameter in effect.parameters.items()})
        if self.gated:
            found.update({f"gate.{effect.name}": Parameter("1", 0.0) for effect in self.effects})
            found[GATES] = Parameter("1", 0.0, text="sum of 2^k over the open gates k, set by the simulator")
        return found

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs in the input vector: the plant's, then the slopes of the driven states."""
        return (*self.plant.sampled_inputs(), *(f"slope_{state}" for state in self.cut.driven))

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """The plant's contacts, in order."""
        return self.vocabulary.contacts

    @property
    def held(self) -> tuple[int, ...]:
        """Positions of the states that the contacts hold at 0, in their order."""
        names = list(self.states)
        return tuple(names.index(contact.velocity) for contact in self.contacts)

    @property
    def free(self) -> tuple[bool, ...]:
        """Whether each contact is simulated: its velocity is not driven."""
        driven = {*self.cut.slopes, *self.cut.driven}
        return tuple(contact.velocity not in driven for contact in self.contacts)

    @property
    def observed(self) -> tuple[str, ...]:
        """The states that are measured: those that the plant says, else those that its sensors are of, once each."""
        of = (item.of for item in self.plant.measured.values())
        return tuple(self.plant.observed) or tuple(dict.fromkeys(name for name in of if name))

    @property
    def measured(self) -> tuple[str, ...]:
        """The signals that the sensors show, in channel order."""
        shown = tuple(channel.signal for channel in self.plant.channels)
        return shown or tuple(item.sensor for item in self.plant.measured.values())

    def rates_source(self) -> str:
        """Return the source of ``rates(limits, time, direction, z, u, p, f)``: the rates of the states that are present.

        ``limits`` is the code of what every limiter is to do, as `limiting` returns it; negative: what its value says.
        """
        blocks: list[tuple[str, list[str]]] = [("", [])]
        for index, name in enumerate(self.states):
            gate = self.gate(name)
            if gate != blocks[-1][0]:
                blocks.append((gate, []))
            blocks[-1][1].append(f"f[{index}] = {self.rate(name)}")
        lines, gated = blocks[0][1], blocks[1:]
        if gated:
            # One test for all of them: most models have no effect with states.
            inside = [line for gate, own in gated for line in (f"if {gate}:", *(f"    {one}" for one in own))]
            lines = [*lines, f"if {self.any_gate}:", *(f"    {line}" for line in inside)]
        body = [re.sub(r"\blimited\(", "bounded(limits, ", line) for line in self.body(lines)]
        return function_source("rates(limits, time, direction, z, u, p, f)", body)

    def contact_source(self) -> str:
        """Return the source of ``contact(k, time, direction, z, u, p)``: push, limit and locks of contact k; of ``locking``,
        the last alone; and of ``facing`` and ``faced``, which read and set the side that it is on.
        """
        wanted = [f"return {one.push}, {one.limit}, {one.locks}" for one in self.contacts] or ["return 0.0, 0.0, 0.0"]
        locks = [f"return 1.0 * {one.locks}" for one in self.contacts] or ["return 0.0"]
        return (
            self._of_each("contact(k, time, direction, z, u, p)", wanted)
            + self._of_each("locking(k, time, direction, z, u, p)", locks)
            + self._of_each("facing(direction, k)", [f"return {side}" for side in self._sides] or ["return 0.0"])
            + self._of_each(
                "faced(direction, k, side)",
                [f"return direction + {3**k}.0 * (side - {side})" for k, side in enumerate(self._sides)]
                if len(self.contacts) > 1
                else ["return side"],
            )
        )

    @property
    def _sides(self) -> list[str]:
        """The expression of each contact's side, -1, 0 or 1: ``direction`` is the sum of 3^k times side k."""
        count = len(self.contacts)
        if count == 1:
            return ["direction"]
        return [f"((int(direction) + {(3**count - 1) // 2}) // {3**k} % 3 - 1.0)" for k in range(count)]

    def direction(self, sides: Mapping[str, float]) -> float:
        """Return what stands for the sides of all contacts, from the values of their directions by name; 0 where not given."""
        return float(sum(3**k * sides.get(one.direction, 0.0) for k, one in enumerate(self.contacts)))

    def _of_each(self, signature: str, last: Sequence[str]) -> str:
        """Return the source of a function that returns for contact ``k`` what the k-th line says."""
        lines = []
        for k, one in enumerate(last[:-1]):
            lines += [f"if k == {k}:", *(f"    {line}" for line in self.body([one]))]
        return function_source(signature, [*lines, *self.body([last[-1]])])

    def limiting_source(self) -> str:
        """Return the source of ``limiting(time, direction, z, u, p)``: the code of what the limiters do.

        It is the sum over the limiters of 3^k, twice that where a limiter holds its high end.
        """
        lines = [f"return {' + '.join(self._limiters) or '0'}"]
        return function_source("limiting(time, direction, z, u, p)", self.body(lines))

    @property
    def _limiters(self) -> list[str]:
        return [
            f"(({3**k} if {value} < {low} else 0) + ({2 * 3**k} if {value} > {high} else 0))"
            for k, (value, low, high) in enumerate(self.vocabulary.limits)
        ]

    @property
    def limits_vary(self) -> bool:
        """Whether what a limiter does can change between two samples, while the states stay: it depends on an input."""
        last = [f"return {' + '.join(self._limiters)}"] if self._limiters else []
        return any(name.startswith("u_") for name in names_in("\n".join(self.body(last))))

    def readings_source(self) -> str:
        """Return the source of ``readings(time, direction, z, u, p, out)``: what the sensors see, in channel order."""
        lines = [f"out[{index}] = {signal}" for index, signal in enumerate(self.measured)]
        return function_source("readings(time, direction, z, u, p, out)", self.body(lines))

    def balance_source(self) -> str:
        """Return the source of ``balance(time, direction, z, u, p, out)``: the plant's force balance."""
        lines = [f"out[{index}] = {name}" for index, name in enumerate(self.plant.balance)]
        return function_source("balance(time, direction, z, u, p, out)", self.body(lines))

    def signals_source(self) -> str:
        """Return the source of ``signals(time, direction, z, u, p, out)``: every slot and signal, in order."""
        lines = [f"out[{index}] = {name}" for index, name in enumerate(self.vocabulary.signals)]
        return function_source("signals(time, direction, z, u, p, out)", self.body(lines))

    def memory_source(self) -> str:
        """Return the source of ``begin`` and ``renew`` (starts of all own states, of those known from the observed ones)
        and ``remember`` (their once-per-sample updates)."""
        kinds: dict[str, dict[int, str]] = {"begin": {}, "renew": {}, "remember": {}}
        for index, name in enumerate(self.states):
            start, update = self.start(name), self.update(name)
            if start:
                kinds["begin"][index] = start
            if start and self.states[name].known:
                kinds["renew"][index] = start
            if update:
                kinds["remember"][index] = update
        parts = []
        for name, found in kinds.items():
            # all are computed before any is stored, since they may use each other
            lines = [self._where_open(index, f"next_{index} = {value}") for index, value in found.items()]
            lines += [self._where_open(index, f"z[{index}] = next_{index}") for index in found]
            parts.append(function_source(f"{name}(time, direction, z, u, p)", self.body(lines)))
        return "".join(parts)

    def _where_open(self, index: int, line: str) -> str:
        gate = self.gate(list(self.states)[index])
        return f"if {gate}: {line}" if gate else line

    def gate(self, state: str) -> str:
        """Return the test in the source of the gate that a state is behind; empty where there is none."""
        return self._gate(self._owner(state)[0]) if self.gated and "." in state else ""

    @property
    def any_gate(self) -> str:
        """The test in the source whether any effect with states is present; empty where there is none behind a gate."""
        bits = {self._bit(self._owner(state)[0]) for state in self.states if "." in state}
        return f"{GATES} & {sum(bits)}" if self.gated and bits else ""

    def start(self, state: str) -> str:
        """Return the expression that an effect's state starts with; empty for a state of the plant."""
        if "." not in state:
            return ""
        effect, own = self._owner(state)
        if own in effect.starts:
            return self._call(effect, f"start_{own}", effect.starts[own])
        return repr(effect.states[own].start)

    def update(self, state: str) -> str:
        """Return the expression that an effect's state takes after each sample; empty where it has none."""
        if "." not in state:
            return ""
        effect, own = self._owner(state)
        return self._call(effect, f"next_{own}", effect.updates[own]) if own in effect.updates else ""

    def _owner(self, state: str) -> tuple[type[Effect], str]:
        name, own = state.split(".")
        return next(effect for effect in self.effects if effect.name == name), own

    def terms_source(self) -> str:
        """Return the source of every effect's functions, copied so that the kernel's hash sees their text."""
        return "\n".join(copied_function(name, function) for name, function in term_functions(self.effects).items())

    def body(self, last: Sequence[str]) -> list[str]:
        """Return the statements that ``last`` needs, in order, then ``last``."""
        lines = live(self._statements, "\n".join(last))
        if not self.gated:
            return [*lines, *last]
        return [*behind_one_test(self._behind_gates(lines)), *self._behind_gates(last)]

    def _behind_gates(self, lines: Sequence[str]) -> list[str]:
        """Return the statements with what belongs to an effect read where it is used: behind its gate."""
        places = {f"s_{_local(name)}": f"z[{index}]" for index, name in enumerate(self.states) if "." in name}
        places |= {f"p_{_local(name)}": f"p[{index}]" for index, name in enumerate(self.parameters) if "." in name}
        kept = [line for line in lines if line.partition(" = ")[0] not in places]
        return [re.sub(r"\b[sp]_\w+\b", lambda found: places.get(found[0], found[0]), line) for line in kept]

    @cached_property
    def _statements(self) -> list[str]:
        lines = [
            f"s_{_local(name)} = {_held_up(f'z[{index}]', state)}"
            for index, (name, state) in enumerate(self.states.items())
        ]
        lines += [f"p_{_local(name)} = p[{index}]" for index, name in enumerate(self.parameters)]
        lines += [f"u_{name} = u[{index}]" for index, name in enumerate(self.inputs)]
        lines += [f"{GATES} = int(p_{GATES})", "u_time = time", "u_direction = direction"]
        if len(self.contacts) > 1:
            lines += [f"u_{one.direction} = {side}" for one, side in zip(self.contacts, self._sides, strict=True)]
        lines += [f"s_{state} = u_slope_{driven}" for state, driven in self.cut.slopes.items()]
        for line in self.vocabulary.statements:
            target = f"d_{line.target}" if line.mark == "rate" else line.target
            lines.append(f"{target} = {line.expression}")
            if line.mark == "slot":
                lines += self._effects_on(line)
        return lines

    def _effects_on(self, line: Statement) -> list[str]:
        adding, changing = [], []
        for effect in self.effects:
            if line.target not in effect.terms:
                continue
            term = effect.terms[line.target]
            call = self._call(effect, line.target, term)
            gate = f"if {self._gate(effect)}: " if self.gated else ""
            if line.target in term.arguments:
                changing.append(f"{gate}{line.target} = {call}")
            else:
                adding.append(f"{gate}{line.target} = {line.target} + {call}")
        return adding + changing

    def _gate(self, effect: type[Effect]) -> str:
        return f"{GATES} & {self._bit(effect)}"

    def _bit(self, effect: type[Effect]) -> int:
        return 1 << self.effects.index(effect)

    def rate(self, name: str) -> str:
        """Return the expression of a state's rate with its gate open, 0 where it is driven or frozen."""
        if name in self.cut.driven:
            return f"u_slope_{name}"
        if name in self.cut.slopes or name in self.cut.frozen:
            return "0.0"
        if "." not in name:
            return f"d_{name}"
        effect, own = self._owner(name)
        if own not in effect.rates:
            return "0.0"
        return self._call(effect, f"d_{own}", effect.rates[own])

    def _call(self, effect: type[Effect], name: str, term: Term) -> str:
        names = [self._resolve(effect, argument) for argument in term.arguments]
        return f"{effect.name}__{name}({', '.join(names)})"

    def _resolve(self, effect: type[Effect], argument: str) -> str:
        if argument in effect.states:
            return f"s_{effect.name}_{argument}"
        if argument in effect.parameters:
            return f"p_{effect.name}_{argument}"
        if argument in self.vocabulary.signals:
            return argument
        if argument in self.plant.states:
            return f"s_{argument}"
        if argument in self.plant.parameters:
            return f"p_{argument}"
        return f"u_{argument}"


def term_functions(effects: Sequence[type[Effect]]) -> dict[str, Callable[..., float]]:
    """Return every function of the effects by its name in the composed source."""
    found = {}
    for effect in effects:
        groups = {"": effect.terms, "d_": effect.rates, "next_": effect.updates, "start_": effect.starts}
        for prefix, functions in groups.items():
            found.update({f"{effect.name}__{prefix}{name}": term.function for name, term in functions.items()})
    return found


def _held_up(value: str, state: State) -> str:
    """Return the value that equations see of a state: a step may end a rounding error below what it cannot fall below."""
    return f"max({value}, {state.low!r})" if math.isfinite(state.low) else value


def _local(name: str) -> str:
    return name.replace(".", "_")
