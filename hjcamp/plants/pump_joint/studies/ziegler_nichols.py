"""First gains of a PID by the stability method: from the gain at which the loop starts to oscillate, and its period."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class CriticalPoint:
    """The smallest proportional gain with a lasting oscillation (dimensionless), and the oscillation's period, s."""

    gain: float
    period: float

    def pid_gains(self) -> dict[str, float]:
        r"""Return the gains ``kp`` (1), ``ki`` (1/s) and ``kd`` (s).

        .. math:: K_p = 0.6 K_c, \quad K_i = 2 K_p / P_c, \quad K_d = K_p P_c / 8

        Source: thesis 5.2.1.3; Ziegler & Nichols (1942), Transactions of the ASME 64, 759-768.
        """
        kp = 0.6 * self.gain
        return {"kp": kp, "ki": 2 * kp / self.period, "kd": kp * self.period / 8}
