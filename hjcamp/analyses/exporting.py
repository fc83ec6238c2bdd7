"""What leaves as a file for other programs: a plant as it is declared, a saved model of it, or the model that a run has."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hjcamp.campaign.files.provenance import git_label, utc_now
from hjcamp.configuration.saved_model import FOLDER, log_hashes
from hjcamp.diagnosis.results.model_file import DECLARED, load_model
from hjcamp.effects import library_of
from hjcamp.errors import UsageError, unknown
from hjcamp.json_text import read_json
from hjcamp.known_plants import DEFAULT, find_plant, load_plants, plant_of
from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.base_values import DELAY
from hjcamp.model.declare.plant import Plant
from hjcamp.model.export.python_file import Exported
from hjcamp.records.plan import read_plan
from hjcamp.storage import named_file
from hjcamp.yaml_file import read_yaml

ANSWERS = (Path("answer.json"), Path("diagnose") / "answer.json")


def model_to_export(name: str, model: str = "", run: Path | None = None, condition: str = "") -> Exported:
    """Return what ``hjcamp model export`` writes: ``name`` is a plant, or one of the saved models.

    ``model`` is a saved model of that plant, ``run`` a run folder, or a diagnosis, whose values are taken. Raises ``UsageError``
    for what is not there, and for what one plant with effects cannot express.
    """
    if model and run is not None:
        raise UsageError("give either --model or --run: each says which values the model has")
    saved = _saved(name)
    if not saved and run is None and not model:
        return _of_plant(find_plant(name), {}, {}, {"model": DECLARED})
    if saved and not model and run is None:
        if name in load_plants():
            raise UsageError(
                f"'{name}' is a plant and a saved model; for the model say --model {name}, for the plant --model {DECLARED}"
            )
        content = read_yaml(saved)
        plant = find_plant(str(content.get("plant", DEFAULT)) if isinstance(content, Mapping) else "", str(saved))
        return _of_saved(plant, name)
    plant = find_plant(name)
    if run is None:
        return _of_saved(plant, model)
    found = _of_run(run, condition) if (run / "plan.json").is_file() else _of_diagnosis(run)
    if found.composition.plant.name != plant.name:
        raise UsageError(f"--run {run}: it is of plant {found.composition.plant.name}, not of {plant.name}")
    return found


def _saved(name: str) -> Path | None:
    path = FOLDER / f"{name}.yaml"
    return path if name != DECLARED and name.isidentifier() and path.is_file() else None


def _of_plant(plant: type[Plant], base: Mapping[str, float], effects: Mapping[str, Any], source: Mapping[str, Any]) -> Exported:
    """Return a plant with values and effects by name, SI; a ``base`` value whose name begins with ``delay.`` is an input's."""
    library = library_of(plant, imposed=True).effects
    for name in effects:
        if name not in library:
            raise unknown("effect", name, library, f"plant {plant.name}")
    values = {name: value for name, value in base.items() if not name.startswith(DELAY)}
    values |= {f"{effect}.{name}": value for effect, own in effects.items() for name, value in own.items()}
    delays = {name.removeprefix(DELAY): value for name, value in base.items() if name.startswith(DELAY) and value}
    made = Composition(plant, tuple(library[name] for name in effects))
    return Exported(made, values, delays, {"program": f"hjcamp {git_label()}", "made_at": utc_now(), **source})


def _of_saved(plant: type[Plant], name: str) -> Exported:
    if name == DECLARED:
        return _of_plant(plant, {}, {}, {"model": DECLARED})
    found = load_model(name, plant, library_of(plant).effects)
    [path] = named_file(name, "model", FOLDER)
    content = read_yaml(path)
    if content.get("factors"):
        factors = ", ".join(content["factors"])
        raise UsageError(
            f"{path}: it was fitted to printed tables and holds factors of the loop ({factors}), which are no part of a plant; "
            "a model that was fitted to logs can be exported"
        )
    plant = plant.sampled(float(content.get("period_s") or plant.period))
    return _of_plant(plant, found.base, found.effects, {"model": name, **_provenance(content)})


def _provenance(content: Mapping[str, Any]) -> dict[str, Any]:
    given = content.get("provenance")
    return {"of_the_model": dict(given)} if isinstance(given, Mapping) else {}


def _of_run(run: Path, condition: str) -> Exported:
    """Return the model that the tests of a run were made with; conditions that differ in it are asked for by name."""
    from hjcamp.backends.plant_simulation import model_of

    plan = read_plan(run / "plan.json")
    names = [one.name for one in plan.conditions]
    if condition and condition not in names:
        raise unknown("condition", condition, names, str(run))
    made: dict[str, Exported] = {}
    for one in plan.conditions:
        if condition in ("", one.name):
            plant = plant_of(one.config)
            effects, values = model_of(one.config, plant)
            base = {
                **plant.configured(one.config),
                **{name: value for name, value in values.items() if "." not in name or name.startswith(DELAY)},
            }
            own = {
                effect.name: {k.partition(".")[2]: v for k, v in values.items() if k.startswith(f"{effect.name}.")}
                for effect in effects
            }
            source = {"run": str(run), "campaign": plan.campaign, "condition": one.name, "plan_sha256": plan.sha256}
            made[one.name] = _of_plant(plant, base, own, source)
    first, *others = made.values()
    if any(one.parameters != first.parameters or one.delays != first.delays for one in others):
        raise UsageError(
            f"--run {run}: its conditions have different models; say which: --condition {names[0]} (or {', '.join(names[1:4])})"
        )
    return first


def _of_diagnosis(place: Path) -> Exported:
    """Return the model that a diagnosis ended with: the calibrated parameters, and the effects that it names."""
    file = place if place.is_file() else next((place / one for one in ANSWERS if (place / one).is_file()), None)
    if file is None:
        raise UsageError(
            f"--run {place}: neither a run (plan.json) nor a diagnosis (answer.json) is there; hjcamp diagnose writes one"
        )
    content = read_json(file)
    if not isinstance(content, dict) or not str(content.get("schema")).startswith("hjcamp.diagnosis/2"):
        raise UsageError(f"{file}: this is no answer of hjcamp diagnose for any plant")
    plant = find_plant(str(content["plant"]), str(file))
    named = [str(name) for name in content.get("effects") or ()]
    rows = {one["effect"]: one for one in content.get("candidates") or ()}
    effects = {
        name: {key: float(one["value"]) for key, one in rows[name]["parameters"].items()} for name in named if name in rows
    }
    base = {}
    for key, row in (content.get("calibration_with_effects") or content["calibration"]).items():
        effect, _, name = key.rpartition(" ")
        if effect:
            effects.setdefault(effect, {})[name] = float(row["value"])
        else:
            base[key] = float(row["value"])
    source = {
        "diagnosis": str(file),
        "verdict": str(content.get("verdict")),
        "answer_sha256": log_hashes([file])[file.as_posix()],
    }
    if content.get("verdict") == "outside_library":
        source["lacks"] = (
            "the law that the diagnosis found over its driver: hjcamp effects new NAME --from it makes an effect of it"
        )
    return _of_plant(plant, base, effects, source)
