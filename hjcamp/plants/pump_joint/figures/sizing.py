"""The figures of chapter 3, 4.4.3 and 5.6.5 drawn from the formulas of `hjcamp.plants.pump_joint.sizing`."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.plants.pump_joint.sizing import actuators, pulley, tubing
from hjcamp.plants.pump_joint.sizing.compliance import pressure_against_volume
from hjcamp.plants.pump_joint.sizing.linkage import SixBar
from hjcamp.plants.pump_joint.sizing.muscle import muscle_with_crossing
from hjcamp.report.pictures.conditions import BLUE, GREEN, INK, RED, own_settings
from hjcamp.report.pictures.drawing import dress
from hjcamp.storage import whole_file

Array = NDArray[np.float64]
BORE, SHAFT, LENGTH = 10e-3, 2e-3, 50e-3  # thesis 3.3.1, 3.3.2
CYLINDER_BORE, STROKE = 4e-3, 20e-3  # thesis 3.4
PRESSURES_MPA = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
STRING_RADIUS, STRING_TENSION, STRING_TURNS = 3.41e-3, 0.19, 2.5  # thesis 3.6.3
SENSOR_RANGE_MPA = 0.689  # thesis 3.9
INNER, OUTER, POISSON, WATER = 2.69e-3, 3.99e-3, 0.4, 2150e6  # thesis 4.4
LDPE, HDPE = 300e6, 2000e6
STIFF = 0.15e15  # Pa/m^3, thesis 5.6
DASHED = (0, (4, 2.5))
DASH_DOT = (0, (6, 2, 1, 2))
SHADES = (BLUE, GREEN, RED, INK)


def vane_and_cylinder(figure: Any) -> None:
    """Figure 3.3.3's comparison against length: area, seal length, torque of a vane and a cylinder in one bore."""
    length = np.linspace(10e-3, 60e-3, 101)
    area, seal, torque = figure.subplots(3, 1, sharex=True)
    mm = length * 1e3
    area.plot(mm, actuators.double_vane_area(BORE, SHAFT, length) * 1e6, color=BLUE, label="double vane")
    area.axhline(actuators.cylinder_area(BORE) * 1e6, color=RED, linestyle=DASH_DOT, label="rodless cylinder")
    dress(area, "Area under pressure (mm²)")
    area.legend(fontsize=8, frameon=False)
    seal.plot(mm, actuators.double_vane_seal(BORE, SHAFT, length) * 1e3, color=BLUE)
    seal.axhline(actuators.cylinder_seal(BORE) * 1e3, color=RED, linestyle=DASH_DOT)
    dress(seal, "Seal length (mm)")
    torque.plot(mm, actuators.vane_torque(0.3e6, 2.0, BORE, SHAFT, length) * 1e3, color=BLUE)
    dress(torque, "Vane torque at\n0.3 MPa (mNm)")
    for axes in (area, seal, torque):
        axes.axvline(LENGTH * 1e3, color=INK, linewidth=0.6, linestyle=DASHED)
        axes.set_ylim(bottom=0.0)
    torque.set_xlabel("Length l (mm); bore 10 mm, shaft 2 mm; dashed: the 50 mm of the text", fontsize=8.5)


def muscle_and_cylinder(figure: Any) -> None:
    """Figure 3.4.1: force against contraction of a braided muscle (solid) and a cylinder (dash-dot) at equal pressures."""
    axes = figure.subplots()
    muscle = muscle_with_crossing(60e-3, 5e-3, 0.25e-3, CYLINDER_BORE, 8e-3)
    travel = np.linspace(0.0, muscle.longest_contraction(), 200)
    for pressure in PRESSURES_MPA:
        (line,) = axes.plot(travel * 1e3, muscle.area(travel) * pressure * 1e6, color=BLUE)
        force = actuators.cylinder_force(pressure * 1e6, CYLINDER_BORE)
        (other,) = axes.plot([0.0, STROKE * 1e3], [force, force], color=RED, linestyle=DASH_DOT)
        axes.annotate(f"{pressure:g} MPa", (STROKE * 1e3, force), (3, 0), textcoords="offset points", fontsize=7.5, va="center")
    axes.legend([line, other], ["braided muscle, 60 mm", "cylinder, 4 mm bore"], fontsize=8, frameon=False)
    axes.axvline(8.0, color=INK, linewidth=0.6, linestyle=DASHED)
    axes.annotate("equal at 8 mm", (8.0, 0.2), (4, 0), textcoords="offset points", fontsize=7.5)
    axes.set(xlim=(0.0, 22.5), ylim=(0.0, None))
    dress(axes, "Force (N), no friction")
    axes.set_xlabel("Contraction or travel (mm)", fontsize=8.5)


