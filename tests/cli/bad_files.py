"""The folder in which bad calls are made, and what is done to its files: a file of each kind, each damaged."""

from __future__ import annotations

import json
import os
import random
import re
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

Damage = Callable[[Path, random.Random], None]
LOG = "run/logs/ramp_pos__pid/rep_01.mcap"
CONTROLLER = '''"""A proportional law."""

from hjcamp.controllers.controller import Controller
from hjcamp.model.declare.parameter import Parameter


class Mine(Controller):
    """The error times a gain."""

    gain = Parameter("1", 8.0, (0.0, 100.0), text="gain")

    @staticmethod
    def step(sample, parameter, memory):
        """Return the command."""
        return parameter.gain * (sample.reference - sample.arm), 0.0
'''
TRAJECTORY = '''"""A constant speed."""

from hjcamp.trajectories import Trajectory
from hjcamp.trajectories.laws import linear, rise


class Slope(Trajectory):
    """Constant speed to an angle."""

    amplitude: float
    rise_time: float

    def motion(self, time):
        """Return the motion."""
        return rise(linear, time, self.rise_time, self.amplitude)

    @property
    def end_of_motion(self):
        """The end."""
        return self.rise_time
'''
TEXTS = {
    "conf/model/mine.yaml": "name: mine\nparameters: {line_stiffness: 2.4e+13}\neffects: {}\n",
    "conf/model/broken.yaml": "name: broken\nparameters: {line_stiffness: abc}\neffects: [1]\n",
    "conf/pump/own.yaml": "defaults: [pump2, _self_]\nname: own\nbore_mm: 6.4\n",
    "conf/payload/own.yaml": "# @package _global_\npayload: {name: own, mass_g: 9.0, radius_mm: 20.0}\n"
    "effects: {payload_inertia: {load_mass: 0.009, radius: 0.02}}\n",
    "conf/rig/own.yaml": "defaults: [virtual, _self_]\nname: own\nlimits: {arm_deg: 150.0}\n",
    "conf/trajectory/own.yaml": "name: own\nkind: slope\namplitude: 0.5\nrise_time: 0.2\nduration: 1.0\n",
    "conf/controller/own.yaml": "name: mine\nmodel: published\ngain: 8.0\n",
    "conf/controller/gains/own.yaml": "# @package controller\npositive: {kp: 1.03, ki: 47.0, kd: 0.015}\n"
    "negative: {kp: 1.14, ki: 55.0, kd: 0.018}\n",
    "conf/table/own.yaml": "title: own\nindicators: [rmse1_deg]\nby: {trajectory: [ramp_pos], controller: [pid]}\n",
    "campaigns/own.yaml": "name: own\ndescription: two gains\nfixed: {controller: pid}\n"
    "vary: {controller.positive.kp: [0.7, 1.05]}\nrepetitions: 1\ntables: []\n",
    "tolerances.yaml": "rmse1_deg: {absolute: 90.0}\nsse_deg: {absolute: 90.0, published_std: 3.0}\n",
    "map.yaml": "sampling_hz: 1000\nfields:\n  arm_deg: arm\n  pressure1_mpa: {column: p1, unit: MPa}\n"
    "  pressure2_mpa: {column: p2, unit: MPa}\n  pump_deg: pump\nmetadata: {condition: a}\n",
    "table.csv": "arm,p1,p2,pump\n" + "".join(f"{0.01 * k},0.26,0.25,{0.1 * k}\n" for k in range(200)),
    "controllers/mine.py": CONTROLLER,
    "trajectories/slope.py": TRAJECTORY,
}
DIAGNOSIS = {
    "verdict": "effect",
    "effects": ["string_elasticity"],
    "calibration": {},
    "candidates": [
        {"effect": "string_elasticity", "parameters": {"stiffness": {"value": 1e4, "unit": "N/m", "ci95": [9e3, 1e4]}}}
    ],
}

# Each kind of file with the calls that read it; none of them has a kernel to compile.
PLAN_OWN = (("plan", "trajectory=own"), ("plan", "controller=own"), ("plan",))
FILES: dict[str, tuple[tuple[str, ...], ...]] = {
    "run/plan.json": (("resume", "run"), ("report", "run"), ("show", "run"), ("ls", "--folder", "."), ("compare", "run")),
    "run/manifest.json": (("resume", "run"), ("report", "run"), ("show", "run"), ("ls", "--folder", ".")),
    "run/config.yaml": (("report", "run"), ("show", "run"), ("resume", "run")),
    LOG: (
        ("compare", "run"), ("report", "run"), ("log", "verify", "run"), ("log", "info", "run"), ("resume", "run"),
        ("log", "recover", LOG), ("log", "verify", LOG), ("log", "info", LOG), ("calibrate", "run", "--as=new"),
    ),
    "effects/my_spring.py": (("effects",), ("effects", "my_spring", "--no-figure"), ("plan", "+effects.my_spring={}")),
    "plants/axis.py": (("plants",), ("plants", "axis"), ("plants", "test", "axis")),
    "controllers/mine.py": PLAN_OWN[1:],
    "trajectories/slope.py": PLAN_OWN[:1],
    "conf/model/mine.yaml": (("plan", "model=mine"), ("compare", "run", "--model", "mine")),
    "conf/pump/own.yaml": (("plan", "pump=own"), ("plan", "pump=own", "--cfg")),
    "conf/payload/own.yaml": (("plan", "payload=own"), ("plan", "payload=own", "--cfg")),
    "conf/rig/own.yaml": (("plan", "rig=own", "backend=nidaqmx"), ("rig", "check", "rig=own")),
    "conf/trajectory/own.yaml": PLAN_OWN[:1],
    "conf/controller/own.yaml": PLAN_OWN[1:2],
    "conf/controller/gains/own.yaml": (("plan", "controller/gains=own"), ("plan", "controller=ffwd_pid", "controller/gains=own")),
    "conf/table/own.yaml": (("plan", "campaign=controllers", "tables=[own]"), ("report", "run")),
    "campaigns/own.yaml": (("plan", "campaign=own"), ("tune", "campaign=own", "--as=new")),
    "tolerances.yaml": (("report", "run", "--check", "tolerances.yaml"),),
    "map.yaml": (("import", "table.csv", "--map", "map.yaml", "--output", "new.mcap"),),
    "table.csv": (("import", "table.csv", "--map", "map.yaml", "--output", "new.mcap"),),
    "tour/step_2.json": (("tour", "--open"),),
    "tour/step_3.json": (("tour", "--open"),),
}  # fmt: skip


