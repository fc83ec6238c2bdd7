"""A simulator that runs its kernel's text as plain Python: for short tests of small plants, without compiling."""

from __future__ import annotations

import types

from hjcamp.model.compile.kernel import shared_source
from hjcamp.model.compile.kernel_cache import kernel_name
from hjcamp.model.run.simulator import Simulator

MARKS = "entry = hot = inlined = loop = once = lambda function: function\n"
MARKS += "from hjcamp.model.compile.vectors import ahead_in_python as ahead, strided_in_python as strided\n"


def uncompiled(simulator: Simulator) -> Simulator:
    """Return the simulator with a kernel that is not compiled."""
    simulator.__dict__["kernel"] = plain(simulator.source)
    return simulator


def plain(source: str) -> types.ModuleType:
    """Return a kernel's text as a module that is not compiled."""
    shared = shared_source()
    text = source.replace(f"from {kernel_name(shared)} import lead, mend, propagators", "")
    kernel = types.ModuleType("plain_kernel")
    exec(shared.replace("{decorator}", MARKS) + text.replace("{decorator}", MARKS), vars(kernel))
    return kernel
