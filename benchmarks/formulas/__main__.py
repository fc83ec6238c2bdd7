"""Twelve hidden laws on ten rigs each, and four laws that no form is: python -m benchmarks.formulas [DRAWS].

A rig visits its driver's range as a sum of three sines does, and has white noise; a free law of 12 knots (6 in the second table)
is fitted to it by least squares with its covariance, as a diagnosis has it, through straight pieces. Printed: how often the
hidden form is first, is among the three that are proposed, is called none; and of the laws outside how often none is said to fit.
"""

from __future__ import annotations

import sys
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.decision.formulas import Curve, formulas_of, proposed
from hjcamp.effects._forms import FORMS

Array = NDArray[np.float64]
RIGS = 10
SEED = 20261129
SAMPLES = 3000
BLOCKS = 16
SEEN = 3000  # places that a diagnosis keeps of where its tests were: of a state up to 4000
# Names that say the same: a straight line through 0, a cube beside a small linear part, a power with a whole exponent.
ACCEPTED = {
    "linear": ("linear", "proportional"),
    "cubic": ("cubic", "cubic_and_linear", "power"),
    "signed_square": ("signed_square", "square_and_linear", "power"),
    "root": ("root", "power"),
    "fourth_power": ("fourth_power", "even_power"),
    "saturation": ("saturation", "limit"),
    "hyperbola": ("hyperbola", "shifted_hyperbola"),
}
# Shares of the range of the driver (-1, 1): parameters of the hidden law, drawn between ends.
HIDDEN: dict[str, dict[str, tuple[float, float]]] = {
    "linear": {"a": (0.5, 2.0), "b": (-0.5, 0.5)},
    "cubic": {"a": (0.5, 2.0)},
    "sine": {"a": (0.5, 2.0), "b": (2.5, 9.0), "c": (-3.0, 3.0)},
    "signed_square": {"a": (0.5, 2.0)},
    "stribeck": {"a": (0.5, 1.0), "b": (0.5, 1.5), "c": (0.2, 0.5)},
    "exponential": {"a": (0.3, 1.0), "b": (0.25, 0.7), "c": (-0.5, 0.5)},
    "root": {"a": (0.5, 2.0)},
    "saturation": {"a": (0.5, 2.0), "b": (0.15, 0.4)},
    "dead_band": {"a": (0.5, 2.0), "b": (0.15, 0.5)},
    "bell": {"a": (0.5, 2.0), "b": (-0.4, 0.4), "c": (0.2, 0.5)},
    "fourth_power": {"a": (0.5, 2.0)},
    "hyperbola": {"a": (0.2, 0.6), "b": (-1.8, -1.2)},
}
OUTSIDE: dict[str, Callable[[Array, np.random.Generator], Array]] = {
    "two sines": lambda x, g: (
        np.sin(g.uniform(3, 4) * x + g.uniform(-3, 3)) + 0.8 * np.sin(g.uniform(7, 8) * x + g.uniform(-3, 3))
    ),
    "two bells": lambda x, g: (
        np.exp(-(((x - 0.5) / g.uniform(0.15, 0.25)) ** 2)) - 0.8 * np.exp(-(((x + 0.4) / g.uniform(0.15, 0.3)) ** 2))
    ),
    "a step and a slope": lambda x, g: np.sign(x - g.uniform(0.2, 0.5)) + g.uniform(1.0, 2.0) * np.abs(x + 0.3),
    "a chirp": lambda x, g: np.sin(g.uniform(5, 6) * (x + 1.2) ** 2),
}


def rig_curve(law: Callable[[Array], Array], generator: np.random.Generator, knots: int, noise: float) -> Curve:
    """Return the free law that is fitted to one rig's samples, its knots' errors about ``noise`` of its range."""
    time = np.linspace(0.0, 20.0, SAMPLES)
    rates, phases = generator.uniform(0.3, 4.0, 3), generator.uniform(0.0, 6.0, 3)
    x = sum(size * np.sin(rate * time + phase) for size, rate, phase in zip((1.0, 0.6, 0.4), rates, phases, strict=True))
    low, high = np.percentile(x, (1.0, 99.0))
    # the driver has a size of its own, and its range is not about 0
    x = (x - low) / (high - low) * 2.0 - 1.0
    places = np.linspace(-1.0, 1.0, knots)
    hats = np.stack([np.interp(x, places, one) for one in np.eye(knots)], axis=1)
    y = law(np.clip(x, -1.2, 1.2))
    bread = np.linalg.inv(hats.T @ hats)
    sigma = noise * float(np.ptp(law(places))) / float(np.sqrt(np.median(np.diag(bread))))
    values = bread @ (hats.T @ (y + sigma * generator.standard_normal(SAMPLES)))
    return Curve(places, values, sigma**2 * bread, BLOCKS, x[generator.choice(SAMPLES, SEEN, replace=False)])


def main(draws: int = RIGS, seed: int = SEED) -> None:
    """Print the tables of so many rigs a law, drawn from a seed."""
    for knots in (12, 6):
        for noise in (0.01, 0.03):
            generator = np.random.default_rng(seed)
            print(f"\n{knots} knots, errors {noise:.0%} of the range, {draws} rigs a law")
            print(f"{'hidden':<20}{'first':>8}{'in three':>10}{'none':>8}   instead")
            total = np.zeros(3)
            for name, ends in HIDDEN.items():
                counts, others = np.zeros(3), []
                for _ in range(draws):
                    values = [generator.uniform(*ends[one]) for one in FORMS[name].parameters]
                    found = formulas_of(rig_curve(lambda x, v=values, n=name: FORMS[n](x, v), generator, knots, noise))
                    names = [one.form.name for one in proposed(found)]
                    right = ACCEPTED.get(name, (name,))
                    counts += found[0].form.name in right, any(one in right for one in names), not found[0].fits
                    others += [] if any(one in right for one in names) else [found[0].form.name]
                total += counts
                print(
                    f"{name:<20}{counts[0] / draws:>8.0%}{counts[1] / draws:>10.0%}{counts[2] / draws:>8.0%}   {' '.join(others)}"
                )
            all_of = len(HIDDEN) * draws
            print(f"{'all':<20}{total[0] / all_of:>8.1%}{total[1] / all_of:>10.1%}{total[2] / all_of:>8.1%}")
            for name, law in OUTSIDE.items():
                counts, others = 0, []
                for _ in range(draws):
                    own = int(generator.integers(2**31))
                    fixed = lambda x, s=own, one=law: one(x, np.random.default_rng(s))  # noqa: E731
                    best = formulas_of(rig_curve(fixed, generator, knots, noise))[0]
                    counts += not best.fits
                    others += [best.form.name] * best.fits
                print(f"outside: {name:<20} none said in {counts / draws:.0%}   {' '.join(others)}")


if __name__ == "__main__":
    main(*(int(one) for one in sys.argv[1:3]))
