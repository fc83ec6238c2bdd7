"""How far the arm gives way under a force while the pump stands: compliances of lines and string (thesis 4.4.3, 4.5)."""

from __future__ import annotations

from collections.abc import Mapping


def line_compliances(
    volume: float, water: float, tubing: float, air_fraction: float, absolute_pressure: float
) -> dict[str, float]:
    r"""Return what water, wall and air of a line give way for a pascal, m^3/Pa; in series, so they add.

    .. math:: \frac{dV}{dp} = \frac{V}{\beta_w} + \frac{V}{\beta_p} + \frac{V S}{p}

    SI units, p absolute. Source: thesis 4.4.3.13 and 4.4.3.14, term by term.
    """
    return {"water": volume / water, "wall": volume / tubing, "air": volume * air_fraction / absolute_pressure}


def line_share(stiffness: float, joint_area: float) -> float:
    r"""Return the stiffness that one locked line gives the sliders, N/m: K A_2^2.

    ``stiffness`` is dp/dV, Pa/m^3. Source: thesis 4.4.3.15 with the pump at rest.
    """
    return stiffness * joint_area**2


def locked_stiffness(first: float, second: float, joint_area: float, further_compliance: float = 0.0) -> float:
    r"""Return the static stiffness at the sliders with the pump at rest, N/m.

    .. math:: \frac{1}{k} = \frac{1}{(K_1 + K_2) A_2^2} + c

    The lines act side by side, since one is compressed as the other is let go; string and other parts (``further_compliance``,
    m/N) come in series. Valid while neither line parts, and beyond dry friction. Source: thesis 4.4.3.15, 4.4.3.16.
    """
    return 1.0 / (1.0 / (line_share(first, joint_area) + line_share(second, joint_area)) + further_compliance)


def arm_stiffness(slider_stiffness: float, pulley_radius: float) -> float:
    """Return the stiffness at the arm, N m/rad: k r_p^2. Source: thesis 3.6.4."""
    return slider_stiffness * pulley_radius**2


def shares(parts: Mapping[str, float]) -> dict[str, float]:
    """Return each part over the sum of all."""
    whole = sum(parts.values())
    return {name: one / whole for name, one in parts.items()}
