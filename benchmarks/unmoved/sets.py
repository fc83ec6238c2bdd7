"""Sets of logs that are diagnosed before and after a change: twelve, or sixty of the ledgers' cases.

Each is made by programs that share no code with hjcamp.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from truth.pump_joint.case import write_case
from truth.servo.case import write_servo_case
from truth.tanks.case import write_tanks_case

from benchmarks.any_plant import running as any_plant
from benchmarks.foreign_machines import accumulator, heater, hysteretic, inductor, oven, shaft
from benchmarks.foreign_machines.__main__ import MACHINES
from benchmarks.hidden_effects import cases as hidden_effects_cases

SEED = 90001


@dataclass(frozen=True)
class LogSet:
    """One set of logs: what it stands for, and the function that writes it into a folder."""

    name: str
    about: str
    write: Callable[[Path], Path]
    imported: bool = True  # from CSV files, as a user would; the joint's logs are written as they are
    options: tuple[str, ...] = ("--effort", "quick")


def _joint(name: str, about: str, effects: tuple[str, ...], seed: int) -> LogSet:
    def write(folder: Path) -> Path:
        return write_case(folder / "logs", effects, "medium", seed, repetitions=2)

    return LogSet(name, about, write, imported=False)


def _other(
    name: str, about: str, write: Callable[..., Path], effect: str, form: str, one_log: bool, strength: str = "1"
) -> LogSet:
    return LogSet(name, about, partial(write, effect=effect, form=form, seed=SEED, one_log=one_log, strength=strength))


SETS = (
    _joint("joint_nothing", "nothing missing, dry friction", (), 791001),
    _joint("joint_leakage", "an effect of the lines", ("leakage",), 791002),
    _joint("joint_position_friction", "an effect of the contact", ("position_friction",), 791003),
    _joint("joint_encoder_lag", "an effect of a sensor", ("encoder_lag",), 791004),
    _other("heater_nothing", "a store, no contact, repetitions", heater.MACHINE.write, "nothing", "nothing", False),
    _other("inductor_dead_band", "a drive that bends, one log", inductor.MACHINE.write, "dead_band", "crossover", True),
    _other("oven_sensor_lag", "a memory in a sensor, repetitions", oven.MACHINE.write, "sensor_lag", "sheath", False),
    _other("shaft_saturation", "a rotor, one log", shaft.MACHINE.write, "saturation", "tanh", True),
    _other("accumulator_gas", "outside the library", accumulator.MACHINE.write, "gas", "warming", False),
    _other("hysteretic_nothing", "nothing missing, one log", hysteretic.MACHINE.write, "nothing", "nothing", True),
    _other("tanks_spill_over", "two stores, repetitions", write_tanks_case, "spill_over", "weir", False, "medium"),
    _other("servo_nothing", "a contact in a controller's loop", write_servo_case, "nothing", "nothing", False, "medium"),
)


def listed() -> list[LogSet]:
    """Return the cases of the ledgers that `long_list.txt` names, diagnosed with the effort that the ledgers have."""
    rows = Path(__file__).with_name("long_list.txt").read_text(encoding="utf-8").splitlines()
    return [_case(*row.split()) for row in rows if not row.startswith("#")]


def _case(ledger: str, name: str) -> LogSet:
    effort = ("--effort", "standard")
    if ledger == "hidden_effects":
        case = next(one for one in hidden_effects_cases.plan("full", shift=700_000) if one.name == name)
        without = ("--without", ",".join(case.without)) if case.without else ()

        def write(folder: Path) -> Path:
            strength = case.strength or "medium"
            return write_case(folder / "logs", case.effects, strength, case.seed, contact=case.contact, form="random")

        return LogSet(name, ledger, write, imported=False, options=(*effort, *without))
    plant, effect, form, seed, logs = name.split("/")
    known = {"any_plant": {plant: one[0] for plant, one in any_plant.MACHINES.items()}}
    known["foreign_machines"] = {plant: one.write for plant, one in MACHINES.items()}
    strength = {"any_plant": "medium", "foreign_machines": "1"}[ledger]
    chosen = partial(known[ledger][plant], effect=effect, form=form, seed=int(seed), one_log=logs == "one", strength=strength)
    return LogSet(name.replace("/", "-"), ledger, chosen, options=effort)