def six_bar(figure: Any) -> None:
    """Figure 3.5.3: joint angle against piston travel with the line of +-40 deg, pressure angle, mirrored loops below."""
    bar = SixBar()
    angle = np.radians(np.linspace(-70.0, 70.0, 281))
    travel = bar.travel(angle) * 1e3
    over, pressure, volume = figure.subplots(3, 1, sharex=True, height_ratios=[1.6, 1.0, 0.8])
    slope, offset = bar.best_line(math.radians(40.0))
    ends = bar.travel(np.radians([-40.0, 40.0]))
    over.plot(travel, np.degrees(angle), color=BLUE, label="six-bar")
    straight = np.array([travel[0], travel[-1]]) * 1e-3
    worst = math.degrees(bar.worst_of_line(math.radians(40.0)))
    label = f"line of ±40 deg, {math.degrees(slope) * 1e-3:.1f} deg/mm, off by at most {worst:.1f} deg"
    over.plot(straight * 1e3, np.degrees(slope * straight + offset), color=RED, linestyle=DASHED, label=label)
    over.legend(fontsize=8, frameon=False, loc="upper left")
    dress(over, "Joint angle (deg)")
    gamma = np.degrees(bar.pressure_angle(angle))
    pressure.plot(travel, gamma, color=BLUE)
    low, high = bar.usable_range()
    for limit in (-45.0, 45.0):
        pressure.axhline(limit, color=INK, linewidth=0.6, linestyle=DASHED)
    pressure.annotate(
        f"within 45 deg: {math.degrees(low):.1f} to {math.degrees(high):.1f} deg of the joint",
        (0.45, 0.06),
        xycoords="axes fraction",
        fontsize=7.5,
        va="bottom",
    )
    dress(pressure, "Pressure angle (deg)")
    volume.plot(travel, bar.common_volume(angle, CYLINDER_BORE) * 1e9, color=BLUE)
    dress(volume, "Volume of both cyl-\ninders, change (mm³)")
    for axes in (over, pressure, volume):
        axes.axvspan(ends[0] * 1e3, ends[1] * 1e3, color=GREEN, alpha=0.12, linewidth=0.0)
    volume.set_xlabel("Piston travel (mm); shaded: ±40 deg of the joint; below: second loop as mirror image", fontsize=8.5)


def string_torque(figure: Any) -> None:
    """The largest torque of the string against its turns, for friction coefficients of 0.1 to 0.3."""
    axes = figure.subplots()
    turns = np.linspace(0.5, 4.0, 141)
    for number, friction in enumerate((0.1, 0.15, 0.22, 0.3)):
        torque = [pulley.largest_torque(STRING_TENSION, one, friction, STRING_RADIUS) * 1e3 for one in turns]
        axes.plot(turns, torque, color=SHADES[number], label=f"μ = {friction:g}")
    axes.axhline(20.0, color=INK, linewidth=0.6, linestyle=DASHED)
    axes.axvline(STRING_TURNS, color=INK, linewidth=0.6, linestyle=DASHED)
    axes.set_yscale("log")
    axes.legend(fontsize=8, frameon=False)
    dress(axes, "Largest torque (mNm)")
    axes.set_xlabel(f"Turns of the string; tension {STRING_TENSION:g} N; dashed: 20 mNm at 2.5 turns", fontsize=8.5)


