"""How far each hidden effect changes the logs, against what differs from repetition to repetition.

`python -m tests.truth.visibility [--seeds N ...] [EFFECT ...]` prints the table.
"""

import argparse
from dataclasses import dataclass

import numpy as np

from truth.pump_joint.case import Case, build_case, simulate_test
from truth.pump_joint.hidden import EFFECTS, STRENGTHS
from truth.pump_joint.plant import BASE_FIELDS
from truth.pump_joint.simulate import COLUMNS

CHANNELS = ("arm_deg", "pressure1_mpa", "pressure2_mpa", "pump_deg")
# The coarsest scatter that a channel can have: about a count of the encoders, the noise of the sensors.
LEAST_SCATTER = {"arm_deg": 0.15, "pressure1_mpa": 5e-4, "pressure2_mpa": 5e-4, "pump_deg": 2.0}
THINNING = 4


@dataclass(frozen=True)
class Visibility:
    """Largest change over scatter in open-loop and in closed-loop conditions, and open loop beyond base parameters."""

    open_loop: float
    closed_loop: float
    beyond_base: float
    place: str


def simulate_means(case: Case) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return for each condition the mean log, shape (4, n), and the scatter of each channel, shape (4,)."""
    places = [COLUMNS.index(name) for name in CHANNELS]
    means, scatters = [], []
    for index in range(len(case.conditions)):
        tests = [simulate_test(case, index, repetition)[::THINNING, places].T for repetition in range(case.repetitions)]
        stack = np.array(tests)
        means.append(stack.mean(axis=0))
        least = np.array([LEAST_SCATTER[name] for name in CHANNELS])
        scatters.append(np.maximum(np.sqrt(stack.var(axis=0, ddof=1).mean(axis=1)), least))
    return means, scatters


def scaled_change(changed: list[np.ndarray], null: list[np.ndarray], scatters: list[np.ndarray]) -> list[np.ndarray]:
    """Return the change of the mean logs in units of the scatter, one array (4, n) for each condition."""
    return [(a - b) / s[:, None] for a, b, s in zip(changed, null, scatters, strict=True)]


def base_sensitivities(case: Case, null: list[np.ndarray], scatters: list[np.ndarray]) -> np.ndarray:
    """Return the scaled change by 3 % of each base parameter, shape (total samples, parameters)."""
    columns = []
    for name in BASE_FIELDS:
        moved = case.plant._replace(**{name: getattr(case.plant, name) * 1.03})
        means, _ = simulate_means(Case(moved, {}, case.conditions, case.repetitions, case.seed))
        columns.append(np.concatenate([part.ravel() for part in scaled_change(means, null, scatters)]))
    return np.array(columns).T


@dataclass
class Bench:
    """A null campaign with its scatter, against which effects on the same rig and the same draws are compared."""

    seed: int
    repetitions: int = 6
    menu: str = "standard"

    def __post_init__(self) -> None:
        """Simulate the null campaign and the response to the base parameters."""
        case = build_case((), seed=self.seed, menu=self.menu, repetitions=self.repetitions)
        self.null, self.scatters = simulate_means(case)
        self.base = base_sensitivities(case, self.null, self.scatters)

    def visibility(self, effect: str, strength: str | float) -> Visibility:
        """Return how visible an effect is in this campaign; "chance" moves nothing but the course of stick-slip."""
        if effect == "chance":
            case = build_case((), seed=self.seed, menu=self.menu, repetitions=self.repetitions)
            plant = case.plant._replace(viscous_positive=case.plant.viscous_positive * 1.002)
            case = Case(plant, {}, case.conditions, case.repetitions, case.seed)
        else:
            case = build_case((effect,), strength, self.seed, self.menu, self.repetitions)
        change = scaled_change(simulate_means(case)[0], self.null, self.scatters)
        flat = np.concatenate([part.ravel() for part in change])
        rest = flat - self.base @ np.linalg.lstsq(self.base, flat, rcond=1e-8)[0]
        beyond, start = [], 0
        for part in change:
            beyond.append(rest[start : start + part.size].reshape(part.shape))
            start += part.size
        closed = np.array([condition.closed_loop for condition in case.conditions])
        ratios, left = _levels(change), _levels(beyond)
        row, column = np.unravel_index(int(np.argmax(ratios)), ratios.shape)
        return Visibility(
            float(ratios[~closed].max(initial=0.0)),
            float(ratios[closed].max(initial=0.0)),
            float(left[~closed].max(initial=0.0)),
            f"{case.conditions[row].name}/{CHANNELS[column]}",
        )


def _levels(parts: list[np.ndarray]) -> np.ndarray:
    return np.array([np.sqrt(np.mean(part**2, axis=1)) for part in parts])


def main() -> None:
    """Print the visibility of the named effects (all when none is named) at three strengths, median over rigs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("effects", nargs="*", metavar="EFFECT")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--repetitions", type=int, default=4)
    arguments = parser.parse_args()
    benches = [Bench(seed, arguments.repetitions) for seed in arguments.seeds]
    print("change over scatter: open loop/closed loop (open loop beyond the base parameters), median over rigs")
    print(f"{'effect':24}" + "".join(f"{name:>19}" for name in STRENGTHS) + "  where (medium)")
    for name in arguments.effects or ["chance", *EFFECTS]:
        cells, places = "", []
        for strength in STRENGTHS:
            seen = [bench.visibility(name, strength) for bench in benches]
            opened, closed, beyond = np.median([(v.open_loop, v.closed_loop, v.beyond_base) for v in seen], axis=0)
            cells += f"{opened:7.2f}/{closed:4.1f} ({beyond:4.1f})"
            places.append(seen[0].place)
        print(f"{name:24}{cells}  {places[1]}", flush=True)


if __name__ == "__main__":
    main()
