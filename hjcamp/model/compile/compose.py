"""Compose a plant's equations with effects: names and positions, and the lines of which every generated function is made."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from hjcamp.errors import UsageError
from hjcamp.model.compile.reaction import with_reactions
from hjcamp.model.compile.source_text import GATES, behind_one_test, live, where_used
from hjcamp.model.declare.effect import Effect, Term, parameters_of
from hjcamp.model.declare.parameter import Contact, Cut, Parameter, State
from hjcamp.model.declare.plant import Plant
from hjcamp.model.declare.table import table_of
from hjcamp.model.language.effect_names import check_effect
from hjcamp.model.language.vocabulary import Vocabulary, read_vocabulary

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
            raise UsageError(f"{len(self.effects)} effects in the library; at most {MOST_GATED} can be compared at once")

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
    def dragged(self) -> tuple[int, ...]:
        """For each contact the position of the input that is its velocity, -1 where no input is."""
        slopes = [f"slope_{self.cut.slopes.get(contact.velocity, '')}" for contact in self.contacts]
        return tuple(self.inputs.index(slope) if slope in self.inputs else -1 for slope in slopes)

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

    @property
    def sides(self) -> list[str]:
        """The expression of each contact's side, -1, 0 or 1: ``direction`` is the sum of 3^k times side k."""
        count = len(self.contacts)
        if count == 1:
            return ["direction"]
        return [f"((int(direction) + {(3**count - 1) // 2}) // {3**k} % 3 - 1.0)" for k in range(count)]

    def direction(self, sides: Mapping[str, float]) -> float:
        """Return what stands for the sides of all contacts, from the values of their directions by name; 0 where not given."""
        return float(sum(3**k * sides.get(one.direction, 0.0) for k, one in enumerate(self.contacts)))

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

    def body(self, last: Sequence[str]) -> list[str]:
        """Return the statements that ``last`` needs, in order, then ``last``."""
        lines = live(self._statements, "\n".join(last))
        if not self.gated:
            return [*lines, *last]
        return [*behind_one_test(self._behind_gates(where_used(lines, last))), *self._behind_gates(last)]

    def _behind_gates(self, lines: Sequence[str]) -> list[str]:
        """Return the statements with what belongs to an effect read where it is used: behind its gate."""
        places = {f"s_{local_name(name)}": f"z[{index}]" for index, name in enumerate(self.states) if "." in name}
        places |= {f"p_{local_name(name)}": f"p[{index}]" for index, name in enumerate(self.parameters) if "." in name}
        kept = [line for line in lines if line.partition(" = ")[0] not in places]
        return [re.sub(r"\b[sp]_\w+\b", lambda found: places.get(found[0], found[0]), line) for line in kept]

    @cached_property
    def _statements(self) -> list[str]:
        lines = [
            f"s_{local_name(name)} = {_held_up(f'z[{index}]', state)}"
            for index, (name, state) in enumerate(self.states.items())
        ]
        lines += [f"p_{local_name(name)} = p[{index}]" for index, name in enumerate(self.parameters)]
        lines += [f"u_{name} = u[{index}]" for index, name in enumerate(self.inputs)]
        lines += [f"{GATES} = int(p_{GATES})", "u_time = time", "u_direction = direction"]
        if len(self.contacts) > 1:
            lines += [f"u_{one.direction} = {side}" for one, side in zip(self.contacts, self.sides, strict=True)]
        lines += [f"s_{state} = u_slope_{driven}" for state, driven in self.cut.slopes.items()]
        for name in self.vocabulary.changeable:
            lines += self._effects_on(name, f"p_{name}")
        equations = []
        for line in self.vocabulary.statements:
            target = f"d_{line.target}" if line.mark == "rate" else line.target
            equations.append(f"{target} = {line.expression}")
            if line.mark == "slot":
                equations += self._effects_on(target, target)
        if not self.vocabulary.pushed:
            equations = with_reactions(equations, self.contacts, self.vocabulary.unheld)
        return lines + equations

    @cached_property
    def _loose(self) -> dict[str, set[str]]:
        """The slots of the friction of each contact that does not lock, by the slot that says so: an effect there may have a leap."""
        said = {line.target: line.expression for line in self.vocabulary.statements}
        ports = [port for port in self.vocabulary.ports.values() if port.kind == "contact"]
        return {
            port.names["locks"]: {port.names[one] for one in ("static", "coulomb", "viscous", "friction") if one in port.names}
            for port in ports
            if said.get(port.names["locks"]) == "0.0"
        }

    def _effects_on(self, slot: str, local: str) -> list[str]:
        """Return what the effects make of a slot, which is called ``local`` in the lines."""
        adding, changing, last = [], [], []
        known = {*self.vocabulary.known_before(slot), slot} if slot in self.vocabulary.slots else set()
        rubbing = self._loose.get(slot, set())
        for effect in self.effects:
            gate = f"if {self._gate(effect)}: " if self.gated else ""
            if slot not in effect.terms:
                adding += [f"{gate}{local} = 1.0"] if rubbing & effect.terms.keys() else []
                continue
            term = effect.terms[slot]
            call = self._call(effect, slot, term, known)
            if slot == effect.behind:
                last += [f"{_arriving(effect)} = {local}", f"{gate}{local} = {call}"]
            elif slot in term.arguments:
                changing.append(f"{gate}{local} = {call}")
            else:
                adding.append(f"{gate}{local} = {local} + {call}")
        return adding + changing + last

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

    def _call(self, effect: type[Effect], name: str, term: Term, known: Collection[str] | None = None) -> str:
        """Return the call of a term; ``known`` are the signals that are computed where it stands, all of them if None."""
        known = self.vocabulary.signals if known is None else known
        names = [self._resolve(effect, argument, known) for argument in term.arguments]
        table = table_of(term.function)
        if table is None:
            return f"{effect.name}__{name}({', '.join(names)})"
        local = dict(zip(parameters_of(term.function), names, strict=True))
        first = list(self.parameters).index(f"{effect.name}.{table.first}")
        said = re.sub(r"\b[A-Za-z_]\w*\b", lambda word: local.get(word[0], word[0]), table.text)
        return said.replace("{table}", f"p, {first}, {table.count}")

    def _resolve(self, effect: type[Effect], argument: str, known: Collection[str]) -> str:
        """Return the local name of an argument: a signal, once it is computed, hides a state, parameter or input of its name."""
        if argument in effect.states:
            return f"s_{local_name(f'{effect.name}.{argument}')}"
        if argument in effect.parameters:
            return f"p_{local_name(f'{effect.name}.{argument}')}"
        if argument == effect.behind:
            return _arriving(effect)
        if argument in known:
            return argument
        if argument in self.plant.states:
            return f"s_{argument}"
        if argument in self.plant.parameters:
            return f"p_{argument}"
        return f"u_{argument}"


def term_functions(effects: Sequence[type[Effect]]) -> dict[str, Callable[..., float]]:
    """Return every function of the effects by its name in the composed source; those with a table share one."""
    found: dict[str, Callable[..., float]] = {}
    for effect in effects:
        groups = {"": effect.terms, "d_": effect.rates, "next_": effect.updates, "start_": effect.starts}
        for prefix, functions in groups.items():
            own = {f"{effect.name}__{prefix}{name}": term.function for name, term in functions.items()}
            found |= {name: function for name, function in own.items() if table_of(function) is None}
    return found


def _held_up(value: str, state: State) -> str:
    """Return the value that equations see of a state: a step may end a rounding error below what it cannot fall below."""
    return f"max({value}, {state.low!r})" if math.isfinite(state.low) else value


def _arriving(effect: type[Effect]) -> str:
    """Return the name of what arrives at an effect that changes its slot last."""
    return f"arriving_{effect.name}"


def local_name(name: str) -> str:
    """Return what a state or parameter is called in generated lines: parameter b of effect a is not the plant's own a_b."""
    return name.replace(".", "__")
