"""What can go wrong with the virtual rig, and when."""

from __future__ import annotations

from hjcamp.backends.virtual_rig import faults
from hjcamp.backends.virtual_rig.faults import Fault

__all__ = ["KINDS", "Fault", "parse_fault"]

KINDS = {
    "stuck_encoder": "the arm encoder repeats its last count",
    "stuck_pump_encoder": "the pump motor encoder repeats its last count",
    "lost_sensor": "the wire of pressure sensor 1 breaks: 0 V",
    "burst_line": "line 1 is open to the air",
    "late_samples": "five samples are missed at once",
    "one_late_sample": "one sample is missed, once",
    "device_gone": "the device answers no call any more; its outputs take their power-up state",
    "error_code": "reading fails with an error of the driver",
    "clock_stopped": "the sample clock stops: reading times out",
    "pressure_spike": "pressure sensor 1 reads 0.8 MPa more",
    "pressure_drop": "pressure sensor 1 reads -0.112 MPa",
    "arm_jump": "the arm encoder jumps by 250 deg",
    "pump_jump": "the pump motor encoder jumps by 10 mm",
    "swapped_pressures": "the two pressure sensors are exchanged (from the start)",
    "reversed_encoder": "the arm encoder counts the wrong way (from the start)",
    "noisy_sensor": "pressure sensor 1 jumps by 0.2 V from sample to sample",
}


def parse_fault(text: str) -> Fault:
    """Return the fault written as ``KIND``, ``KIND@SAMPLE`` or ``KIND@SAMPLE#TEST``."""
    return faults.parse_fault(text, KINDS)
