"""Add effects to a model of a plant: fit them together with its base, and judge both on blocks that were left out."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from hjcamp.configuration.saved_model import log_hashes
from hjcamp.diagnosis.calibration.analysis import Analysis, calibrated
from hjcamp.diagnosis.calibration.contact_compliance import forms_among
from hjcamp.diagnosis.calibration.shares import held_out
from hjcamp.diagnosis.data.repeatability import not_above
from hjcamp.diagnosis.data.tests import Measured
from hjcamp.diagnosis.estimation.intervals import intervals
from hjcamp.diagnosis.levels import DELTA
from hjcamp.diagnosis.results.answer import removed
from hjcamp.diagnosis.results.calibration_rows import calibration
from hjcamp.diagnosis.results.channel_rows import channel_rows, end_rows, noise_floor_size, whole_rows
from hjcamp.diagnosis.screening.screening import Projection
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect


@dataclass(frozen=True)
class Addition:
    """A model with effects added, in addition to the one without."""

    analysis: Analysis
    model: Scored
    names: tuple[str, ...]

    @property
    def helps(self) -> bool:
        """Whether the error above repeatability falls by a share that matters, block by block."""
        return self.analysis.search.beats(self.model, self.analysis.base) and self.gain >= DELTA

    @property
    def gain(self) -> float:
        """The share of the error above repeatability that the effects explain, in the channel where it is largest."""
        base = self.analysis.base.features
        return self.analysis.channels.share(self.model.features, base, base)

    @property
    def models(self) -> dict[str, Scored]:
        """The model without the effects, and with them."""
        return {"before": self.analysis.base, "after": self.model}


def added(
    measured: Measured,
    library: Mapping[str, type[Effect]],
    start: Candidate,
    names: Sequence[str],
    report: Callable[[str, float], None] = lambda text, share: None,
) -> Addition:
    """Return the fit of ``start`` with the effects ``names``, one after the other from where each promises most.

    It begins with the base of a diagnosis, which has the form of its contacts, unless such a form is itself added.
    """
    chosen = {name: effect for name, effect in library.items() if name in {*names, *start.effects}}
    forms = forms_among(library)
    analysis = calibrated(measured, chosen, start, report, unknowns=False, forms={} if set(names) & set(forms) else forms)
    search, model = analysis.search, analysis.base
    for done, name in enumerate(names):
        report(f"fitting {name}", 0.3 + 0.6 * done / len(names))
        projection = Projection(model.fitted)
        promises = [projection.promise(probe, library[name]) for probe in search.probes(model.fitted, name)]
        begun = search.begun(projection, name, promises)
        model = search.resettled(search.fitted(begun.candidate, begun))
    noise_floor = not_above(analysis.noise_floor, model.fitted.features)
    return Addition(replace(analysis, noise_floor=noise_floor), model, tuple(names))


def answer(found: Addition, name: str, path: str) -> dict[str, Any]:
    """Return what was added for programs."""
    least = noise_floor_size(found.analysis)
    rows: dict[str, dict[str, Any]] = {}
    for one in intervals(found.model.fitted, found.analysis.search.blocks):
        if one.effect:
            unit = found.analysis.search.library[one.effect].parameters[one.name].unit
            rows.setdefault(one.effect, {})[one.name] = {"value": one.value, "unit": unit, **one.row, "at_bound": one.at_bound}
    return {
        "schema": "hjcamp.addition/1",
        "plant": found.analysis.measured.plant.name,
        "model": name,
        "file": path,
        "effects": list(found.names),
        "helps": found.helps,
        "error": {key: held_out(found.analysis, one) / least for key, one in found.models.items()} | {"floor": 1.0},
        "removed": removed(found.analysis, found.model),
        "channels": channel_rows(found.analysis, found.model),
        **whole_rows(found.analysis, found.model),
        "parameters": rows,
        "calibration": calibration(found.analysis),
        "ends": end_rows(found.analysis.windows.layout),
    }


def provenance(found: Addition, command: str) -> dict[str, Any]:
    """Return where a model comes from."""
    least = noise_floor_size(found.analysis)
    return {
        "command": command,
        **{f"error_{key}": held_out(found.analysis, one) / least for key, one in found.models.items()},
        "logs_sha256": log_hashes(test.log.path for test in found.analysis.measured.tests),
    }
