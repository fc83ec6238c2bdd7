"""The modules that do for this joint alone what the program does for any plant; each is imported when it is asked for."""

from __future__ import annotations

HERE = "hjcamp.plants.pump_joint"
ROOMS = {
    "compare": f"{HERE}.answers.compare",
    "diagnose": f"{HERE}.answers.diagnose",
    "add": f"{HERE}.answers.add",
    "calibrate": f"{HERE}.answers.calibrate",
    "next": f"{HERE}.answers.propose",
    "hunt": f"{HERE}.answers.hunt",
    "common": f"{HERE}.common",
    "python": f"{HERE}.answers.python",
    "tables": f"{HERE}.answers.tables",
    "effects": f"{HERE}.answers.effects",
    "curve": f"{HERE}.answers.curve",
    "tune": f"{HERE}.answers.tune",
    "configuration": f"{HERE}.configuration",
    "simulation": f"{HERE}.simulation",
    "nidaqmx": f"{HERE}.rig.nidaqmx",
    "rig": f"{HERE}.answers.rig",
    "watches": f"{HERE}.rig.margins",
    "indicators": f"{HERE}.indicators",
    "panels": f"{HERE}.figures.panels",
    "published": f"{HERE}.published.reference",
    "run": f"{HERE}.studies.of_run",
    "kernels": f"{HERE}.studies.warm",
}
