"""No function of a kernel is compiled twice because a whole number stands in its call as a literal."""

from __future__ import annotations

import re

from hjcamp.model.compile.compose import Composition
from hjcamp.model.compile.kernel import kernel_source
from hjcamp.plants.pump_joint import PumpJoint


def test_no_call_of_a_compiled_function_holds_a_literal_whole_number() -> None:
    text = kernel_source(Composition(PumpJoint))
    compiled = re.findall(r"^@(?:entry|hot|inlined)\ndef (\w+)\(", text, re.MULTILINE)
    assert {"rates", "limited", "bounded"} <= set(compiled)
    calls = re.findall(rf"^ +.*\b(?:{'|'.join(compiled)}|propagators)\((.*)", text, re.MULTILINE)
    assert len(calls) > 20
    assert [call for call in calls if re.search(r"(?:^|, )-?\d+[,)]|\bLEVELS,", call)] == []
