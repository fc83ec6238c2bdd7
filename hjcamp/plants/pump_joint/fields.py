"""The fields of the pump joint's logs. The place is the protobuf number, for good: append only."""

from __future__ import annotations

from hjcamp.model.declare.field import PHASE, TIME, Field

PUMP_DEG_PER_MM = 360.0  # lead of the pump's ball screw: 1 mm a turn
# What turns the pump may be given as the travel of its pistons.
TRAVEL = (("mm", PUMP_DEG_PER_MM),)

FIELDS = (
    TIME,
    PHASE,
    Field("reference_deg", "deg", False, "desired arm angle"),
    Field("arm_deg", "deg", True, "arm encoder"),
    Field("pressure1_mpa", "MPa", True, "pressure of line 1, pump side, gauge"),
    Field("pressure2_mpa", "MPa", True, "pressure of line 2, pump side, gauge"),
    Field("pump_deg", "deg", False, "pump motor encoder; 360 deg = 1 mm of piston travel", TRAVEL),
    Field("command_deg", "deg", False, "command to the pump's own position loop", TRAVEL),
    Field("pid_deg", "deg", False, "feedback part of the command", TRAVEL),
    Field("feedforward_deg", "deg", False, "feedforward part of the command", TRAVEL),
    Field("dither_v", "V", False, "dither added to the pump motor voltage"),
)
ONE_OF = ("pump_deg", "command_deg")
#: Names of channels and parameters as people read them.
LABELS = {
    "line_stiffness": "line stiffness dp/dV",
    "moving_mass": "moving mass",
    "stiffness_asymmetry": "stiffness, line 1 against 2",
    "arm_deg": "arm angle",
    "pressure1_mpa": "line 1",
    "pressure2_mpa": "line 2",
    "pump_deg": "pump",
}
