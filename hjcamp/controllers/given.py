"""No control: the trajectory itself is the input."""

from __future__ import annotations

from hjcamp.controllers.controller import Controller


class Given(Controller):
    r"""The trajectory is given to an input, whatever the plant does: a free run.

    .. math:: u = r(t)

    ``controller.input`` says which input; the plant's only one unless said. The trajectory is in the unit of that input.
    """

    samples = ("reference",)
    results = ("given",)
    uses_arm = False

    @staticmethod
    def step(sample, parameter, memory):  # type: ignore[no-untyped-def]
        """Return the trajectory."""
        return sample.reference
