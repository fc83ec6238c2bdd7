"""Effects and plants in Python."""

from __future__ import annotations

import inspect
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.errors import UsageError, counted
from hjcamp.known_plants import DEFAULT, find_plant, plant_called, plants_and_faults
from hjcamp.notebook.result import Picture, Result, frame_of, quiet

if TYPE_CHECKING:
    import polars as pl

    from hjcamp.model.declare.effect import Effect
    from hjcamp.model.declare.plant import Plant

PARAMETERS = ("parameter", "unit", "default", "low", "high", "prior", "meaning")
EFFECTS = ("effect", "acts_on", "what", "parameters")
PLANTS = ("plant", "what", "measured", "effects")


@dataclass(frozen=True, repr=False)
class Catalogue(Result):
    """What there is. ``frame``: a row for each."""

    heading: str
    table: pl.DataFrame

    @property
    def answer(self) -> dict[str, Any]:  # type: ignore[override]
        """The rows of the frame."""
        return {"rows": self.frame.to_dicts()}

    @property
    def title(self) -> str:
        """How many there are."""
        return self.heading

    @property
    def frame(self) -> pl.DataFrame:
        """One row for each."""
        return self.table


@dataclass(frozen=True, repr=False)
class OneEffect(Result):
    """One effect of the library. ``frame``: its parameters; ``plot`` simulates a test without and with it (the usual plant)."""

    name: str
    effect: type[Effect]
    plant: str

    @property
    def answer(self) -> dict[str, Any]:  # type: ignore[override]
        """The rows of the frame."""
        return {"effect": self.name, "parameters": self.frame.to_dicts()}

    @property
    def title(self) -> str:
        """Its name and what it is."""
        return f"{self.name}: {self.effect.sentence()}"

    def sentences(self) -> list[str]:
        """Return its description: equation, what it is seen as, source."""
        text = inspect.cleandoc(self.effect.__doc__ or "").replace(".. math:: ", "")
        return [line.strip() for line in text.splitlines()[1:] if line.strip()]

    @property
    def frame(self) -> pl.DataFrame:
        """One row for each parameter."""
        rows = [
            {
                "parameter": one.name, "unit": one.unit, "default": one.default, "low": one.bounds[0], "high": one.bounds[1],
                "prior": one.prior, "meaning": one.text,
            }
            for one in self.effect.parameters.values()
        ]  # fmt: skip
        return frame_of(rows, PARAMETERS)

    def plot(self, *overrides: str) -> Picture:
        """Return one test without and with the effect; ``overrides`` choose another test."""
        from hjcamp.commands.models.effects import is_pictured

        own = plant_called(self.plant).room_of("effects")
        if own is None or not is_pictured(self.name, self.plant):
            raise UsageError(f"effect {self.name}: pictures are of tests of {DEFAULT}")
        figure = Picture(layout="constrained")
        own.paint(figure, self.name, list(overrides), quiet())
        return figure


@dataclass(frozen=True, repr=False)
class OnePlant(Result):
    """One plant. ``frame``: states, inputs, parameters and what is measured; ``plot``: its places and what links them."""

    plant: type[Plant]

    @property
    def answer(self) -> dict[str, Any]:  # type: ignore[override]
        """The rows of the frame."""
        return {"plant": self.plant.name, "declared": self.frame.to_dicts()}

    @property
    def title(self) -> str:
        """Its name and what it is."""
        return f"{self.plant.name}: {self.plant.sentence()}"

    def sentences(self) -> list[str]:
        """Return which effects fit."""
        from hjcamp.effects import library_of

        return [f"effects that fit: {', '.join(library_of(self.plant).effects)}"]

    @property
    def frame(self) -> pl.DataFrame:
        """One row for each declared quantity: kind, name, unit, value, meaning."""
        from hjcamp.commands.models.plants import declared_rows

        return frame_of(declared_rows(self.plant), ("kind", "name", "unit", "value", "meaning"))

    def plot(self) -> Picture:
        """Return the block diagram of its places."""
        from hjcamp.report.pictures.plant import paint_plant

        figure = Picture()
        paint_plant(figure, self.plant)
        return figure


def effects(name: str | None = None, plant: str = DEFAULT) -> Catalogue | OneEffect:
    """Return the effects that a plant can have, or one of them; `hjcamp effects`.

    >>> "spring" in hjcamp.effects(plant="stage").frame["effect"].to_list()
    True
    >>> hjcamp.effects("spring", plant="stage").frame["unit"].to_list()
    ['N/m', 'm']
    >>> hjcamp.effects("sprong", plant="stage")
    Traceback (most recent call last):
        ...
    hjcamp.errors.UsageError: unknown effect 'sprong'; did you mean 'spring'? ...
    """
    from hjcamp.effects import library_of

    library = library_of(plant)
    if name is not None:
        return OneEffect(name, library.find(name), plant)
    rows = [
        {
            "effect": key,
            "acts_on": one.subsystem or one.acts_on,
            "what": one.sentence(),
            "parameters": ", ".join(one.parameters),
        }
        for key, one in library.effects.items()
    ]
    return Catalogue(f"{counted(len(rows), 'effect')} that plant {plant} can have", frame_of(rows, EFFECTS))


def plants(name: str | None = None) -> Catalogue | OnePlant:
    """Return the plants that are known, or one of them; `hjcamp plants`.

    >>> "stage" in hjcamp.plants().frame["plant"].to_list()
    True
    >>> figure = hjcamp.plants("stage").plot()
    """
    from hjcamp.effects import library_of
    from hjcamp.model.checks.plant_checks import check_plant

    if name is not None:
        plant = find_plant(name)
        check_plant(plant)
        return OnePlant(plant)
    rows = [
        {
            "plant": key,
            "what": one.sentence(),
            "effects": len(library_of(one).effects),
            "measured": ", ".join([channel.field for channel in one.channels] or list(one.measured)),
        }
        for key, one in plants_and_faults()[0].items()
    ]
    return Catalogue(f"{len(rows)} plants", frame_of(rows, PLANTS))


def new_plant(name: str | type) -> Path:
    """Write the template of a plant, a carriage with friction, into ./plants and return its path; `hjcamp plants new`.

    For a class of a plant, written in a cell of a notebook, its own file; run the cell again to replace it.

    >>> hjcamp.new_plant("my_axis").as_posix()
    'plants/my_axis.py'
    """
    from hjcamp.commands.shared.plant_template import write_template

    if isinstance(name, type):
        from hjcamp.notebook.plant_class import write_class

        return write_class(name, Path("plants"))
    return write_template(name, Path("plants"), plants_and_faults()[0])


def new_effect(name: str, plant: str = "", on: str = "") -> Path:
    """Write the template of an effect into ./effects and return its path; ``on`` a kind of place; `hjcamp effects new`.

    >>> hjcamp.new_effect("cable", on="body").as_posix()
    'effects/cable.py'
    """
    from hjcamp.commands.models.effects import new_effect_file

    return new_effect_file(name, plant, on)
