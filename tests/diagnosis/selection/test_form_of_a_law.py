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
from hjcamp.diagnosis.selection.fits import Fits
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
