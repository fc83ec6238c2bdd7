"""Models of the pump joint by name, as candidates."""

from __future__ import annotations

from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence
from hjcamp.plants.pump_joint.diagnosis.models.unknowns import base_unknowns


def saved_model(name: str) -> Candidate:
    """Return the saved model ``name``: its plant parameters and effects, SI; unknown names are refused."""
    from hjcamp.configuration.composer import Composer
    from hjcamp.effects import chosen_effects

    content = Composer().model(name)
    _, effects = chosen_effects(content["effects"])
    return Candidate({key: float(value) for key, value in content["parameters"].items()}, effects)


def complete(candidate: Candidate, evidence: Evidence) -> Candidate:
    """Return the candidate with every base parameter given: the hardware's value where the model has none."""
    values = evidence.tests[0].hardware.values
    names = [one.name for one in base_unknowns()]
    published = {name: values.get(name, PumpJoint.parameters[name].default) for name in names}
    return Candidate({**published, **candidate.base}, candidate.effects)
