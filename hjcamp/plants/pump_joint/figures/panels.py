"""The panels of a condition's picture: arm, error, pressures, command; and the signals that are in them."""

from __future__ import annotations

from hjcamp.report.pictures.conditions import BLUE, GREEN, INK, OBSERVED, RED, Curve, Panel

SIGNALS = (
    "reference_deg",
    "arm_deg",
    "error_deg",
    "pressure1_mpa",
    "pressure2_mpa",
    "command_deg",
    "pid_deg",
    "feedforward_deg",
    "pump_deg",
)
PANELS = (
    Panel("Arm angle (deg)", (Curve("arm_deg", OBSERVED, BLUE), Curve("reference_deg", "reference", INK, True)), 1.4),
    Panel("Error (deg)", (Curve("error_deg", f"reference − {OBSERVED}", BLUE),)),
    Panel("Pressure (MPa gauge)", (Curve("pressure1_mpa", "line 1", BLUE), Curve("pressure2_mpa", "line 2", RED))),
    Panel(
        "Pump command (deg)",
        (
            Curve("command_deg", "command", BLUE),
            Curve("pid_deg", "feedback part", RED),
            Curve("feedforward_deg", "feedforward part", GREEN),
        ),
    ),
)
