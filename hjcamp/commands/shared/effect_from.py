"""``hjcamp effects new NAME --from DIAGNOSIS``: what a diagnosis found missing, as an effect file that runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.errors import UsageError, shown, unknown
from hjcamp.json_text import read_json
from hjcamp.storage import check_is_file, shown_path

if TYPE_CHECKING:
    from hjcamp.effects._begun import Begun
    from hjcamp.effects._formula_template import Formula

ANSWER = "answer.json"
KNOTS = 24
TO_DO = {
    "effect": "it names {names}: hjcamp add {names} RUN --as NAME",
    "one_of": "it leaves {names}: tests that distinguish them are named in it; then hjcamp add",
    "nothing_missing": "no law is missing; hjcamp effects new NAME writes a template without a curve",
    "cannot_tell": "its tests do not suffice; diagnose more or longer tests",
    "outside_library": "no law over one quantity takes what it leaves: it has no curve; hjcamp effects new NAME writes a template",
}


def write_from_diagnosis(name: str, diagnosis: Path, taken: Sequence[str], form: str = "") -> tuple[Path, str, list[str]]:
    """Write ``effects/NAME.py`` from a diagnosis (its answer, its folder, or its run).

    It holds the curve as a table, with ``form`` that formula in its place. Return the path, the plant, and in words what formulas the
    diagnosis proposes. Raises ``UsageError`` for what is no diagnosis, one without an unknown or that formula, and a file that exists.
    """
    from hjcamp.effects._curve_template import write_from_curve
    from hjcamp.effects._formula_template import write_from_formula
    from hjcamp.effects._written import check_begun

    file = answer_file(diagnosis)
    content = read_answer(file)
    begun = begun_from(content, file)
    try:
        check_begun(begun)
    except UsageError as problem:
        raise UsageError(f"{file}: {problem}") from None
    found = formulas_from(content, file)
    if form:
        if form not in found:
            raise no_such_form(form, found, content, file)
        return write_from_formula(name, Path("effects"), begun, found[form], taken), begun.plant, []
    said = [f"{one.form.words}: {one.form.said}   --form {key}" for key, one in found.items()]
    return write_from_curve(name, Path("effects"), begun, taken), begun.plant, said


def formulas_from(content: Mapping[str, Any], file: Path) -> dict[str, Formula]:
    """Return the formulas that an answer proposes, by name; raises ``UsageError`` for one of another shape."""
    from hjcamp.effects._forms import FORMS
    from hjcamp.effects._formula_template import Formula

    rows = content.get("formulas") or {}
    try:
        found = {}
        for row in rows.get("forms", ()):
            form = FORMS[row["form"]]
            given = {name: _value(row["parameters"][name]) for name in form.parameters}
            left = row.get("left_above_repeatability")
            taken = None if left is None else 1.0 - _finite(left)
            found[form.name] = Formula(form, given, _finite(row.get("reference", 1.0)), taken)
    except (LookupError, TypeError, AttributeError, ValueError) as problem:
        raise UsageError(f"{file}: a formula in it is not whole ({type(problem).__name__}: {problem})") from None
    return found


def _value(row: Mapping[str, Any]) -> tuple[float, str, tuple[float, float]]:
    """Return value, unit and interval of a parameter of a formula; raises ValueError for what is none."""
    from hjcamp.effects._written import UNIT
    from hjcamp.model.language.amount import dimension

    unit = str(row["unit"])
    if not UNIT.fullmatch(unit):
        raise ValueError(f"no unit {shown(unit)}")
    dimension(unit)
    low, high = (_finite(end) for end in row["ci95"])
    return _finite(row["value"]), unit, (low, high)


def _finite(value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e300:
        raise ValueError(f"no number {shown(value)}")
    return float(value)


def no_such_form(form: str, found: Mapping[str, Formula], content: Mapping[str, Any], file: Path) -> UsageError:
    """Return the refusal of a formula that a diagnosis does not propose."""
    if found:
        return unknown("formula", form, found, str(file))
    known = content.get("formulas")
    if known is None:
        return UsageError(f"{file}: it was written before formulas were proposed; diagnose again")
    return UsageError(f"{file}: no formula is proposed for its curve; without --form the file holds the curve as a table")


def answer_file(path: Path) -> Path:
    """Return the answer for programs that is meant by a file, the folder of a diagnosis, or a run folder."""
    check_is_file(path)
    if not path.exists():
        raise UsageError(f"--from {shown_path(path)}: this does not exist; give a diagnosis (hjcamp diagnose RUN)")
    places = [path] if path.is_file() else [path / ANSWER, path / "diagnose" / ANSWER]
    found = next((place for place in places if place.is_file()), None)
    if found is None:
        raise UsageError(
            f"--from {shown_path(path)}: no diagnosis is in this folder; hjcamp diagnose writes diagnose/{ANSWER}, or give the "
            "file that --json wrote"
        )
    return found


def read_answer(file: Path) -> Mapping[str, Any]:
    """Return the answer of a diagnosis; refuse what is none."""
    content = read_json(file)
    schema = content.get("schema") if isinstance(content, dict) else None
    if not isinstance(schema, str) or not schema.startswith("hjcamp.diagnosis/"):
        raise UsageError(f"{file}: this is no answer of hjcamp diagnose (its schema is {schema or 'not given'})")
    return dict(content)


def begun_from(content: Mapping[str, Any], file: Path) -> Begun:
    """Return what a file begins with from the answer of a diagnosis; raises ``UsageError`` for one of another shape."""
    try:
        return _begun(content, file)
    except (LookupError, TypeError, AttributeError, ValueError, ArithmeticError) as problem:
        raise UsageError(
            f"{file}: the curve of its non-parametric term is not whole ({type(problem).__name__}: {problem})"
        ) from None


def _begun(content: Mapping[str, Any], file: Path) -> Begun:
    from hjcamp.known_plants import DEFAULT, plant_called

    rows = content.get("unknowns") or []
    known = next((row for row in rows if isinstance(row, dict) and row.get("curve")), None)
    if known is None:
        verdict = str(content.get("verdict"))
        names = " ".join(str(name) for name in content.get("effects") or [])
        advice = TO_DO.get(verdict, "diagnose again").format(names=names)
        raise UsageError(f"{file}: this diagnosis says {verdict.upper()} and holds no curve of a non-parametric term; {advice}")
    if known.get("apart_s"):
        raise UsageError(
            f"{file}: what it found changes with time otherwise in each condition, which no law of an effect can know; "
            "measure what changes, and give it as an Input of the plant's file"
        )
    plant = str(content.get("plant", DEFAULT))
    own = plant_called(plant).room_of("curve")
    return own.begun(known, file) if own else _of_any_plant(plant, known, file)


def _of_any_plant(plant: str, row: Mapping[str, Any], file: Path) -> Begun:
    from hjcamp.diagnosis.candidates.nonparametric_terms import BENT, SHARES, times_of
    from hjcamp.effects._begun import Begun, Table
    from hjcamp.effects._curve_template import even_steps
    from hjcamp.effects._written import plain_origin
    from hjcamp.known_plants import find_plant
    from hjcamp.model.language.vocabulary import read_vocabulary

    found = find_plant(plant)
    vocabulary, curve = read_vocabulary(found), row["curve"]
    port = vocabulary.ports.get(row["port"])
    if port is None and row["port"] not in vocabulary.changeable:
        raise UsageError(f"{file}: plant {plant} has no place '{row['port']}' any more; diagnose again")
    values, first, last = even_steps(row["knots"]["x"], row["knots"]["y"], KNOTS)
    quantity, signal = str(row["quantity"]), str(row["signal"])
    groups = (vocabulary.signals, found.states, found.inputs, found.parameters, ("time",))
    known = {name for group in groups for name in group} | {
        port.names.get("direction", "") for port in vocabulary.ports.values()
    }
    for name in (*signal.split(" - "), *row["slots"]):
        if name not in known:
            raise unknown("name", str(name), known, f"{file} (plant {plant})")
    text = (f"{quantity} at {row['port']}" if port else f"change of {row['port']}, as a share of it").replace("_", " ")
    factor = ""
    if quantity in SHARES:
        # a gain is so many times what is asked; what a law reads of its own slot it must hand on
        slot, times = times_of(port) if port else (row["port"], row["port"])
        factor = f"{slot} + {times} * " if slot == times else f"{times} * "
    expression = signal
    if quantity in BENT:
        [expression] = row["slots"]
        factor = f"{expression} + "
    against = () if port is None or port.kind != "partition" else (port.names["loss_beyond"],)
    table = Table("amplitude", tuple(row["slots"]), values, curve["y_unit"], text, factor, against)
    subsystem = (port.subsystem or port.kind) if port else next(iter(found.subsystems), "parameter")
    return Begun(
        plant, subsystem, signal.replace("_", " "), expression, tuple(expression.split(" - ")), curve["x_unit"], first, last,
        (table,), f"the diagnosis {plain_origin(file)}",
    )  # fmt: skip
