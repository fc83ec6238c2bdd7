"""All that a plant's file needs: ``from hjcamp.plant import Input, Measured, Parameter, Plant, State, contact, sensor``."""

from __future__ import annotations

from math import atan2, copysign, cos, exp, hypot, log, pi, sin, sqrt, tan, tanh

from hjcamp.model.declare.field import Phase
from hjcamp.model.declare.instance import Instance
from hjcamp.model.declare.marks import (
    actuator,
    body,
    contact,
    limited,
    line,
    outside,
    part,
    path,
    sensor,
    signal,
    slot,
    store,
    transmission,
)
from hjcamp.model.declare.parameter import Contact, Cut, Input, Measured, Parameter, State
from hjcamp.model.declare.plant import Plant
from hjcamp.model.declare.port import Port

__all__ = [
    "Contact", "Cut", "Input", "Instance", "Measured", "Parameter", "Phase", "Plant", "Port", "State", "actuator", "atan2",
    "body", "contact", "copysign", "cos", "exp", "hypot", "limited", "line", "log", "outside", "part", "path", "pi", "sensor",
    "signal", "sin", "slot", "sqrt", "store", "tan", "tanh", "transmission",
]  # fmt: skip