def prepared(folder: Path) -> None:
    """Make the folder that the calls get copies of: a run of two conditions, and a file of each kind."""
    from hjcamp import cli

    os.chdir(folder)
    code = cli.run(["run", "campaign=controllers", "conditions=[ramp_pos__pid,ramp_neg__pid]", "repetitions=2", "run_dir=run"])
    assert code == 0, "the run of the study failed"
    for name, text in TEXTS.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    (folder / "loop").symlink_to("loop")
    for command in ("effects", "plants"):
        assert cli.run([command, "new", {"effects": "my_spring", "plants": "axis"}[command]]) == 0
    from hjcamp.plants.pump_joint.tour.samples import lay_out

    lay_out(folder / "tour")
    (folder / "tour/step_2.json").write_text(json.dumps(DIAGNOSIS))
    (folder / "tour/step_3.json").write_text(json.dumps({"model": "mine", "file": "conf/model/mine.yaml"}))
    for words in {words for calls in FILES.values() for words in calls if words[0] == "plan"}:
        assert cli.run(list(words)) == 0, f"{' '.join(words)} fails before anything is damaged"


def _cut(path: Path, random_: random.Random) -> None:
    data = path.read_bytes()
    path.write_bytes(data[: random_.randrange(len(data))])


def _flip(path: Path, random_: random.Random) -> None:
    data = bytearray(path.read_bytes())
    for _ in range(random_.randint(1, 8)):
        data[random_.randrange(len(data))] = random_.randrange(256)
    path.write_bytes(bytes(data))


def _swap(path: Path, random_: random.Random) -> None:
    """Replace one number or word of a text by another."""
    text = path.read_bytes().decode("latin-1")
    found = list(re.finditer(r"[A-Za-z_]\w+|-?\d[\d.e+-]*", text))
    if found:
        one = random_.choice(found)
        new = random_.choice(("null", "-1", "1e300", "abc", "[]", "{}", "nan", "true", '"x"', "", "\x00", "\t"))
        text = text[: one.start()] + new + text[one.end() :]
    path.write_bytes(text.encode("latin-1"))


def _drop_line(path: Path, random_: random.Random) -> None:
    lines = path.read_bytes().split(b"\n")
    lines.pop(random_.randrange(len(lines)))
    path.write_bytes(b"\n".join(lines))


def _double_line(path: Path, random_: random.Random) -> None:
    lines = path.read_bytes().split(b"\n")
    place = random_.randrange(len(lines))
    lines.insert(place, lines[place])
    path.write_bytes(b"\n".join(lines))


def _empty(path: Path, random_: random.Random) -> None:
    path.write_bytes(b"")


def _folder(path: Path, random_: random.Random) -> None:
    path.unlink()
    path.mkdir()


def _link_to_itself(path: Path, random_: random.Random) -> None:
    path.unlink()
    path.symlink_to(path.name)


def _pipe(path: Path, random_: random.Random) -> None:
    """Put a pipe that nobody writes to in the file's place."""
    path.unlink()
    os.mkfifo(path)


def _bomb(path: Path, random_: random.Random) -> None:
    """Write YAML whose aliases, written out, hold 9^9 values, under a key that the file had."""
    text = path.read_bytes().decode("latin-1")
    keys = re.findall(r"(?m)^(\w+):", text) or ["a"]
    names = "abcdefghi"
    lines = [f"{names[0]}: &{names[0]} [x, x, x, x, x, x, x, x, x]"]
    lines += [f"{b}: &{b} [{', '.join([f'*{a}'] * 9)}]" for a, b in pairwise(names)]
    path.write_text("\n".join([*lines, f"{random_.choice(keys)}: *{names[-1]}", ""]))


def _other(path: Path, random_: random.Random) -> None:
    path.write_bytes(
        random_.choice(
            (b"[]", b"{}", b"3", b"null", b"- a\n- b\n", b"\xff\xfe\x00", b"a: &a [*a, *a]\n", b"raise SystemExit(0)\n",
             b"[" * 5000, b"x" * 100_000, b"while True: pass\n")
        )
    )  # fmt: skip


def _unreadable(path: Path, random_: random.Random) -> None:
    """Put a device in the file's place that gives an error for each read."""
    path.unlink()
    path.symlink_to("/proc/self/mem")


def _gone(path: Path, random_: random.Random) -> None:
    path.unlink()


DAMAGES: dict[str, Damage] = {
    "cut": _cut, "bytes changed": _flip, "a word changed": _swap, "another word changed": _swap, "a line less": _drop_line,
    "a line twice": _double_line, "empty": _empty, "a folder": _folder, "a link to itself": _link_to_itself,
    "a pipe": _pipe, "aliases of aliases": _bomb, "something else": _other, "cannot be read": _unreadable, "gone": _gone,
}  # fmt: skip
