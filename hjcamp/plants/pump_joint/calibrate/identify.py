"""All identifications that a set of logs can serve, for one rig."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from hjcamp.errors import UsageError, counted, unknown
from hjcamp.plants.pump_joint.calibrate.compliance import identify_compliance
from hjcamp.plants.pump_joint.calibrate.constants import Configure, Names, constants_of, hardware_of
from hjcamp.plants.pump_joint.calibrate.estimate import Estimate, Finding
from hjcamp.plants.pump_joint.calibrate.friction import identify_friction
from hjcamp.plants.pump_joint.calibrate.kinds import kind_of
from hjcamp.plants.pump_joint.calibrate.leakage import identify_leakage
from hjcamp.plants.pump_joint.calibrate.pump import identify_pump
from hjcamp.plants.pump_joint.calibrate.sensors import identify_sensors
from hjcamp.records.log import TestLog

IDENTIFIED = ("pump_step", "compliance", "leakage", "friction")
DEFAULT_NOISE = 700.0


@dataclass(frozen=True)
class Calibration:
    """What the logs of one rig tell: the findings by kind of test, and which choices of hardware they name."""

    hardware: Mapping[str, str]
    findings: Mapping[str, Finding]
    tests: int

    @property
    def estimates(self) -> dict[str, Estimate]:
        """Every estimate by name."""
        return {one.name: one for finding in self.findings.values() for one in finding.estimates}


def only(logs: Sequence[TestLog], wanted: Mapping[str, str]) -> list[TestLog]:
    """Return the logs whose metadata have the ``wanted`` values; raises UsageError where none has."""
    kept = [log for log in logs if all(log.metadata.get(name) == value for name, value in wanted.items())]
    if not kept:
        for name, value in wanted.items():
            there = {log.metadata[name] for log in logs if name in log.metadata}
            if value not in there:
                raise unknown(name, value, there, "the metadata of these logs")
        raise UsageError(f"no log has {' '.join(f'{name}={value}' for name, value in wanted.items())}")
    return kept


def one_rig(logs: Sequence[TestLog]) -> dict[str, str]:
    """Return the hardware that all logs share; raises UsageError where they name more than one."""
    hardware: dict[str, str] = {}
    for log in logs:
        for group, choice in hardware_of(log):
            if hardware.setdefault(group, choice) != choice:
                there = sorted({other.metadata[group] for other in logs if other.metadata.get(group)})
                raise UsageError(
                    f"mixed hardware: these logs name {len(there)} choices of {group}: {', '.join(there)}; one rig is "
                    f"calibrated at a time, for example with --only {group}={there[0]}"
                )
    return hardware


def identify(logs: Sequence[TestLog], configure: Configure) -> Calibration:
    """Return every constant that the logs of one rig support, with intervals, charts and warnings.

    Raises UsageError for logs of mixed hardware, for logs that serve no identification, and for what each
    identification refuses. ``configure`` gives the resolved configuration of choices (group, choice).
    """
    if not logs:
        raise UsageError("no logs to calibrate from")
    hardware = one_rig(logs)
    names: Names = tuple(hardware.items())
    groups: dict[str, list[TestLog]] = {}
    for log in logs:
        groups.setdefault(kind_of(log) or "", []).append(log)
    if not any(kind in groups for kind in IDENTIFIED):
        raise UsageError(
            f"none of {counted(len(logs), 'log')} serves an identification. Needed is at least one of: a step of the pump, a pump "
            "that moves while the joint is blocked, 15 s at rest under pressure, ramps of the pump at several speeds "
            "(campaigns pump_step, compliance, leakage, friction)"
        )
    sensors = identify_sensors(logs)
    findings: dict[str, Finding] = {}
    for kind in IDENTIFIED:
        if kind not in groups:
            continue
        own = groups[kind]
        constants = constants_of(own[0], lambda given: configure(given or names))
        if kind == "pump_step":
            findings[kind] = identify_pump(own, constants)
        elif kind == "compliance":
            findings[kind] = identify_compliance(own, constants)
        elif kind == "leakage":
            findings[kind] = _leakage(own, findings, constants.published["line_stiffness"], sensors)
        else:
            findings[kind] = identify_friction(own, constants)
    findings["sensors"] = sensors
    return Calibration(hardware, findings, len(logs))


def _leakage(own: list[TestLog], findings: Mapping[str, Finding], published: float, sensors: Finding) -> Finding:
    noise = sensors["pressure_noise"].value or DEFAULT_NOISE
    if "compliance" in findings:
        return identify_leakage(own, findings["compliance"]["line_stiffness"].value, noise)
    found = identify_leakage(own, published, noise)
    warning = f"no compliance tests: conductances use the published dp/dV, {published * 1e-15:g} MPa/mm³"
    return Finding(found.subject, found.estimates, found.charts, (*found.warnings, warning), found.facts)
