"""A hidden case on the linear axis: one long log and one held out, or six conditions with three repetitions each."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from truth.axis.hidden import FORMS, Use
from truth.axis.plant import Axis, run
from truth.case_files import MeasuredLog, rough, write_case_files
from truth.contact import CONTACTS
from truth.hidden_form import NOTHING, Form, find_form, level_of
from truth.moves import SAMPLE, Course, fluctuation, mixed, pulses

ONE_LOG_S, HELD_OUT_S, TEST_S = 25.0, 20.0, 4.0
CONDITIONS = ("creep", "middle", "fast", "swing", "quick_swing", "steps_pulses")
LOADED = ("creep", "fast", "swing")
FIELDS = {"time_s": "t_s", "position_m": "q_m", "voltage_v": "u_v", "reference_position_m": "q_ref_m"}
SOURCE = '''"""A carriage that a motor pushes along its guide; the drive's own loop holds its position."""

from __future__ import annotations

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, contact, outside, sensor{more}


class Axis(Plant):
    r"""A motor pushes a carriage along its guide.

    .. math:: M \\dot v = g\\,u - F_c\\,\\mathrm{{sign}}\\,v - F_v\\,v
    """

    position = State("m", typical={stroke:.1g})
    velocity = State("m/s", typical={speed:.1g})

    voltage = Input("V", text="drive voltage as logged")

    gain = Parameter("N/V", {gain:.6g}, text="from the maker's data")
    mass = Parameter("kg", {mass:g}, ({mass_low:g}, {mass_high:g}), base=True, text="moving mass")
{friction}
    position_m = Measured("encoder", of="position")
    loop = "foreign"

    @staticmethod
    def equations(state, parameter, drive, rate):
        """The motor's force against friction and inertia."""
        force = actuator(parameter.gain * drive.voltage)
        load = outside("N")
        friction = contact(
            state.velocity,
            push=force + load,
            coulomb={coulomb},
            viscous={viscous},
            travel=state.position,
        )
        rate.position = state.velocity
        rate.velocity = body(force + load - friction, mass=parameter.mass, load=load, position=state.position)
        {sensor}
