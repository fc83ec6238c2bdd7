"""Reference motions of an axis or a servo, and what scatters from test to test, at 1 kHz."""

from dataclasses import dataclass, field

import numpy as np
from scipy.ndimage import gaussian_filter1d, uniform_filter1d
from scipy.signal import lfilter

SAMPLE = 1e-3


@dataclass
class Course:
    """A reference that grows by one piece after another, within `stroke` about 0 and the highest speed and acceleration."""

    stroke: float
    speed: float
    acceleration: float
    parts: list[np.ndarray] = field(default_factory=lambda: [np.zeros(200)])

    @property
    def place(self) -> float:
        """Where the last piece ended."""
        return float(self.parts[-1][-1])

    @property
    def samples(self) -> int:
        """How long it is by now."""
        return sum(part.size for part in self.parts)

    def move(self, target: float, share: float, longest: float = 3.0) -> None:
        """Go to `target` at a share of the highest speed with trapezoidal speed, or as far as `longest` seconds allow."""
        speed = share * self.speed
        way = target - self.place
        way = float(np.clip(way, -speed * longest, speed * longest))
        rise = speed / self.acceleration
        if abs(way) < speed * rise:
            rise = np.sqrt(abs(way) / self.acceleration)
            speed = self.acceleration * rise
        whole = abs(way) / max(speed, 1e-12) + rise
        time = np.arange(1, max(round(whole / SAMPLE), 1) + 1) * SAMPLE
        rates = np.interp(time, [0.0, rise, max(whole - rise, rise), whole], [0.0, speed, speed, 0.0])
        steps = np.cumsum(rates)
        self.parts.append(self.place + way * steps / max(steps[-1], 1e-12))

    def swing(self, frequency: float, amplitude: float, periods: int) -> None:
        """Swing towards the middle and back, `amplitude` to each side, so that it starts and ends at rest."""
        time = np.arange(1, round(periods / frequency / SAMPLE) + 1) * SAMPLE
        side = -1.0 if self.place > 0 else 1.0
        self.parts.append(self.place + side * amplitude * (1 - np.cos(2 * np.pi * frequency * time)))

    def hold(self, duration: float) -> None:
        """Stay."""
        self.parts.append(np.full(round(duration / SAMPLE), self.place))

    def reference(self, samples: int) -> np.ndarray:
        """Return the course, its corners rounded over 20 ms, held or cut to a number of samples."""
        whole = np.concatenate([*self.parts, np.full(max(samples - self.samples, 0), self.place)])
        return uniform_filter1d(whole, 21, mode="nearest")[:samples]


def mixed(stroke: float, speed: float, acceleration: float, duration: float, random: np.random.Generator) -> np.ndarray:
    """Return one long course of moves at all speeds, swings, creeps and holds, drawn at random."""
    course = Course(stroke, speed, acceleration)
    samples = round(duration / SAMPLE)
    while course.samples < samples:
        for kind in random.permutation(["fast", "middle", "slow", "creep", "swing", "quick_swing", "hold", "small"]):
            side = -1.0 if course.place > 0 else 1.0
            target = side * stroke * float(random.uniform(0.25, 0.5))
            if kind in ("fast", "middle", "slow", "creep"):
                low, high = {"fast": (0.8, 1), "middle": (0.3, 0.6), "slow": (0.08, 0.2), "creep": (0.02, 0.05)}[kind]
                longest = {"slow": 2.0, "creep": 1.2}.get(kind, 3.0)
                course.move(target, float(random.uniform(low, high)), longest)
                if kind == "creep":
                    course.move(-target, float(random.uniform(low, high)), longest)
            elif kind == "hold":
                course.hold(float(random.uniform(0.3, 0.8)))
            elif kind == "small":
                for step in random.uniform(-0.03, 0.03, 3):
                    course.move(course.place * 0.95 + stroke * float(step), 0.3)
                    course.hold(0.15)
            else:
                frequency = float(random.uniform(0.4, 0.9) if kind == "swing" else random.uniform(1.2, 2.5))
                turn = 2 * np.pi * frequency
                most = min(0.9 * speed / turn, acceleration / turn**2, 0.5 * (0.5 * stroke + abs(course.place)))
                course.swing(frequency, most * float(random.uniform(0.6, 1.0)), 1 if kind == "swing" else 3)
    return course.reference(samples)


def pulses(samples: int, volt: float, random: np.random.Generator) -> np.ndarray:
    """Return voltage pulses of 0.5 s, one each 1.5 s, of either sign."""
    time = np.arange(samples) * SAMPLE
    signs = random.choice([-1.0, 1.0], round(samples * SAMPLE / 1.5) + 1)
    return volt * signs[(time // 1.5).astype(int)] * (time % 1.5 > 1.0)


@dataclass(frozen=True)
class Fluctuation:
    """What friction does by chance in one test: shares over the travel (201,) and over time (n,), a fraction of a count."""

    profile: np.ndarray
    wander: np.ndarray
    counted: float


def fluctuation(samples: int, random: np.random.Generator, between: float = 0.02) -> Fluctuation:
    """Draw it: a level of the test (standard deviation `between`), 1.2 % over the travel, 1 % over time in 0.5 s."""
    rough = gaussian_filter1d(random.normal(size=201), 5.0)
    memory = np.exp(-SAMPLE / 0.5)
    drive = random.normal(0, 0.01 * np.sqrt(1 - memory**2), samples)
    start = random.normal(0, 0.01)
    slow = lfilter([1.0], [1.0, -memory], drive, zi=[memory * start])[0]
    level = random.normal(0, between)
    return Fluctuation(0.012 * rough / rough.std(), level + slow, float(random.uniform(0, 1)))
