"""What a calibration says of its uncertainty beyond intervals: profiles of the likelihood, and draws from the posterior."""

from __future__ import annotations

import io
import math
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp import __version__
from hjcamp.analyses.data import Report, silent
from hjcamp.errors import UsageError
from hjcamp.storage import whole_file

if TYPE_CHECKING:
    from hjcamp.diagnosis.calibration.analysis import Analysis
    from hjcamp.diagnosis.estimation.posterior import Posterior
    from hjcamp.diagnosis.estimation.profile import Profile


def check_posterior(path: Path) -> None:
    """Raise ``UsageError`` where no draws can be written: their extra is not installed, or the file's name says another kind."""
    if find_spec("h5netcdf") is None:
        raise UsageError("--posterior needs the extra 'posterior', which is not installed: pip install 'hjcamp[posterior]'")
    if path.suffix != ".nc":
        raise UsageError(f"--posterior {path}: the draws are netCDF; give a name that ends in .nc")


def profiles_of(analysis: Analysis, report: Report = silent) -> list[Profile]:
    """Return the profile of each base parameter that the tests were to identify, and of the effects that the model began with."""
    from hjcamp.diagnosis.estimation.profile import profiles

    had = analysis.start.effects
    fitted = analysis.base.fitted
    names = {
        (one.effect, one.name)
        for one in fitted.free
        if one.effect in had or (not one.effect and one.name in analysis.measured.plant.base_parameters)
    }
    found = []
    for one in profiles(analysis.windows, fitted, analysis.search.blocks, names):
        found.append(one)
        report(f"profile of {one.name}", len(found) / len(names))
    return found


def profile_row(one: Profile, unit: str) -> dict[str, Any]:
    """Return a profile for programs: values, rise of twice the adjusted log-likelihood ratio, ends (null: not bounded)."""
    rise = [value if math.isfinite(value) else None for value in one.rise.tolist()]
    return {
        "parameter": one.name,
        "unit": unit,
        "value": one.value,
        "values": one.values.tolist(),
        "rise": rise,
        "ci95": [one.low, one.high],
        "flat": one.flat,
        "words": one.words,
    }


def unit_of(analysis: Analysis, one: Profile) -> str:
    """Return the SI unit of a parameter."""
    if one.free.effect:
        return analysis.search.library[one.free.effect].parameters[one.free.name].unit
    return analysis.measured.plant.parameters[one.free.name].unit


def write_posterior(analysis: Analysis, path: Path, report: Report = silent, seed: int = 1) -> Posterior:
    """Write draws as netCDF that ``arviz.from_netcdf`` reads: groups posterior and sample_stats over chain and draw; return them."""
    import h5netcdf

    from hjcamp.diagnosis.estimation.posterior import posterior

    check_posterior(path)
    found = posterior(analysis.windows, analysis.base.fitted, analysis.search.blocks, report, seed)
    content = io.BytesIO()
    chains, draws, _ = found.values.shape
    with h5netcdf.File(content, "w") as file:
        for name, columns in (
            ("posterior", {one: found.values[:, :, k] for k, one in enumerate(found.names)}),
            ("sample_stats", {"lp": found.density}),
        ):
            group = file.create_group(name)
            group.dimensions = {"chain": chains, "draw": draws}
            for dimension, size in group.dimensions.items():
                group.create_variable(dimension, (dimension,), data=range(size.size))
            for column, values in columns.items():
                group.create_variable(column, ("chain", "draw"), data=values)
            group.attrs["inference_library"], group.attrs["inference_library_version"] = "hjcamp", __version__
    with whole_file(path) as stream:
        stream.write(content.getvalue())
    return found
