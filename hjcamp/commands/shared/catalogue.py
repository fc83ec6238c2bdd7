"""``hjcamp effects --pages DIR``: one page for each effect and each plant, from their files."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.errors import HjcampError
from hjcamp.storage import check_place, whole_file

if TYPE_CHECKING:
    from hjcamp.model.declare.effect import Effect
    from hjcamp.model.declare.plant import Plant
    from hjcamp.report.pages.catalogue_page import EffectEntry

MARK = "index.html"


def write_pages(folder: Path, tell: Callable[[str], None] = lambda text: None) -> list[Path]:
    """Write the catalogue into a folder and return the paths of its pages, the index last.

    Pages of effects that are no more are left as they are: the folder may hold other files.
    """
    from hjcamp.effects import library_of
    from hjcamp.known_plants import load_plants
    from hjcamp.report.pages.catalogue_page import effect_page, index_page, plant_page

    check_place(folder, "--pages", folder=True)
    plants = load_plants()
    libraries = {name: library_of(plant) for name, plant in plants.items()}
    entries = _entries(plants, {name: library.effects for name, library in libraries.items()}, tell)
    known = [one.name for one in entries]
    pages = {one.name: effect_page(one, known) for one in entries}
    for name, plant in plants.items():
        library = libraries[name]
        linked = {one: effect.sentence() for one, effect in library.effects.items() if one in known}
        others = {
            file: library.names[file] for file in library.names if not set(library.names[file]) <= set(known) and file in known
        }
        linked |= {file: library.effects[called[0]].sentence() for file, called in others.items()}
        pages[f"plant_{name}"] = plant_page(
            name, plant, _values(plant), _places(plant), dict(sorted(linked.items())), library.unfit
        )
    pages["index"] = index_page(entries, plants)
    written = []
    for name, html in pages.items():
        path = folder / f"{name}.html"
        with whole_file(path) as stream:
            stream.write(html.encode())
        written.append(path)
    return written


def _entries(
    plants: Mapping[str, type[Plant]],
    fitting: Mapping[str, Mapping[str, type[Effect]]],
    tell: Callable[[str], None],
) -> list[EffectEntry]:
    """Return every effect: as its file holds it, and by the name that a plant gives it."""
    from hjcamp.effects import effect_files

    found: dict[str, EffectEntry] = {}
    for name, effect in effect_files().items():
        places = {
            plant: bound
            for plant, library in fitting.items()
            for called, bound in library.items()
            if (getattr(bound, "made_of", None) or (bound,))[0] is effect
        }
        tell(name)
        found[name] = _entry(name, effect, plants, places)
    for plant, library in fitting.items():
        for name, effect in library.items():
            instance = (getattr(effect, "made_of", None) or (None,) * 5)[4]
            if name not in found and instance is not None:
                tell(name)
                found[name] = _entry(name, effect, plants, {plant: effect})
    return [found[name] for name in sorted(found)]


def _entry(
    name: str, effect: type[Effect], plants: Mapping[str, type[Plant]], places: Mapping[str, type[Effect]]
) -> EffectEntry:
    from hjcamp.report.pages.catalogue_page import EffectEntry

    for plant, bound in places.items():
        if picture := picture_of(bound, plants[plant]):
            caption = f"On plant {plant}, at its defaults, along the motion of hjcamp effects test"
            return EffectEntry(name, effect, list(places), picture, caption)
    return EffectEntry(name, effect, list(places))


def picture_of(effect: type[Effect], plant: type[Plant]) -> str:
    """Return what the effect changes most along a course on which every effect has its moment, empty where nothing."""
    import numpy as np

    from hjcamp.model.checks.place_checks import PlaceBench
    from hjcamp.model.language.vocabulary import read_vocabulary
    from hjcamp.report.pictures.catalogue import draw_change

    bench = PlaceBench(effect, plant)
    vocabulary = read_vocabulary(plant)
    names = list(vocabulary.signals)
    try:
        without, with_ = bench.absent, bench.along({})
    except HjcampError:
        return ""
    changed = [name for k, name in enumerate(names) if np.any(with_[:, k] != without[:, k])]
    # what acts on a parameter shows in the first line that reads it
    differs = [slot for slot in effect.terms if slot in changed] or changed
    if not differs or not np.all(np.isfinite(with_)):
        return ""
    slot = differs[0]
    course = bench.course
    own = {*effect.parameters, *effect.states, slot}
    read: list[tuple[str, str, Any]] = []
    for argument in effect.terms.get(slot, next(iter(effect.terms.values()))).arguments:
        if argument in own:
            continue
        if argument in names:
            read.append((argument, vocabulary.signals[argument].unit, with_[:, names.index(argument)]))
        elif argument in plant.states:
            read.append((argument, plant.states[argument].unit, np.array([place[argument] for place in course])))
    moving = [one for one in read if np.ptp(one[2]) > 0.0]
    time = np.array([place["time"] for place in course])
    # what takes many values tells more than what switches
    driver, unit, values = max(moving, key=lambda one: len(np.unique(one[2])), default=("time", "s", time))
    k = names.index(slot)
    return draw_change(time, (slot, vocabulary.signals[slot].unit), without[:, k], with_[:, k], (driver, unit), values)


def _values(plant: type[Plant]) -> list[list[str]]:
    from hjcamp.report.pages.catalogue_page import parameter_rows

    return parameter_rows(plant.parameters)


def _places(plant: type[Plant]) -> list[list[str]]:
    from hjcamp.model.language.vocabulary import read_vocabulary

    return [[port.name, port.kind, ", ".join(port.names)] for port in read_vocabulary(plant).ports.values()]
