"""The compiled models that an analysis needs: one without effects, and one with the whole library behind gates."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

from hjcamp.errors import UsageError
from hjcamp.model.compile.compiled_ahead import compile_ahead
from hjcamp.model.compile.compose import MOST_GATED, Composition
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.plant import Plant
from hjcamp.model.run.simulator import Simulator


@dataclass
class Kernels:
    """Simulators of a plant with any of ``effects``, each compiled once; where ``ahead``, by another process before it is needed."""

    plant: type[Plant]
    effects: Mapping[str, type[Effect]]
    ahead: bool = False
    _held: tuple[str, ...] = ()
    _foreseen: Mapping[str, type[Effect]] = field(default_factory=dict)
    _chunks: list[tuple[str, ...]] = field(default_factory=list)
    _made: dict[tuple[str, ...], Simulator] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._cut()

    def add(self, effects: Mapping[str, type[Effect]]) -> None:
        """Let further effects be part of models, too."""
        self.effects = {**self.effects, **effects}
        self._cut()

    def foresee(self, effects: Mapping[str, type[Effect]]) -> None:
        """Let effects that may be added have their gates from the first, unless all are too many for one kernel."""
        self._foreseen = effects
        self._cut()

    def hold(self, names: Collection[str]) -> None:
        """Let these effects be part of models in addition to any other one without a further kernel."""
        self._held = tuple(names)
        self._cut()

    def _cut(self) -> None:
        """Cut the effects into chunks for one kernel each; the forms of contacts and what is held belong to every chunk."""
        kept = {name for name, effect in self.effects.items() if effect.granted} | set(self._held)
        # in the same order before and after those that were foreseen are added
        others = [name for name in self.effects if name not in self._foreseen]
        rest = [*others, *self._foreseen] if len(others) + len(self._foreseen) <= MOST_GATED else list(self.effects)
        first, rest = rest[:MOST_GATED], rest[MOST_GATED:]
        size = MOST_GATED - len(kept)
        self._chunks = [tuple(first)] if first else []
        for k in range(0, len(rest), size):
            part = kept.union(rest[k : k + size])
            self._chunks.append(tuple(name for name in self.effects if name in part))

    def prepare(self, names: Collection[str]) -> None:
        """Let what models with one of these effects need be compiled ahead: this process itself begins with the first of it."""
        wanted = [chunk for chunk in self._chunks if not set(names).isdisjoint(chunk)]
        if self.ahead:
            compile_ahead([self._simulator(chunk).checked_source for chunk in (*wanted[1:], *wanted[:1])])

    def model(self, candidate: Candidate) -> tuple[Simulator, dict[str, float]]:
        """Return the simulator for a candidate and its parameters by full name, gates among them."""
        wanted = tuple(candidate.effects)
        for name in wanted:
            if name not in self.effects:
                raise UsageError(f"effect {name}: plant {self.plant.name} has none of that name")
        chosen = self._chosen(wanted)
        values = {name: value for name, value in candidate.base.items() if name in self.plant.parameters}
        for name, own in candidate.effects.items():
            values |= {f"{name}.{key}": value for key, value in own.items()}
            if len(chosen) > 0 and self._gated(chosen):
                values[f"gate.{name}"] = 1.0
        return self._simulator(chosen), values

    def _gated(self, chosen: Sequence[str]) -> bool:
        return tuple(chosen) in self._chunks

    def _chosen(self, wanted: Collection[str]) -> tuple[str, ...]:
        if not wanted:
            return ()
        for chunk in self._chunks:
            if set(wanted) <= set(chunk):
                return chunk
        return tuple(sorted(wanted))

    def _simulator(self, chosen: tuple[str, ...]) -> Simulator:
        if chosen not in self._made:
            effects = tuple((self.effects.get(name) or self._foreseen[name]) for name in chosen)
            self._made[chosen] = Simulator(Composition(self.plant, effects, gated=self._gated(chosen)), free=True)
        return self._made[chosen]