'''


@dataclass(frozen=True)
class AxisCase:
    """An axis with what hides in it, and how it is used; `paired` where the user's plant has friction by direction."""

    axis: Axis
    plain: Axis
    use: Use
    form: Form[tuple[Axis, Use]]
    seed: int
    paired: bool


def draw_axis(seed: int, one_log: bool, contact: str | None = None, paired: bool = False) -> tuple[Axis, Use]:
    """Draw an axis and its use from the seed: motor of 80 - 600 N, 8 - 30 cm/s, friction 4 - 10 % of the motor's force."""
    if contact is not None and contact not in CONTACTS:
        raise ValueError(f"contact {contact!r}: known are {', '.join(CONTACTS)}")
    random = np.random.default_rng([seed, 301])
    gain = float(np.exp(random.uniform(np.log(8), np.log(60))))
    most = 10 * gain
    speed = float(np.exp(random.uniform(np.log(0.08), np.log(0.3))))
    acceleration, stroke = float(random.uniform(0.6, 1.6)), float(random.uniform(0.18, 0.4))
    mass = float(random.uniform(0.25, 0.45)) * most / acceleration
    coulomb, viscous = float(random.uniform(0.04, 0.10)) * most, float(random.uniform(0.03, 0.08)) * most / speed
    tilts = random.uniform(-0.25, 0.25, 2) if paired else np.zeros(2)
    band = float(random.uniform(45, 75))
    kv = band * mass / gain
    count = float(random.choice([1e-7, 2.5e-7, 5e-7, 1e-6]))
    drawn = int(random.integers(len(CONTACTS)))
    law = CONTACTS.index(contact) if contact else drawn
    grains = (1.0, float(random.uniform(2e-3, 5e-3)) * speed, 3e-6, 3e-6)
    axis = Axis(
        mass=mass,
        gain=gain,
        coulomb_positive=coulomb * (1 + tilts[0]),
        coulomb_negative=coulomb * (1 - tilts[0]),
        viscous_positive=viscous * (1 + tilts[1]),
        viscous_negative=viscous * (1 - tilts[1]),
        law=float(law),
        grain=grains[law] * float(random.uniform(0.7, 1.3)),
        kp=band / 6,
        kv=kv,
        ki=kv * band / 8,
        difference_time=2e-3,
        current_lag=float(random.uniform(2e-4, 6e-4)),
        late_samples=float(random.integers(2)),
        count=count,
        converter_volt=float(random.choice([20 / 2**12, 20 / 2**14, 20 / 2**16])),
    )
    return axis, Use(stroke, speed, acceleration, ONE_LOG_S if one_log else TEST_S)


def build_axis_case(
    effect: str = "nothing",
    form: str | None = None,
    seed: int = 0,
    one_log: bool = True,
    strength: str | float = "medium",
    contact: str | None = None,
) -> AxisCase:
    """Draw an axis and hide the effect in it; see `write_axis_case`. Raises ValueError for what is not known."""
    level = level_of(strength)
    chosen = find_form(FORMS, effect, form, seed)
    coin = np.random.default_rng([seed, 303]).random()
    # where the user's model has friction by direction, an asymmetry or a steady force would be its own
    paired = bool(coin < 0.35) and effect not in ("asymmetry", "constant_force")
    axis, use = draw_axis(seed, one_log, contact, paired)
    # the same draw for every strength of an effect, so that strengths differ in amplitude alone
    random = np.random.default_rng([seed, 309])
    changes = chosen.build((axis, use), level, random)
    return AxisCase(axis._replace(**changes), axis, use, chosen, seed, paired)


def condition_reference(name: str, use: Use, random: np.random.Generator) -> tuple[np.ndarray, float]:
    """Return the reference of a condition (m at 1 kHz) and the size of its voltage pulses, as a share of 10 V."""
    course = Course(use.stroke, use.speed, use.acceleration)
    end = 0.45 * use.stroke * float(random.uniform(0.85, 1.0))
    shares = {"creep": 0.06, "middle": 0.4, "fast": 0.95, "steps_pulses": 0.3}
    if "swing" in name:
        frequency = 0.6 if name == "swing" else 2.0
        turn = 2 * np.pi * frequency
        course.swing(frequency, min(0.8 * use.speed / turn, use.acceleration / turn**2, 0.22 * use.stroke), 20)
    while course.samples < TEST_S / SAMPLE:
        side = -1.0 if course.place > 0 else 1.0
        if name == "steps_pulses":
            course.move(course.place + side * 0.1 * end, shares[name])
            course.hold(0.3)
        else:
            course.move(side * end, shares[name] * float(random.uniform(0.9, 1.1)), 1.2)
    return course.reference(round(TEST_S / SAMPLE)), 0.08 if name == "steps_pulses" else 0.0


def simulate_axis(axis: Axis, use: Use, seed: int, log: str, repetition: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Return time (n,) and rows (n, 5) of `axis.run` in one log: "train", "held_out", or a condition's name.

    What scatters is drawn from seed, log and repetition, and does not depend on what hides in the axis.
    """
    if log in ("train", "held_out"):
        number = ("train", "held_out").index(log)
        random = np.random.default_rng([seed, 305, number])
        duration = (ONE_LOG_S, HELD_OUT_S)[number]
        wanted = mixed(use.stroke, use.speed, use.acceleration, duration, random)
        share = 0.08 if log == "held_out" else 0.0
    else:
        number = 2 + CONDITIONS.index(log)
        random = np.random.default_rng([seed, 305, number])
        wanted, share = condition_reference(log, use, random)
    chance = np.random.default_rng([seed, 307, number, repetition])
    volts = pulses(wanted.size, 10 * share, random) if share else np.zeros(wanted.size)
    drawn = fluctuation(wanted.size, chance)
    rows = run(axis, wanted, volts, drawn.profile, drawn.wander, drawn.counted)
    return np.arange(wanted.size) * SAMPLE, rows


def write_axis_case(
    folder: Path | str,
    effect: str = "nothing",
    form: str | None = None,
    seed: int = 0,
    one_log: bool = True,
    *,
    strength: str | float = "medium",
    contact: str | None = None,
) -> Path:
    """Write a hidden case on a linear axis into `folder` and return the path of its sealed answer, `truth.json`.

    `effect` is "nothing" or one in `axis_hidden.FORMS`, `form` one of its forms (drawn by the seed where None),
    `strength` weak, medium, strong or a factor, `contact` one of `contact.CONTACTS` (drawn where None). With `one_log`
    there are `measured/train.csv` (25 s, nothing repeated) and `heldout/held_out.csv` (20 s, with voltage pulses), else
    six conditions of 4 s with three repetitions each and the same held-out log. Files: see `write_case_files`; then, in
    the folder, `hjcamp import measured/*.csv --map import.yaml --into logs` and `hjcamp diagnose logs`.

    The answer has `verdict`, `effects` (right names), `alike` (names that these logs cannot tell from it, honest in a
    `one_of`), `drivers` (what an "outside_library" may name), `form_in_library`, `changes` (hidden fields, SI), `base`
    (in the user's parameters) and `seen` (by how much the hidden effect changes the voltage, beside what scatters).
    """
    case = build_axis_case(effect, form, seed, one_log, strength, contact)
    plan = [("train", 0)] if one_log else [(name, k) for name in CONDITIONS for k in range(3)]
    logs, seen = [], []
    for name, repetition in [*plan, ("held_out", 0)]:
        axis = case.axis
        metadata = {"condition": name}
        if not one_log:
            metadata["repetition"] = str(repetition + 1)
            if case.form.name == "placed":
                loaded = name in LOADED or name == "held_out"
                axis = axis._replace(placed_mass=axis.placed_mass if loaded else 0.0, placed_at=0.0)
                metadata["load"] = "block" if loaded else "none"
        time, rows = simulate_axis(axis, case.use, seed, name, repetition)
        columns = dict(zip(FIELDS.values(), (time, *rows.T[:3]), strict=True))
        file = name if one_log or name == "held_out" else f"{name}_{repetition + 1}"
        logs.append(MeasuredLog(file, columns, metadata, name == "held_out"))
        if name != "held_out" and repetition == 0:
            seen.append(_seen(case, axis, name, rows))
    answer = {
        "plant": "axis",
        **case.form.answer(),
        "strength": strength,
        "contact": CONTACTS[int(case.axis.law)],
        "one_log": one_log,
        "seed": seed,
        "changes": {k: v for k, v in case.axis._asdict().items() if v != getattr(case.plain, k)},
        "base": base_parameters(case),
        "seen": dict(zip(("change_v", "scatter_v"), (float(np.sqrt(np.mean(x))) for x in np.transpose(seen)), strict=True)),
    }
    return write_case_files(folder, "axis", plant_source(case), FIELDS, logs, answer)


def _seen(case: AxisCase, axis: Axis, name: str, rows: np.ndarray) -> tuple[float, float]:
    """Return the mean square of the voltage's change by what hides, and by another draw of the scatter."""
    if case.form is NOTHING:
        plain = rows
    else:
        plain = simulate_axis(case.plain, case.use, case.seed, name)[1]
    again = simulate_axis(case.plain, case.use, case.seed, name, 99)[1]
    return float(np.mean((rows[:, 1] - plain[:, 1]) ** 2)), float(np.mean((again[:, 1] - plain[:, 1]) ** 2))


def base_parameters(case: AxisCase) -> dict[str, float]:
    """Return the true values of the parameters of the user's plant."""
    axis = case.plain
    names = [f"{kind}_{side}" for kind in ("coulomb", "viscous") for side in ("positive", "negative")]
    if not case.paired:
        return {"mass": axis.mass, "coulomb": axis.coulomb_positive, "viscous": axis.viscous_positive}
    return {"mass": axis.mass, **{name: getattr(axis, name) for name in names}}


def plant_source(case: AxisCase) -> str:
    """Return the file that a user of this axis would write: guesses of one digit, wide bounds, the maker's gain."""
    random = np.random.default_rng([case.seed, 311])
    axis = case.plain
    mass = rough(axis.mass, random)
    coulomb, viscous = rough(axis.coulomb_positive, random), rough(axis.viscous_positive, random)
    lines = []
    for kind, unit, guess in (("coulomb", "N", coulomb), ("viscous", "N*s/m", viscous)):
        for name in (f"{kind}_positive", f"{kind}_negative") if case.paired else (kind,):
            text = f"{kind.title() if kind == 'coulomb' else kind} friction"
            side = f", {name.partition('_')[2]} direction" if case.paired else ""
            low = 1e-2 * guess if kind == "coulomb" else 0.0
            lines.append(
                f'    {name} = Parameter("{unit}", {guess:g}, ({low:g}, {20 * guess:g}), base=True, text="{text}{side}")'
            )
    played = case.form.effect == "backlash" or np.random.default_rng([case.seed, 313]).random() < 0.3
    pair = "(parameter.{0}_positive, parameter.{0}_negative)" if case.paired else "parameter.{0}"
    values: dict[str, Any] = {
        "more": ", transmission" if played else "",
        "sensor": "head = transmission(state.position)\n        encoder = sensor(head)"
        if played
        else "encoder = sensor(state.position)",
        "stroke": 0.3 * case.use.stroke,
        "speed": 0.5 * case.use.speed,
        "gain": axis.gain,
        "mass": mass,
        "mass_low": 0.05 * mass,
        "mass_high": 20 * mass,
        "friction": "\n".join(lines) + "\n",
        "coulomb": pair.format("coulomb"),
        "viscous": pair.format("viscous"),
    }
    return SOURCE.format(**values)
