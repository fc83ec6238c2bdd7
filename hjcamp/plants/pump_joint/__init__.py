"""The pump-driven joint: equations, hardware, procedure, the loop of its tests, feedforward, and what is tried out on it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hjcamp.plants.pump_joint.plant import PumpJoint as PumpJoint


def __getattr__(name: str) -> Any:
    # Its schema is read at every call of the program; the equations take longer to import.
    if name == "PumpJoint":
        from hjcamp.plants.pump_joint.plant import PumpJoint

        return PumpJoint
    raise AttributeError(f"module {__name__} has no attribute {name}")
