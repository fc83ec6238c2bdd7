"""Seven slips of the thesis's text: what it says, and what its own numbers give."""

from __future__ import annotations

import math
from dataclasses import dataclass

from hjcamp.plants.pump_joint.published.values import constants
from hjcamp.plants.pump_joint.sizing import dynamics, pulley

STEEL_GPA = 160.0
OIL_GPA = 1.6


@dataclass(frozen=True)
class Slip:
    """One slip: where, what the text says, what follows from its numbers, and the arithmetic."""

    place: str
    says: str
    follows: str
    arithmetic: str


def worse_than_sliding_mode() -> dict[str, tuple[float, float]]:
    """Return the rows of Table 6.3.1 in which PID alone has the larger RMSE: (PID, earlier sliding mode), deg."""
    rows = constants()["table_6_3_1"]["rmse1"]
    return {name: (row["pid"], row["sliding_mode"]) for name, row in rows.items() if row["pid"] > row["sliding_mode"]}


def fastest_bandwidth() -> float:
    """Return the -3 dB frequency in Hz of pump 2 with the high gain amplifier (4.3.4), the pump of chapter 5."""
    one = constants()["pump_transfer_functions"]["pump2_high_gain"]
    return dynamics.bandwidth(one["a2"], one["a1"], one["a0"])


def mass_increase() -> tuple[float, float]:
    """Return by how many percent the payload raises the effective mass: the payload alone, and the whole over the old."""
    old, payload = constants()["effective_mass_g"]["total"], constants()["payload"]["effective_mass_g"]
    return 100.0 * payload / old, 100.0 * (payload + old) / old


def water_modulus() -> float:
    """Return the bulk modulus of water in GPa (4.4.3)."""
    return constants()["water"]["bulk_modulus_mpa"] * 1e-3


def oil_modulus_if_true() -> float:
    """Return the bulk modulus in GPa that oil would have if it were 300 times less compressible than water."""
    return 300.0 * water_modulus()


def least_string_tension() -> float:
    """Return the tension in N that 20 mNm needs on the pulley (3.6.3)."""
    given = constants()["geometry"]
    radius = 0.5e-3 * given["pulley_pitch_diameter_mm"]
    return pulley.least_tension(20e-3, given["string_turns"], given["string_friction_coefficient"], radius)


def deg_per_mm_of_rack() -> list[float]:
    """Return the arm's degrees per mm of the earlier rack, from the four pairs of numbers in 2.4 and Table 6.3.1."""
    table = constants()["table_6_3_1"]
    sine, cycloid = table["rmse1"]["sine_0p5hz"], table["sse"]["cycloid_pos"]
    return [60.0 / 5.0, sine["pva"] / 0.25, sine["sliding_mode"] / 0.14, cycloid["sliding_mode"] / 0.07]


def slips() -> list[Slip]:
    """Return the seven slips with their arithmetic."""
    worse = ", ".join(f"{name} {pid:g} against {other:g}" for name, (pid, other) in worse_than_sliding_mode().items())
    alone, whole = mass_increase()
    ratios = deg_per_mm_of_rack()
    rack, pulleys = sum(ratios) / len(ratios), 360.0 / (math.pi * constants()["geometry"]["pulley_pitch_diameter_mm"])
    return [
        Slip(
            "6.3",
            "a significant improvement over the earlier joint",
            "of FFWD + PID only: PID alone has the larger RMSE in three of four rows",
            f"{worse} deg (PID against sliding mode, Table 6.3.1)",
        ),
        Slip(
            "5.3, footnote",
            "the bandwidth of the pump motor is 18 Hz",
            f"{fastest_bandwidth():.1f} Hz at -3 dB",
            "the transfer function 4.3.4, without its delay",
        ),
        Slip(
            "5.5",
            "the effective mass grows by about 1480 %",
            f"by {alone:.0f} %; {round(whole, -1):.0f} % would be the new mass over the old one, neither is 1480 %",
            "292 g over 18.5 g; (292 + 18.5) g over 18.5 g; 1480 % is (292 - 18.5) g over 18.5 g",
        ),
        Slip(
            "4.4.3",
            "hydraulic oils are more than 300 times less compressible than water",
            f"that would be a bulk modulus of {oil_modulus_if_true():.0f} GPa, {oil_modulus_if_true() / STEEL_GPA:.0f} times that "
            f"of steel; mineral oil has about {OIL_GPA:g} GPa and is {water_modulus() / OIL_GPA:.1f} times more compressible",
            "300 x 2150 MPa; steel about 160 GPa, mineral oil about 1.6 GPa (handbook values)",
        ),
        Slip(
            "3.6.3",
            "T_1 comes out as 0.19 N, the sentence below says T_1 >> 0.3 N",
            f"{least_string_tension():.2f} N; 0.3 N follows from nothing in the text",
            f"20 mNm/(3.41 mm (e^(0.22 x 15.7) - 1)); 0.3 N would carry {20 * 0.3 / least_string_tension():.0f} mNm",
        ),
        Slip(
            "2.4 and 6.3",
            "errors of the earlier joint in mm of its rack, then in deg of its arm",
            f"{rack:.1f} deg/mm, the earlier pinion's (pitch radius {180 / math.pi / rack:.2f} mm), not the pulley's "
            f"{pulleys:.1f} deg/mm",
            "60/5, 3.00/0.25, 1.69/0.14 and 0.85/0.07 deg/mm: " + ", ".join(f"{one:.1f}" for one in ratios),
        ),
        Slip(
            "caption of Figure 5.2.5",
            "the test shown in Figure 4.2.3",
            "Figure 5.2.3, as the sentence above the figure says; chapter 4.2 has no third figure and no test",
            "figure numbers carry their section: the test of 5.2.5 is one of section 5.2",
        ),
    ]
