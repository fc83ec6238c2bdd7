"""Which effects a plant gets: its own, the generic ones at its places, and why the others do not fit."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from hjcamp.errors import UsageError, unknown
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.plant import Plant
from hjcamp.model.files.user_file import file_of, is_users
from hjcamp.model.language.binding import Unfit, bind, bind_instance, wanted_names
from hjcamp.model.language.effect_names import check_functions, check_names
from hjcamp.model.language.vocabulary import read_vocabulary


@dataclass(frozen=True)
class Library:
    """The effects that fit a plant, by name, the reason for each that does not, and what each file became."""

    plant: type[Plant]
    effects: Mapping[str, type[Effect]]
    unfit: Mapping[str, str]
    names: Mapping[str, tuple[str, ...]]

    def find(self, name: str) -> type[Effect]:
        """Return the effect of that name; raise ``UsageError`` with the reason why the plant has none."""
        if name in self.effects:
            return self.effects[name]
        if name in self.unfit:
            raise UsageError(self.unfit[name])
        if name in self.names:
            called = ", ".join(self.names[name])
            raise UsageError(f"effect {name}: plant {self.plant.name} has it as {called}")
        raise unknown("effect", name, self.effects)


def library_for(
    plant: type[Plant],
    files: Mapping[str, type[Effect]],
    others: Callable[[], Iterable[type[Plant]]] = lambda: (),
) -> Library:
    """Return which of the effects fit the plant, bound to its places, and why the others do not.

    A generic effect is called by its own name where the plant has one place for it, ``name_at_place`` where it has
    more, and as the plant says where it names its instances. Raises ``UsageError`` for a file that is wrong, and for
    one in other names than the plant's that does not say of which plant it is; ``others`` gives the plants it may mean.
    """
    found: dict[str, type[Effect]] = {}
    unfit: dict[str, str] = {}
    names: dict[str, tuple[str, ...]] = {}
    for name, effect in files.items():
        try:
            bound = _of_file(name, effect, plant, others)
        except Unfit as problem:
            unfit[name] = str(problem)
            continue
        except UsageError as problem:
            file = file_of(effect.__module__)
            raise UsageError(f"{file}: {problem}") if file and file not in str(problem) else problem from None
        names[name] = tuple(one.name for one in bound)
        for one in bound:
            if one.name in found:
                raise UsageError(
                    f"effect {name}: plant {plant.name} has an effect '{one.name}' already; choose another file name"
                )
            found[one.name] = one
    for instance in plant.instances:
        if instance.of not in files:
            raise unknown("effect", instance.of, files, f"plant {plant.name}, {instance.name}")
    # ours by name, then the user's as they were found: the order of the terms in a kernel
    ordered = sorted(found.items(), key=lambda one: (True, "") if is_users(one[1].__module__) else (False, one[0]))
    return Library(plant, dict(ordered), unfit, names)


def _of_file(
    name: str, effect: type[Effect], plant: type[Plant], others: Callable[[], Iterable[type[Plant]]]
) -> list[type[Effect]]:
    if effect.plant and effect.plant != plant.name:
        raise Unfit(f"effect {name}: is written in the names of plant {effect.plant} (--plant {effect.plant})")
    instances = [instance for instance in plant.instances if instance.of == name]
    if instances:
        bound = [bind_instance(instance, effect, plant) for instance in instances]
        for one in bound:
            check_names(one, plant)
        return bound
    if name in plant.covers:
        raise Unfit(f"effect {name}: plant {plant.name} needs none: {plant.covers[name]}")
    if effect.acts_on:
        wanted_names(effect)
        check_functions(effect)
        return list(bind(effect, plant))
    try:
        check_names(effect, plant)
    except UsageError as problem:
        if effect.plant:
            raise
        raise UsageError(f"{problem}{_meant(effect, plant, others)}") from None
    return [effect]


def _meant(effect: type[Effect], plant: type[Plant], others: Callable[[], Iterable[type[Plant]]]) -> str:
    """Return what to do with an effect in names that this plant does not have: of which plant and place they are."""
    vocabulary = read_vocabulary(plant)
    groups = (effect.terms, effect.rates, effect.updates, effect.starts)
    used = {name for group in groups for term in group.values() for name in term.arguments} | set(effect.terms)
    own = {*effect.parameters, *effect.states}
    here = {*vocabulary.signals, *plant.states, *plant.parameters, *plant.inputs, *own}
    for other in others():
        if other is plant:
            continue
        theirs = read_vocabulary(other)
        if not used - here <= {*theirs.signals, *other.states, *other.parameters, *other.inputs}:
            continue
        said = f' These are names of plant {other.name}: if it is for that plant only, write plant = "{other.name}" in it'
        # the slots first: they say on what it acts
        for name in [*effect.terms, *sorted(used)]:
            for port in theirs.ports.values():
                local = next((own for own, theirs_too in port.names.items() if theirs_too == name), "")
                if local and name not in here:
                    return f"{said}; for every plant, write acts_on = \"{port.kind}\": '{name}' is its '{local}'"
        return said
    return ""
