"""A further name that takes no more than another form of a law that is there is no second thing that is missing."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hjcamp.diagnosis.candidates.equivalence import equivalent_laws, replaces
from hjcamp.diagnosis.candidates.nonparametric_laws import ENDS, KNOT, CommandOverDemand
from hjcamp.diagnosis.candidates.nonparametric_terms import Unknown, unknowns_of
from hjcamp.diagnosis.data.repeatability import _near_replicates_uninformative
from hjcamp.diagnosis.decision import free_laws
from hjcamp.diagnosis.decision.free_laws import forms_of, further_law
from hjcamp.diagnosis.selection.fits import Fits
from hjcamp.diagnosis.selection.forward import Search
from hjcamp.effects import load_effects
from hjcamp.known_plants import find_plant
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Term
from hjcamp.model.language.vocabulary import read_vocabulary


@pytest.fixture
def known(tanks: Path) -> tuple[dict, dict[str, Unknown]]:  # type: ignore[type-arg]
    plant = find_plant("tanks")
    ranges = dict.fromkeys((*plant.states, *read_vocabulary(plant).signals), (0.5, 8.0))
    return load_effects(plant=plant), unknowns_of(plant, ranges)


def test_which_free_laws_are_other_forms_of_a_name(known) -> None:  # type: ignore[no-untyped-def]
    library, unknowns = known
    exponent = library["flow_exponent_at_outflow"]
    assert {name for name, one in unknowns.items() if equivalent_laws(one, exponent)} == {
        "unknown_flow_over_head_at_outflow",
        "unknown_loss_over_level_at_lower",
    }
    # of the level, too, but of what the gauge makes of it
    assert not equivalent_laws(unknowns["unknown_reading_over_true"], exponent)
    assert equivalent_laws(unknowns["unknown_reading_over_true"], library["sensor_gain"])
    # a constant is no form of what depends on something
    assert not equivalent_laws(unknowns["unknown_reading_over_true"], library["sensor_offset"])


def test_dry_friction_is_a_form_of_any_law_of_that_friction(axis: Path) -> None:
    axle = axis / "plants" / "axis.py"
    axle.write_text(axle.read_text().replace("            push=force + load,\n            coulomb=parameter.coulomb,\n", ""))
    plant = find_plant("axis")
    library = load_effects(plant=plant)
    ranges = dict.fromkeys((*plant.states, *read_vocabulary(plant).signals, "time"), (-0.5, 8.0))
    free = unknowns_of(plant, ranges)
    similar = {name for name, one in free.items() if equivalent_laws(one, library["dry_friction"])}
    assert similar == {name for name, one in free.items() if one.quantity == "friction"} and len(similar) >= 2
    assert not any(equivalent_laws(one, library["constant_force"]) for one in free.values())


@pytest.mark.parametrize(
    ("second", "free", "left", "mends"),
    [
        ("sensor_offset", "unknown_loss_over_level_at_lower", 1.51, True),
        # it takes less than the further name
        ("sensor_offset", "unknown_loss_over_level_at_lower", 1.535, False),
        # so that no test tells, and that name is another form of it as well
        ("overflow_at_lower", "unknown_loss_over_level_at_lower", 1.535, True),
        ("overflow_at_lower", "unknown_loss_over_level_at_lower", 1.56, False),
        # over the same level, but another thing
        ("sensor_offset", "unknown_reading_over_true", 1.51, False),
    ],
)
def test_a_further_name_is_none_where_the_law_of_the_first_is_off(  # type: ignore[no-untyped-def]
    known, second: str, free: str, left: float, mends: bool
) -> None:
    library, unknowns = known
    first = Candidate({}).with_effect("flow_exponent_at_outflow", {"exponent": 0.2})

    def scored(candidate: Candidate, error: float) -> SimpleNamespace:
        return SimpleNamespace(fitted=SimpleNamespace(candidate=candidate), left_out=error, names=tuple(candidate.effects))

    model, further = scored(first, 1.67), scored(first.with_effect(second, {}), 1.53)
    step = SimpleNamespace(unknown=(scored(first.with_effect(free, {}), left),), claims=0.05)
    search = Search.__new__(Search)
    search.library, search.unknowns, search.windows = library, unknowns, SimpleNamespace(forms=frozenset())  # type: ignore[assignment]
    search.matters = lambda model, before, level=0.05: True  # type: ignore[method-assign]
    search.beats = lambda model, other, level=0.05: model.left_out < other.left_out - 0.01  # type: ignore[method-assign]
    search.promised_beside = lambda model, among: []  # type: ignore[method-assign]
    assert search.mends(further, model, step) == mends  # type: ignore[arg-type]


def test_the_form_of_a_law_is_fitted_where_the_step_did_not(known) -> None:  # type: ignore[no-untyped-def]
    library, unknowns = known
    asked: list[set[str]] = []

    def scored(error: float, *names: str) -> SimpleNamespace:
        candidate = Candidate({})
        for name in names:
            candidate = candidate.with_effect(name, {})
        return SimpleNamespace(fitted=SimpleNamespace(candidate=candidate), left_out=error, names=names)

    def promised(model: object, among: set[str]) -> list[SimpleNamespace]:
        asked.append(set(among))
        return [SimpleNamespace(effect="unknown_command_over_demand")]

    search = Search.__new__(Search)
    search.library, search.unknowns, search.windows = library, unknowns, SimpleNamespace(forms=frozenset())  # type: ignore[assignment]
    search.matters = lambda model, before, level=0.05: level == 0.05  # type: ignore[method-assign]
    search.beats = lambda model, other, level=0.05: model.left_out < other.left_out  # type: ignore[method-assign]
    search.promised_beside = promised  # type: ignore[method-assign,assignment]
    search.begun_unknown = lambda before, promise: SimpleNamespace(candidate=None)  # type: ignore[method-assign,assignment,return-value]
    search.fitted = lambda start, near=None: scored(2.4, "dead_band", "unknown_command_over_demand")  # type: ignore[method-assign,assignment,return-value]
    step = SimpleNamespace(unknown=(), claims=0.05)
    assert search.mends(scored(2.5, "dead_band", "saturation"), scored(4.2, "dead_band"), step)  # type: ignore[arg-type]
    assert asked == [{"unknown_command_over_demand"}]
    assert not search.mends(scored(2.3, "dead_band", "saturation"), scored(4.2, "dead_band"), step)  # type: ignore[arg-type]
    # what has a memory is no law that another one mends
    assert not search.mends(scored(2.5, "command_delay", "dead_band"), scored(4.2, "command_delay"), step)  # type: ignore[arg-type]
    assert len(asked) == 2


def test_a_free_law_of_a_drive_bends_what_arrives_behind_a_lag(known) -> None:  # type: ignore[no-untyped-def]
    library, unknowns = known
    law = unknowns["unknown_command_over_demand"]
    assert equivalent_laws(law, library["dead_band"]) and equivalent_laws(law, library["saturation"])
    # a gain that depends on a state is none of them
    assert not any(equivalent_laws(one, library["dead_band"]) for name, one in unknowns.items() if one.quantity == "gain")
    knots = {name: 0.1 * k for k, name in enumerate(law.amplitudes)}
    [(slot, term)] = law.effect.terms.items()
    width = 1.0 / (len(knots) - 1)
    for arrived, share in ((0.0, 0.0), (2.5 * width, 0.25), (1.0, 0.5)):
        given = {**dict(zip(ENDS, (0.0, 1.0), strict=True)), **knots, slot: arrived}
        assert set(term.arguments) == set(given)
        assert CommandOverDemand.command(arrived, 0.0, 1.0, *knots.values()) == pytest.approx(arrived + share)  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("law", "names", "left", "simpler"),
    [
        ("unknown_gain_of_inflow_over_time", ("sensor_drift", "flow_exponent_at_outflow"), 1.4, True),
        # it leaves more than both names do
        ("unknown_gain_of_inflow_over_time", ("sensor_drift", "flow_exponent_at_outflow"), 1.6, False),
        # one name is as simple as one law
        ("unknown_gain_of_inflow_over_time", ("sensor_drift",), 1.4, False),
        # another form of what one of them says is that same thing
        ("unknown_flow_over_head_at_outflow", ("sensor_drift", "flow_exponent_at_outflow"), 1.4, False),
    ],
)
def test_one_free_law_is_simpler_than_several_names(
    known, law: str, names: tuple[str, ...], left: float, simpler: bool
) -> None:  # type: ignore[no-untyped-def]
    library, unknowns = known
    gain = {name: one for name, one in unknowns.items() if one.quantity == "gain"}
    assert {one.driver for one in gain.values()} == {"upper", "lower"} and all(one.place for one in gain.values())
    unknowns = unknowns | {"unknown_gain_of_inflow_over_time": gain["unknown_gain_of_inflow_over_upper"]}

    def scored(error: float, free: int, *names: str) -> SimpleNamespace:
        return SimpleNamespace(left_out=error, names=names, fitted=SimpleNamespace(free=range(free)))

    search = SimpleNamespace(beats=lambda one, other: False, unknowns=unknowns, library=library)
    analysis, model = SimpleNamespace(search=search), scored(1.5, 8, *names)
    assert free_laws.simpler(analysis, scored(left, 12, law), model, names) == simpler  # type: ignore[arg-type]
    # with no more parameters it always is
    assert free_laws.simpler(analysis, scored(left, 8, law), model, names)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("names", "left", "forms"),
    [
        (("second_store_at_upper", "leakage_at_upper"), 1.4, ("leakage_at_upper",)),
        # together they leave less: it may take both
        (("second_store_at_upper", "leakage_at_upper"), 1.6, ()),
        (("leakage_at_upper", "overflow_at_upper"), 1.4, ()),
        (("second_store_at_upper",), 1.4, ()),
    ],
)
def test_a_free_law_alone_leaves_no_second_thing_to_name(
    known, names: tuple[str, ...], left: float, forms: tuple[str, ...]
) -> None:  # type: ignore[no-untyped-def]
    library, unknowns = known
    analysis = SimpleNamespace(search=SimpleNamespace(unknowns=unknowns, library=library))
    free = SimpleNamespace(left_out=left, names=("unknown_loss_over_level_at_upper",))
    assert forms_of(analysis, free, SimpleNamespace(left_out=1.5), names) == forms  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("later", "beside", "beaten", "held"),
    [
        # a free law that is no form of what was found later predicts better: alone, or beside what stands beside the names
        ("sensor_offset", False, "model", True),
        ("sensor_offset", True, "unknown", True),
        ("sensor_offset", False, "", False),
        ("sensor_offset", True, "model", False),
        # that law is another form of this one
        ("flow_exponent_at_outflow", False, "model", False),
    ],
)
def test_what_was_found_later_is_held_against_the_free_laws_found_with_it(  # type: ignore[no-untyped-def]
    known, later: str, beside: bool, beaten: str, held: bool
) -> None:
    library, unknowns = known
    law, other = "unknown_flow_over_head_at_outflow", "unknown_loss_over_level_at_upper"

    def scored(*names: str) -> Any:
        candidate = Candidate({}, {name: {} for name in names})
        return SimpleNamespace(
            names=names,
            fitted=SimpleNamespace(candidate=candidate),
            beyond=lambda one: tuple(n for n in names if n not in one.names),
        )

    base, first = scored(), scored("second_store_at_upper")
    free, model = scored("second_store_at_upper", law), scored("second_store_at_upper", later)
    unknown = scored("second_store_at_upper", later, other) if beside else None
    worse = {"model": model, "unknown": unknown}.get(beaten)
    steps = [SimpleNamespace(before=one, unknown=(free,), level_of_unknown=0.05) for one in (base, first, model)]
    fitted: list[Candidate] = []
    search = SimpleNamespace(
        steps=steps,
        unknowns=unknowns,
        library=library,
        matters=lambda one, before, level: True,
        beats=lambda one, other: one is not model and other is worse,
        fitted=lambda candidate: fitted.append(candidate) or scored(*candidate.effects),
    )
    analysis: Any = SimpleNamespace(search=search, base=base)
    assert further_law(analysis, model, unknown) == ((first, free) if held else None)
    assert [set(one.effects) for one in fitted] == ([{"second_store_at_upper", other, law}] if beside else [])


def test_alike_moments_that_differ_as_much_as_any_tell_no_floor() -> None:
    chance = np.random.default_rng(11)
    features = chance.standard_normal((400, 6))
    whole = features.T @ features / 400
    # at the size of the noise they are the noise; far above it nobody can tell scatter from a finer structure
    assert not _near_replicates_uninformative(0.9 * whole, features)
    assert _near_replicates_uninformative(0.9 * 1e4 * whole, 100.0 * features)
    assert not _near_replicates_uninformative(0.1 * 1e4 * whole, 100.0 * features)


def test_bristles_leave_nothing_of_how_a_rigid_contact_creeps(axis: Path) -> None:
    library = load_effects(plant=find_plant("axis"))
    assert replaces(library["presliding"], library["contact_creep"])
    others = set(library) - {"presliding", "contact_creep"}
    assert not any(replaces(library[one], library["contact_creep"]) for one in others)
    # creep changes what it is given, and a drag is added to it
    assert not replaces(library["contact_creep"], library["presliding"])
    assert not replaces(library["quadratic_drag"], library["presliding"])
    limited = SimpleNamespace(terms={"axle": Term(lambda axle, speed: max(axle, 5.0))})
    arriving: Any = SimpleNamespace(terms={"axle": Term(lambda axle: 2.0 * axle)})
    assert not replaces(limited, arriving)  # type: ignore[arg-type]
    both = Candidate({}, {name: library[name].defaults() for name in ("contact_creep", "presliding")})
    other = Candidate({}, {name: library[name].defaults() for name in ("contact_creep", "quadratic_drag")})
    fits: Any = SimpleNamespace(library=library, windows=SimpleNamespace(forms={"contact_creep"}))
    assert Fits.replaced(fits, both) == {"contact_creep"} and not Fits.replaced(fits, other)
    fits.windows.forms = set()
    assert not Fits.replaced(fits, both)


def test_what_leaks_between_stores_may_follow_any_law_of_their_difference(two_pumps_unknowns: Any) -> None:
    plant, unknowns = two_pumps_unknowns
    library = load_effects([], plant)
    [leak] = [one for one in unknowns.values() if one.driver == "difference"]
    one, beyond = leak.signal.split(" - ")
    assert {one, beyond} <= {*plant.states, *read_vocabulary(plant).signals}
    assert (leak.low, leak.high) == (pytest.approx(-2.0e5, rel=0.01), pytest.approx(2.0e5, rel=0.01))
    assert equivalent_laws(leak, library["internal_leakage"]) and not equivalent_laws(leak, library["leakage"])
    taken, given = leak.effect.terms.values()
    values = {**dict(zip(ENDS, (-2.0, 2.0), strict=True)), **{f"{KNOT}{k}": float(k) for k in range(6)}}
    for level, expected in ((2.0, 5.0), (-2.0, 0.0), (9.0, 5.0), (0.4, 3.0)):
        both = {one: level + 7.0, beyond: 7.0}
        found = [
            term.function(
                *({**both, **values}[dict(term.names).get(name, name) if term.names else name] for name in term.arguments)
            )
            for term in (taken, given)
        ]
        assert found == [pytest.approx(expected), pytest.approx(-expected)]


@pytest.fixture
def two_pumps_unknowns() -> Any:
    plant = find_plant("two_pumps")
    port = next(one for one in read_vocabulary(plant).ports.values() if one.kind == "partition")
    rising = np.linspace(-1.0, 1.0, 101)
    courses = {port.names["level"]: 3.0e5 + 1.0e5 * rising, port.names["level_beyond"]: 3.0e5 - 1.0e5 * rising}
    ranges = {name: (float(one.min()), float(one.max())) for name, one in courses.items()}
    return plant, unknowns_of(plant, ranges, {name: np.concatenate([one[:1], one, one[-1:]]) for name, one in courses.items()})
