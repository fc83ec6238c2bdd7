"""The base class of all controllers: one control law is one class in one file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.declare.law import Law


class Controller(Law):
    """A law that commands a plant from the reference and from what is measured.

    ``samples`` are what it reads (see `hjcamp.controllers.fit`), ``results`` the inputs that it commands; ``planned`` are
    columns that ``plan`` computes along the reference before the test. Those below are the usual plant's, the reference's joint:

    Per sample it receives ``reference``, ``velocity`` and ``acceleration`` of the arm (rad, rad/s, rad/s^2), the
    measured ``arm`` angle (rad), the ``feedforward`` command (rad of its motor), the ``period`` (s) and the
    ``index`` of the sample. It returns the feedback and the feedforward part of the command, rad of its motor.

    ``uses_arm`` False says that the law does not look at the arm: nothing then makes the arm follow the reference.
    """

    samples: ClassVar[tuple[str, ...]] = (
        "reference",
        "velocity",
        "acceleration",
        "arm",
        "feedforward",
        "period",
        "index",
    )
    results: ClassVar[tuple[str, ...]] = ("pid", "feedforward")
    uses_feedforward = False
    uses_arm = True
    planned: ClassVar[tuple[str, ...]] = ()
    inverts: ClassVar[bool] = False  # what is planned is the input with which ``controller.model`` follows the reference
    tuned: ClassVar[tuple[str, ...]] = ()  # what `hjcamp tune` seeks where the plant does not tune itself

    @classmethod
    def begin(cls, parameter: Mapping[str, float], plant: Mapping[str, float]) -> dict[str, float]:
        """Return the states, SI, to which the plant is brought before a test under this law; none by default.

        ``parameter`` are those of the law, ``plant`` those of the plant as configured.
        """
        return {}

    @classmethod
    def plan(
        cls, reference: NDArray[np.float64], parameter: Mapping[str, float], plant: Mapping[str, float], period: float
    ) -> NDArray[np.float64]:
        """Return the ``planned`` columns (n, planned) for a reference (n, 3): value, velocity and acceleration, SI.

        ``parameter`` are those of the law, ``plant`` those of the plant as configured; ``period`` in s.
        """
        raise NotImplementedError
