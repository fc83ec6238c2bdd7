"""The short way for a whole sample on which only the linear part acts: the same bits as the long one."""

import numpy as np
from quiet_loop import columns, simulator, sine

from hjcamp.model import kernel
from hjcamp.plants.pump_joint.loop import JointSimulator

PRESSURES = (0.32e6, 0.14e6)


def test_whole_samples_are_moved_as_in_steps(monkeypatch) -> None:  # type: ignore[no-untyped-def]
    reference = sine(120.0, 2.0, 0.4)
    # a low speed limit: the limiter acts in some samples and not in others
    for values in ({}, {"pump_speed_limit": 0.02}):
        short = columns(reference, PRESSURES, values=values)
        assert "GLIDES = True" in simulator().source
        with monkeypatch.context() as patch:
            patch.setattr(kernel, "limits_kept", lambda composition: False)
            long = JointSimulator(simulator().composition, controller=simulator().controller)
            assert "GLIDES = False" in long.source
            patch.setattr("quiet_loop.simulator", lambda *_, long=long: long)
            steps = columns(reference, PRESSURES, values=values)
        for name, value in short.items():
            assert np.array_equal(value, steps[name]), name
        assert short["events"] > 0
