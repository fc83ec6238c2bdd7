"""The braided muscle next to a cylinder of its size (thesis 3.4, Figure 3.4.1)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.plants.pump_joint.sizing.actuators import cylinder_area

Array = NDArray[np.float64]
#: Of a thin braid that holds its pressure without force: tan^2 = 2.
FREE_ANGLE = math.atan(math.sqrt(2.0))


@dataclass(frozen=True)
class Muscle:
    r"""A braided muscle: ``length`` at rest, ``thread`` of the braid, ``diameter90`` at 90 deg, wall ``membrane``; SI.

    .. math:: F/p = \tfrac{\pi}{4} D_{90}^2 (3\cos^2\vartheta - 1)
              + \pi (D_{90} t (2\sin\vartheta - 1/\sin\vartheta) - t^2), \quad \cos\vartheta = (L_0 - x)/b

    No friction, threads that do not stretch. Source: Chou & Hannaford (1996), IEEE Trans. Robotics and Automation 12;
    the thesis states sizes alone.
    """

    length: float
    thread: float
    diameter90: float
    membrane: float

    def area(self, contraction: Array) -> Array:
        """Return F/p, m^2, at a contraction in m."""
        cos = (self.length - np.asarray(contraction)) / self.thread
        sin = np.sqrt(1.0 - cos**2)
        wall = self.membrane
        thin = math.pi / 4.0 * self.diameter90**2 * (3.0 * cos**2 - 1.0)
        return thin + math.pi * (self.diameter90 * wall * (2.0 * sin - 1.0 / sin) - wall**2)

    @property
    def rest_angle(self) -> float:
        """The braid's angle at rest, rad."""
        return math.acos(self.length / self.thread)

    @property
    def rest_diameter(self) -> float:
        """The diameter at rest, m."""
        return self.diameter90 * math.sin(self.rest_angle)

    def longest_contraction(self) -> float:
        """Return the contraction at which the force vanishes, m."""
        from scipy.optimize import brentq

        return float(brentq(lambda x: float(self.area(np.array(x))), 0.0, 0.6 * self.length))


def muscle_with_crossing(length: float, largest_diameter: float, membrane: float, bore: float, crossing: float) -> Muscle:
    """Return the muscle that pulls as hard as a cylinder of ``bore`` at the contraction ``crossing``; SI units.

    ``largest_diameter`` is taken where the braid is free of force (54.7 deg). The length of the thread, which the thesis
    leaves out, is the one unknown; its crossing at 8 mm gives it. Source: thesis 3.4.
    """
    from scipy.optimize import brentq

    diameter90 = largest_diameter / math.sin(FREE_ANGLE)

    def excess(thread: float) -> float:
        return float(Muscle(length, thread, diameter90, membrane).area(np.array(crossing))) - cylinder_area(bore)

    thread = brentq(excess, length * 1.02, (length - crossing) * math.sqrt(3.0))
    return Muscle(length, float(thread), diameter90, membrane)
