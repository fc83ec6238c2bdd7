"""A rig that changes while it is hunted on: said, and its base parameters estimated again; one that does not is left alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hunted import Script, course, hunt, hunted, said
from lab_of_rigs import MOTION

from hjcamp.campaign import conclude
from hjcamp.commands.hunting import any_plant
from hjcamp.commands.hunting.drift import LEVEL, drift_of
from hjcamp.records.log import TestLog

SAMPLES = 400


def logs(count: int, generator: np.random.Generator, shift: float = 0.0, slow: bool = False) -> list[TestLog]:
    """Return tests of a sine with noise, white or as slow as the sine itself; ``shift`` changes its size."""
    time = np.arange(SAMPLES) * 1e-3
    shape = np.sin(2.0 * np.pi * time / time[-1])
    found = []
    for _ in range(count):
        noise = generator.standard_normal() * shape if slow else generator.standard_normal(SAMPLES)
        found.append(TestLog({"time_s": time, "position_m": (10.0 + shift) * shape + noise}, {}))
    return found


@pytest.mark.parametrize("slow", [False, True])
@pytest.mark.parametrize("repetitions", [2, 3, 8])
def test_a_rig_that_stays_as_it_is_is_hardly_ever_said_to_have_changed(slow: bool, repetitions: int) -> None:
    generator = np.random.default_rng(1)
    said_so = 0
    for _ in range(300):
        first = logs(repetitions, generator, slow=slow)
        said_so += bool(drift_of(first, first, logs(1, generator, slow=slow)[0]))
    assert said_so <= 3 + 300 * LEVEL


@pytest.mark.parametrize(("slow", "repetitions", "shift"), [(False, 2, 3.0), (False, 5, 2.0), (True, 8, 12.0)])
def test_one_that_changes_by_more_than_repetitions_do_is_noticed(slow: bool, repetitions: int, shift: float) -> None:
    generator = np.random.default_rng(2)
    for _ in range(20):
        first = logs(repetitions, generator, slow=slow)
        [row] = drift_of(first, first, logs(1, generator, shift, slow)[0])
        assert row["field"] == "position_m" and row["differs"] > row["repetitions_differ"]


def test_without_repetitions_nothing_is_said() -> None:
    generator = np.random.default_rng(3)
    assert drift_of(logs(1, generator), logs(1, generator), logs(1, generator, 1e3)[0]) == []


BENCH = '''"""A bench whose carriage becomes heavier after its campaign."""
from pathlib import Path
from hjcamp.backends.virtual_rig.clients import Stepped
from hjcamp.backends.virtual_rig.device import wiring_of_plant
from hjcamp.configuration.composer import Composer, free
from hjcamp.known_plants import find_plant
from hjcamp.rigs.fit import channels_of_plant

class Bench(Stepped):
    """The axis, simulated; its mass is in a file."""
    plant = "axis1"
    wiring = wiring_of_plant(find_plant("axis1"))
    channels = channels_of_plant(wiring.plant)
    def open(self):
        mass = Path("mass.txt").read_text()
        self.config = Composer().compose([free(line) for line in (*{motion!r}, f"parameters.mass={{mass}}")]).config
        super().open()
'''


@pytest.mark.parametrize("changes", [False, True])
def test_a_rig_that_becomes_heavier_while_it_is_hunted_on(lab: Path, monkeypatch: pytest.MonkeyPatch, changes: bool) -> None:
    (lab / "rigs" / "bench.py").write_text(BENCH.format(motion=MOTION))
    (lab / "mass.txt").write_text("95")
    script = Script(said("one_of", "spring", "soft_stop"), tests=1)

    def judged(data: object, asked: object, report: object) -> object:
        if changes and len(script.seen) == 1:
            (lab / "mass.txt").write_text("140")
        return script.judged(data, asked, report)  # type: ignore[arg-type]

    monkeypatch.setattr(any_plant, "judged", judged)
    monkeypatch.setattr(conclude, "_report", lambda folder, console: None)
    assert hunt("backend=rig", "rig=bench", "run_dir=out", budget="5s" if changes else "2.5s") == 0
    found = hunted()
    rounds = found["rounds"]
    assert [bool(one["drift"]) for one in rounds] == [changes and k == 2 for k in range(len(rounds))]
    assert all(one["tests"][0]["text"] == "cycloid__plain_pid once more" for one in rounds[1:])
    if not changes:
        assert [one["since"] for one in rounds] == [0] * len(rounds) and len(script.seen[-1]) == 2 * len(rounds) - 1
        return
    assert [one["since"] for one in rounds] == [0, 0, *[2] * (len(rounds) - 2)] and len(rounds) > 3
    assert all(name.startswith(("t2_", "t3_")) for name in script.seen[3]), script.seen  # what was before no longer counts
    page = Path("out/index.html").read_text()
    assert "The rig has changed" in page and "voltage" in page and "mass: 96 -&gt; 96 kg" in page
    assert course(found)[1] == "budget"
