"""Whether a controller fits a plant: where each quantity it reads comes from, and which inputs its answers command."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from hjcamp.controllers.controller import Controller
from hjcamp.errors import UsageError, unknown
from hjcamp.model.declare.law import Law
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.field_unit import field_of, unit_of_field

REFERENCE = ("reference", "velocity", "acceleration")
CLOCK = {"period": "h", "index": "index", "time": "time"}
# Laws for a plant with one input return their feedback and their feedforward; the input is the sum.
PARTS = ("pid", "feedforward")


def measured_fields(plant: type[Plant]) -> list[str]:
    """Return the fields of what is measured, in the order of the plant's readings."""
    return [channel.field for channel in plant.channels] or list(plant.measured)


def quantity(field: str) -> str:
    """Return the name of a field without its unit: ``position`` for ``position_mm``."""
    return field[: -len(unit_of_field(field, field).suffix) - 1]


def input_field(plant: type[Plant], name: str) -> str:
    """Return what the logs call an input."""
    given = plant.inputs[name]
    return given.field or field_of(name, given.unit, f"plant {plant.name}")


def controlled_field(plant: type[Plant]) -> str:
    """Return the measured field that a reference is for: the plant's ``controlled``, else the first one."""
    fields = measured_fields(plant)
    if plant.controlled and plant.controlled not in fields:
        raise unknown("measured field", plant.controlled, fields, f"plant {plant.name}, controlled")
    return plant.controlled or fields[0]


def sources(law: type[Law], plant: type[Plant], planned: tuple[str, ...] = ()) -> list[str]:
    """Return for each of the law's samples the expression in the loop that gives it.

    ``row`` is the reference's row at this sample (value, velocity, acceleration, planned columns), ``seen`` the readings.
    A sample is ``reference``, ``velocity``, ``acceleration``, ``measured`` (of what is controlled), a measured quantity by the
    name of its field without unit, one of ``planned``, ``period``, ``index`` or ``time``. Raises ``UsageError`` for others.
    """
    fields = measured_fields(plant)
    known = {name: f"row[{place}]" for place, name in enumerate((*REFERENCE, *planned))} | CLOCK
    known |= {quantity(field): f"seen[{place}]" for place, field in enumerate(fields)}
    known["measured"] = f"seen[{fields.index(controlled_field(plant))}]"
    if tuple(law.results) == PARTS:
        known.setdefault("feedforward", "0.0")
    for name in law.samples:
        if name not in known:
            raise UsageError(
                f"controller {law.name} does not fit plant {plant.name}: it reads '{name}', which is not measured there. "
                f"Allowed: {', '.join(sorted(known))}"
            )
    return [known[name] for name in law.samples]


def commanded(law: type[Controller], plant: type[Plant], chosen: str = "") -> dict[str, tuple[str, ...]]:
    """Return the inputs that a controller commands, each with the answers whose sum it is.

    An answer is called like its input; ``pid`` and ``feedforward`` together, and one answer that no input is called like,
    command the ``chosen`` input or the plant's only one. Where the plant has an ``actuation``, its answers command. Raises
    ``UsageError``.
    """
    inputs = list(plant.given_inputs())
    where = f"controller {law.name} does not fit plant {plant.name}"
    if plant.actuation is not None and law.results != ("given",):
        for name in plant.actuation.samples:
            if name not in law.results and name not in CLOCK:
                raise UsageError(f"{where}: it does not give '{name}', which moves the plant's actuators")
        return {name: (name,) for name in plant.actuation.results}
    if not inputs and not chosen:
        if law.results == ("given",):
            return {}  # it moves by itself: the trajectory says how long
        raise UsageError(f"{where}: the plant has no input")
    alone = len(law.results) == 1 and (bool(chosen) or law.results[0] not in inputs)
    if law.results == PARTS or alone:
        if chosen and chosen not in inputs:
            raise unknown("input", chosen, inputs, f"controller {law.name}, plant {plant.name}")
        if not chosen and len(inputs) != 1:
            raise UsageError(
                f"{where}: it commands one input, the plant has {len(inputs)} ({', '.join(inputs)}); "
                "say which with controller.input=NAME"
            )
        return {chosen or inputs[0]: tuple(law.results)}
    for name in law.results:
        if name not in inputs:
            raise UsageError(f"{where}: it commands '{name}', which is no input there. Allowed: {', '.join(inputs)}")
    return {name: (name,) for name in law.results}


def check_fits(law: type[Controller], plant: type[Plant], chosen: str = "") -> None:
    """Raise ``UsageError`` with the reason for a controller that does not fit the plant."""
    sources(law, plant, law.planned)
    commanded(law, plant, chosen)


def fitting(laws: Mapping[str, type[Controller]], plant: type[Plant]) -> Iterable[str]:
    """Return the names of the controllers that fit a plant."""
    for name, law in laws.items():
        try:
            check_fits(law, plant, next(iter(plant.given_inputs()), ""))
        except UsageError:
            continue
        yield name