def line_pressure(figure: Any) -> None:
    """Figure 4.4.3: pressure against volume pushed in, for lengths of 150 to 600 mm and air of 0 to 1 %."""
    axes = figure.subplots()
    wall = tubing.tubing_modulus(INNER, OUTER, LDPE, POISSON)
    for number, length in enumerate((150e-3, 300e-3, 600e-3)):
        volume = tubing.tubing_volume(INNER, length)
        for air, style in ((0.0, "-"), (0.001, DASH_DOT), (0.005, DASHED), (0.01, (0, (1, 1.5)))):
            pushed, pressure = pressure_against_volume(volume, WATER, wall, air, SENSOR_RANGE_MPA * 1e6)
            label = f"{length * 1e3:g} mm, {air * 100:g} % air"
            axes.plot(pushed * 1e9, pressure * 1e-6, color=SHADES[number], linestyle=style, label=label)
    axes.axhline(0.1, color=INK, linewidth=0.6, linestyle=DASHED)
    axes.legend(fontsize=7.5, edgecolor="none", framealpha=1.0, loc="lower right")
    axes.set(xlim=(0.0, None), ylim=(0.0, None))
    dress(axes, "Pressure (MPa gauge)")
    axes.set_xlabel("Volume pushed in from 0 MPa gauge (mm³), LDPE; dashed: 0.1 MPa", fontsize=8.5)


def stiff_line_pressure(figure: Any) -> None:
    """Figure 5.6.5: the same for high density polyethylene with 0.5 % of air."""
    axes = figure.subplots()
    volume = tubing.tubing_volume(INNER, 300e-3)
    for colour, name, modulus in ((BLUE, "HDPE", HDPE), (RED, "LDPE", LDPE)):
        wall = tubing.tubing_modulus(INNER, OUTER, modulus, POISSON)
        pushed, pressure = pressure_against_volume(volume, WATER, wall, 0.005, 1.0e6)
        axes.plot(pushed * 1e9, pressure * 1e-6, color=colour, label=f"{name}, 0.5 % air, 4.4.3.14")
    wall = tubing.tubing_modulus(INNER, OUTER, HDPE, POISSON)
    pushed, pressure = pressure_against_volume(volume, WATER, wall, 0.005, 1.0e6)
    start, more = float(np.interp(0.5e6, pressure, pushed)), np.array([0.0, 0.5e6])
    label = "printed above 0.5 MPa: 0.15 MPa/mm³"
    axes.plot((start + more / STIFF) * 1e9, 0.5 + more * 1e-6, color=INK, linestyle=DASHED, label=label)
    axes.legend(fontsize=8, frameon=False)
    axes.set(xlim=(0.0, None), ylim=(0.0, None))
    dress(axes, "Pressure (MPa gauge)")
    axes.set_xlabel("Volume pushed in from 0 MPa gauge (mm³), 300 mm", fontsize=8.5)


Figures = Mapping[str, tuple[tuple[float, float], Callable[[Any], None]]]

#: File name: (size in inches, what draws it).
FIGURES: Figures = {
    "figure_3_3_3": ((6.4, 7.0), vane_and_cylinder),
    "figure_3_4_1": ((6.4, 4.4), muscle_and_cylinder),
    "figure_3_5_3": ((6.4, 7.6), six_bar),
    "string_torque": ((6.4, 4.4), string_torque),
    "figure_4_4_3": ((6.4, 5.2), line_pressure),
    "figure_5_6_5": ((6.4, 4.4), stiff_line_pressure),
}


def draw_figures(folder: Path, suffix: str = ".png", figures: Figures = FIGURES) -> list[Path]:
    """Write every figure into ``folder``, each whole or not at all; returns their paths."""
    from matplotlib.figure import Figure

    found = []
    for name, (size, paint) in figures.items():
        path = folder / f"{name}{suffix}"
        with own_settings():
            figure = Figure(figsize=size, layout="constrained")
            paint(figure)
            for axes in figure.axes:
                axes.margins(x=0.02)
            with whole_file(path) as stream:
                figure.savefig(stream, dpi=150, format=suffix[1:])
        found.append(path)
    return found
