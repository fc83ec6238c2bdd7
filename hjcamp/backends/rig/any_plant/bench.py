"""A user's rig tried without its hardware: the loop with its channels, on a fake driver that fails in every way."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from hjcamp.backends.plant_simulation import plant_in
from hjcamp.backends.rig.any_plant.backend import run_on
from hjcamp.backends.rig.fault import RigUnavailable
from hjcamp.backends.virtual_rig.clients import Stepped
from hjcamp.backends.virtual_rig.stepping import compile_stepping
from hjcamp.errors import HjcampError, RigStopped
from hjcamp.rigs.fit import wired
from hjcamp.rigs.rig import Rig

AT = 20  # the sample at which a driver fails
BLOCKED = 3.0  # deadlines for which a driver that blocks does so
# The deadline of the call that blocks, and of all others: these may be late on a busy computer, and that is not what is tried.
DEADLINE_S, PATIENCE_S = 0.5, 30.0


@dataclass(frozen=True)
class Way:
    """A way to fail: ``in_words``, what the message ``says``, and whether the outputs can still be made ``safe``."""

    in_words: str
    says: str
    safe: bool = True


WAYS = {
    "sound": Way("nothing is wrong", ""),
    "late": Way("read() comes later than its deadline", "read() did not return within"),
    "silent": Way("read() returns nothing", "read() gave null"),
    "nan": Way("a reading is NaN", "it reads nan"),
    "infinite": Way("a reading is infinite", "it reads inf"),
    "short": Way("read() lacks a value", "values; "),
    "long": Way("read() gives a value too many", "values; "),
    "words": Way("read() returns text", " needed"),
    "raises": Way("read() raises", "read() failed: OSError: the cable was pulled"),
    "write_raises": Way("write() raises", "write() failed: OSError: the cable was pulled"),
    "exits": Way("read() ends the program", "read() failed: SystemExit"),
    "blocks": Way("write() never returns", "write() did not return within"),
    "backwards": Way("the device's samples go backwards", "after sample"),
    "misses": Way("samples are missed at once", "missed at once"),
    "unplugged": Way("everything raises, safe() too", "THE OUTPUTS COULD NOT BE WRITTEN", safe=False),
}


class Fake(Stepped):
    """A driver that fails in one ``way`` from sample ``AT`` on; ``ever`` keeps what was written, and when it was made safe."""

    way: str = "sound"
    deadline_s = PATIENCE_S
    missed_at_once, missed_in_all = 4, 40

    def open(self) -> None:
        """Begin."""
        super().open()
        self.ever: list[list[float]] = []
        self.failed = False

    def read(self) -> Any:
        """Return the next sample, or fail."""
        values: Any = super().read()
        count = self.sample or 0
        if self.way == "misses" and count >= AT:
            self.sample = count + 10
        if (self.way, count) in (("late", AT - 1), ("blocks", AT)):
            type(self).deadline_s = DEADLINE_S  # of the next call, which blocks
        if count < AT:
            return values
        self.failed = True
        if self.way in ("raises", "unplugged"):
            raise OSError("the cable was pulled")
        if self.way == "exits":
            raise SystemExit(1)
        if self.way == "late":
            self._block()
        if self.way == "backwards":
            self.sample = count - 5
        changed = {
            "silent": lambda: None,
            "nan": lambda: [float("nan"), *values[1:]],
            "infinite": lambda: [float("inf"), *values[1:]],
            "short": lambda: values[:-1],
            "long": lambda: [*values, 0.0],
            "words": lambda: ["?"] * len(values),
        }
        return changed.get(self.way, lambda: values)()

    def write(self, values: Any) -> None:
        """Set the outputs, or fail."""
        if self.failed and self.way in ("write_raises", "blocks") and not self._making_safe:
            if self.way == "write_raises":
                raise OSError("the cable was pulled")
            self._block()
            return
        super().write(values)
        self.ever.append(self.put)

    def _block(self) -> None:
        type(self).deadline_s = PATIENCE_S
        time.sleep(BLOCKED * DEADLINE_S)

    _making_safe = False

    def safe(self) -> None:
        """Make the outputs safe, unless everything is gone."""
        if self.failed and self.way == "unplugged":
            raise OSError("the cable was pulled")
        self._making_safe = True
        try:
            super().safe()
        finally:
            self._making_safe = False


def fake_of(rig: type[Rig], config: Mapping[str, Any], way: str) -> Fake:
    """Return a fake driver with the channels of a rig, on the simulated plant of a configuration."""
    own = {name: getattr(rig, name) for name in ("name", "plant", "channels", "reads", "tracking", "clipped_s")}
    kind = type("FakeDriver", (Fake,), {**own, "config": config, "wiring": wired(rig, plant_in(config)), "way": way})
    made = kind()
    assert isinstance(made, Fake)
    return made


def tried(
    rig: type[Rig], config: Mapping[str, Any], heard: Callable[[str], None] = lambda way: None
) -> Iterator[tuple[str, bool, str]]:
    """Yield for each way to fail whether the loop did what it must, and what it said; ``heard`` is told of each way before."""
    compile_stepping(config)
    for way, expected in WAYS.items():
        heard(way)
        fake, said = fake_of(rig, config, way), ""
        try:
            run_on(fake, config, 1)
        except (RigStopped, RigUnavailable) as error:
            said = str(error)
        except HjcampError as error:
            said = f"not stopped: {error}"
        safe = [one.sign * one.safe for one in fake.given]
        stands_safe = fake.put == safe
        right = expected.says in said and (bool(said) or way == "sound") and not (way == "sound" and said)
        yield way, right and (stands_safe or not expected.safe), said
