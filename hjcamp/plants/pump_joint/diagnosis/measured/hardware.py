"""The hardware that a test log names, as parameters of the published model."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.compile.compose import Composition
from hjcamp.model.run.simulator import Simulator
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.records.log import TestLog

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Hardware:
    """Plant parameters (SI), and the effects that the setup itself brings (payload, weight)."""

    names: tuple[tuple[str, str], ...]
    values: Mapping[str, float]
    effects: Mapping[str, Mapping[str, float]]

    def pump_motion(self, command: Array) -> Array:
        """Return the angle of the pump motor (n,), rad, for its command (n,) at 1 kHz."""
        # scipy.signal.lfilter as a triangular system, without the second that its import takes
        from scipy.linalg.lapack import dtbtrs

        names = ("pump_gain", "pump_a2", "pump_a1", "pump_a0")
        numerator, denominator = _pump_filter(*(self.values[name] for name in names))
        late = np.interp(np.arange(len(command)) * 1e-3 - self.values["pump_delay"], np.arange(len(command)) * 1e-3, command)
        pushed = np.convolve(late - command[0], numerator)[: len(command)]
        bands = np.asfortranarray(np.repeat(denominator[:, None], len(command), axis=1))
        moved = dtbtrs(bands, pushed, uplo="L", diag="U")[0]
        return np.asarray(moved) / self.values["pump_lead"] + command[0]


@functools.lru_cache(maxsize=64)
def _pump_filter(gain: float, a2: float, a1: float, a0: float) -> tuple[Array, Array]:
    """Return numerator and denominator of gain / (s^3 + a2 s^2 + a1 s + a0) behind a zero-order hold at 1 kHz."""
    from scipy.linalg import expm

    rates = np.zeros((4, 4))
    rates[0] = -a2, -a1, -a0, 1.0
    rates[1, 0] = rates[2, 1] = 1.0
    step = expm(rates * 1e-3)
    denominator: Array = np.poly(step[:3, :3]).astype(np.float64)
    numerator = np.poly(step[:3, :3] - np.outer(step[:3, 3], [0.0, 0.0, gain])) - denominator
    return np.asarray(numerator, dtype=np.float64), denominator


def hardware_of(log: TestLog) -> Hardware:
    """Return the hardware that the log's metadata name; a choice that is absent is that of the reference setup."""
    return hardware_told(log.metadata)


def hardware_told(metadata: Mapping[str, str]) -> Hardware:
    """Return the hardware that metadata name, as `hardware_of` does."""
    names = tuple((group, metadata[group]) for group in (*PumpJoint.rig, *PumpJoint.setups) if metadata.get(group))
    return _hardware(names)


@functools.lru_cache(maxsize=64)
def _hardware(names: tuple[tuple[str, str], ...]) -> Hardware:
    from hjcamp.configuration.setups import configuration_for

    config: dict[str, Any] = configuration_for(names)
    values = PumpJoint.configured(config)
    effects = {name: dict(given) for name, given in (config.get("effects") or {}).items()}
    return Hardware(names, values, effects)


def composition(effects: tuple[Any, ...], cut: str, gated: bool = True) -> Composition:
    """Return the plant with ``effects`` behind gates, driven as ``cut`` says."""
    return Composition(PumpJoint, effects, PumpJoint.cut(cut), gated=gated)


@functools.lru_cache(maxsize=32)
def simulator(effects: tuple[Any, ...], cut: str, gated: bool = True) -> Simulator:
    """Return the compiled model of ``composition``."""
    return Simulator(composition(effects, cut, gated))
