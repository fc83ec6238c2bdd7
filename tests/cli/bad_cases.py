"""The bad calls: over the options of every command, overrides, every value of the configuration, and every kind of file."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from bad_files import DAMAGES, FILES, Damage

NUMBERS = (
    "abc", "true", "-1e300", "1e300", "nan", "inf", "[1,2]", "{a: 1}", "null", "''", "-1", "0", "1e-300", "1" * 400,
)  # fmt: skip
WORDS = (
    "", " ", "nowhere", "../../etc", "a=b", "--", "\N{SNOWMAN}", "x" * 300, "published ", "PUBLISHED", "-1", "1e9", "nan",
    "a\nb", "a/b", ".", "[bold]", "%s", "${oc.env:HOME}", "\udcff",
)  # fmt: skip
PATHS = (
    "", ".", "/proc/nosuch/x", "/dev/full/x", "run", "run/plan.json/x", "x" * 300, "map.yaml/..", "\x01/x",
    "loop/x", "a/" * 2100 + "x",
)  # fmt: skip
ADDRESSES = (
    "", "nowhere", "localhost", ":1", "localhost:abc", "localhost:99999", "localhost:-1", "nosuch.invalid:31763",
    "[::1:31763", "http://localhost:31763", "localhost:1", "0.0.0.0:0", "unix:/nosuch/x", "localhost:0", "256.1.1.1:31763",
)  # fmt: skip
FAULTS = ("", "nosuch@1", "late", "late@", "late@-1", "late@1e9", "late@1#", "late@1#-1", "@1", "late@1@2", "x" * 300)
OVERRIDES = (
    "a=b=c", "=", "+", "~", "~pump", "pump", "pump=", "pump=[", "pump=nosuch", "pump=pump1,pump2", "trajectory={kind: ramp}",
    "x=${oc.env:HOME}", "pump.bore_mm=${oc.env:HOME}", "pump=${amplifier}", "+pump=pump1", "campaign=nosuch",
    "campaign=[controllers,leakage]", "campaign=null", "repetitions=0", "repetitions=1000000000", "repetitions=1.5",
    "seed=-1", "seed=abc", "workers=0", "workers=-3", "run_dir=/dev/null", "run_dir=conf/model/mine.yaml", "tables=nosuch",
    "conditions=nosuch*", "fail_fast=maybe", "keep_going=no", "keep_going=off", "effects=3", "+effects.nosuch.a=1",
    "+effects.leakage.nosuch=1", "+effects.leakage.conductance=-1", "+effects.leakage.conductance=abc", "model=nosuch",
    "model=../model/published", "model=broken", "controller=nosuch", "controller.positive=3", "controller.positive.kp=-5",
    "controller.positive.kp=1e308", "controller.nosuch=1", "trajectory=nosuch", "trajectory.duration=-1",
    "trajectory.duration=1e12", "backend=replay", "backend=nosuch", "rig=nosuch", "backend=nidaqmx rig=example_pxie",
    "rig.watchdog=true", "rig.limits=null", "rig.inputs.pressure1=null", "+x._target_=os.system", "hydra.run.dir=/proc/x",
    "hydra/launcher=nosuch", "hydra/launcher=joblib", "+hydra.callbacks.x._target_=os.system", "procedure.rest_ms=1e12",
    "controller=own +controller.gain=abc", "controller=own controller.gain=-1", "trajectory=own trajectory.amplitude=abc",
    "trajectory=own trajectory.rise_time=-1", "controller/gains=nosuch", "controller/gains=own controller.positive.kp=abc",
    "--config-dir=nosuch", "--config-name=x", "--cfg=nosuch", "-m", "--multirun pump=pump1,pump1", "--hydra-help=x", "--",
    "run_dir=''", "run_dir=" + "x" * 300, "repetitions=1" + "0" * 5000, "conditions=[", "conditions=3", "tables=[1]",
    "campaign=controllers campaign=leakage", "~effects", "effects=null", "+hydra.searchpath=[pkg://os]", "model=null",
    "+controller_model.parameters.x=1", "+plant=nosuch", "~campaign=x", "pump=own pump.name=null", "rig.limits.nosuch=1",
)  # fmt: skip
LOG_CALLS = (
    "log", "log info", "log verify", "log recover", "log info nowhere", "log verify .", "log verify map.yaml",
    "log recover run", "log recover map.yaml", "log recover nowhere", "log info /dev/null", "log verify run run",
    "log recover run/logs/ramp_pos__pid/rep_01.mcap --output run/logs/ramp_pos__pid/rep_01.mcap",
    "log recover run/logs/ramp_pos__pid/rep_01.mcap --output run", "log recover /dev/zero --output new.mcap",
    "tour --step 9", "tour --step 2 --open", "tour --effort nosuch", "tour --into run", "tour --into map.yaml",
    "tour --step 3 --into nowhere/x", "tour --step 5 --into effects", "tour --into /proc/x", "tour --into /dev/null",
    "effects new", "effects new my_spring", "effects new leakage", "effects new 9", "effects new a b", "effects test",
    "effects test nosuch", "effects my_spring leakage", "effects my_spring --figure x.gif", "effects new class",
    "plants new", "plants new axis", "plants new pump_joint", "plants new ../x", "plants test", "plants test nosuch",
    "plants nosuch", "plants axis --figure x.gif", "plants axis --figure nowhere/x.svg", "plants a b c",
    "rig", "rig nosuch", "rig check", "rig check rig=nosuch", "rig check rig=example_pcie", "rig unlock x",
    "rig serve effects.nosuch.a=1", "rig serve pump=pump1", "rig serve effects.leakage.conductance=abc",
    "rig serve --rate 0.5", "rig serve --real-time --rate 9", "rig serve --rate nan --real-time",
    "add", "add leakage", "add leakage run", "add leakage leakage run --as=new", "add run --as=new", "add leakage run --as=",
    "add leakage nowhere --as=new", "next run nowhere", "next run --tests=0", "next run --rivals=nosuch",
    "next run --rivals=,", "compare run run/logs nowhere", "diagnose map.yaml",
    "calibrate run --as=own --only=pump", "calibrate run --as=own --only=pump=nosuch", "ls nosuch", "ls state=nosuch",
    "resume run --workers=0", "report . ", "report run --check nosuch", "show .", "nosuch", "--nosuch", "--version=3",
    "import table.csv", "import map.yaml --map=map.yaml", "import table.csv --map=table.csv", "tune x", "tune campaign=leakage",
    "tune campaign=nosuch", "tune --from=nosuch campaign=own", "plan --json --cfg", "plan --condition=nosuch",
    "plan --json", "ls --json /dev/null", "ls --json run", "show run --json loop", "report run --against=nowhere",
    "report run --against=map.yaml", "diff", "diff run", "diff run nowhere", "diff run map.yaml", "history", "history campaign=nosuch",
    "history campaign=own nosuch", "history campaign=own --over=days", "history campaign=own --figure=x.gif", "paper",
    "paper run", "paper run --as=run/plan.json", "paper run --as=text --style=iee", "paper run --as=text --width=3",
    "paper run --as=text --formats=gif", "paper nowhere --as=text", "paper run/plan.json --as=text", "paper map.yaml --as=text",
)  # fmt: skip
# What a command needs beside the option that is tried.
NEEDED = {
    "compare": ("run",), "diagnose": ("run", "--effort=quick"), "report": ("run",), "show": ("run",), "resume": ("run",),
    "calibrate": ("run", "--as=new"), "add": ("nosuch", "run", "--as=new"), "next": ("run", "--effort=quick"),
    "import": ("table.csv", "--map=map.yaml"), "effects": ("my_spring", "--no-figure"), "plants": ("axis",),
    "tour": ("--step=4",), "log info": ("run",), "log verify": ("run",), "log export": ("run",), "explain": ("floor",),
    "log recover": ("run/logs/ramp_pos__pid/rep_01.mcap", "--output=new.mcap"), "diff": ("run", "run"),
    "history": ("campaign=own",), "paper": ("run", "--as=text"),
}  # fmt: skip
SURROUNDINGS: tuple[dict[str, str | None], ...] = (
    {"HOME": None}, {"HOME": "/nosuch"}, {"HOME": ""}, {"HJCAMP_CONF": "/nosuch"}, {"HJCAMP_CONF": "map.yaml"},
    {"HJCAMP_CONF": ":::"}, {"HJCAMP_CONF": "~nosuch/x"}, {"HJCAMP_CACHE": "/dev/null/x"}, {"HJCAMP_CACHE": "map.yaml"},
    {"HJCAMP_CACHE": "/proc"}, {"COLUMNS": "1"}, {"COLUMNS": "abc"}, {"TERM": "nosuch"}, {"LANG": "nosuch"},
    {"PYTHONIOENCODING": "ascii"}, {"TMPDIR": "/nosuch"},
)  # fmt: skip
SURROUNDED = ("plan", "doctor", "log verify run", "effects", "plants", "ls", "rig unlock", "show run")


@dataclass(frozen=True)
class Case:
    """One bad call: its words, what is done to the folder before, its environment, and what it is about."""

    about: str
    words: tuple[str, ...]
    before: Callable[[Path], None] | None = None
    environment: Mapping[str, str | None] = field(default_factory=dict)


def commands() -> dict[str, list[tuple[str, str]]]:
    """Return each command's options with the kind of their value, from the command line itself."""
    from hjcamp.commands import command_files, load

    found: dict[str, list[tuple[str, str]]] = {}
    for name, path in command_files().items():
        command = load(path)
        inner = getattr(command, "commands", None) or {"": command}
        for word, one in inner.items():
            options = [(max(given.opts, key=len), _kind(given)) for given in one.params if _is_tried(given)]
            found[f"{name} {word}".strip()] = options
    return found


def _is_tried(given: Any) -> bool:
    return given.param_type_name == "option" and "--help" not in given.opts


def _kind(given: Any) -> str:
    return "flag" if getattr(given, "is_flag", False) else str(given.bare_type())


def of_options(random_: random.Random, number: int = 4) -> Iterator[Case]:
    """Every option of every command with ``number`` values that cannot be, and calls without their arguments."""
    for name, options in commands().items():
        words = tuple(name.split())
        first = NEEDED.get(name, ())
        for option, kind in options:
            if kind == "flag":
                yield Case(f"{name}, flag with a value", (*words, *first, f"{option}=perhaps"))
                continue
            for value in random_.sample(values_for(option, kind), number):
                yield Case(f"{name} {option}", (*words, *first, f"{option}={value}"))
        yield Case(f"{name}, unknown option", (*words, *first, "--nosuch"))
        if name == "rig check":
            continue  # moves a rig, a virtual one here
        for word in random_.sample([word for word in WORDS if word not in ("--", ".", "")], 3):
            yield Case(f"{name}, an argument", (*words, word))


def values_for(option: str, kind: str) -> tuple[str, ...]:
    """Return values that the option cannot have, or hardly."""
    if option == "--address":
        return ADDRESSES
    if option == "--fault":
        return FAULTS
    kind = kind.lower()
    if option == "--seed":
        return tuple(value for value in NUMBERS if value != "0")
    return NUMBERS if "int" in kind or "float" in kind else PATHS if "path" in kind else WORDS


def of_calls(random_: random.Random) -> Iterator[Case]:
    """Calls with wrong arguments, rigs that are not there, and surroundings in which little works."""
    for line in LOG_CALLS:
        yield Case("arguments", tuple(line.split(" ")))
    for address in ADDRESSES:
        words = ("run", "trajectory=ramp_pos", "repetitions=1", "backend=nidaqmx", "rig=virtual")
        connection = f"rig.connection={{kind:address,address:'{address}'}}"
        yield Case("the address of a rig", (*(("rig", "check", "--yes") if random_.random() < 0.4 else words), connection))
    for surroundings in SURROUNDINGS:
        for line in random_.sample(SURROUNDED, 2):
            yield Case(f"surroundings {surroundings}", tuple(line.split()), environment=surroundings)
    bad = random_.choice((b"", b"[]", b"\xff", b'{"process": []}'))
    yield Case("a foreign lock", ("rig", "unlock"), _lock(bad))


def _lock(content: bytes) -> Callable[[Path], None]:
    def before(folder: Path) -> None:
        (folder.parent / "hjcamp_rigs").mkdir()
        (folder.parent / "hjcamp_rigs" / "x.lock").write_bytes(content)

    return before


def of_overrides(random_: random.Random) -> Iterator[Case]:
    """Overrides that cannot be: of groups, of the run, and every value of the configuration with one it cannot have."""
    from hjcamp.configuration.composer import Composer

    for line in OVERRIDES:
        yield Case("override", (random_.choice(("plan", "run")), *line.split(" ")))
    for choices in ((), ("controller=ffwd_pid", "trajectory=mixed"), ("pump=pump1", "rig=example_pxie")):
        config = Composer().compose(choices).config
        for path, is_number in sorted(_values(config)):
            value = random_.choice(NUMBERS[:9] if is_number else ("3", "nosuch", "[1]", "{a: 1}", "null", "''"))
            if is_number or not choices:
                yield Case("value of the configuration", ("plan", *choices, f"{path}={value}"))


def _values(config: object, path: str = "") -> Iterator[tuple[str, bool]]:
    if isinstance(config, dict):
        for key, value in config.items():
            if not str(key).isdigit():
                yield from _values(value, f"{path}.{key}" if path else str(key))
    elif path not in ("repetitions", "seed"):
        yield path, isinstance(config, int | float) and not isinstance(config, bool)


def of_files(random_: random.Random, count: int) -> Iterator[Case]:
    """Every kind of file, damaged at random or replaced by something else, before the commands that read it."""
    pairs = [(name, how) for name in FILES for how in DAMAGES]
    random_.shuffle(pairs)
    for number in range(count):
        name, how = pairs[number % len(pairs)]
        words = random_.choice(FILES[name])
        seed = random_.randrange(1 << 30)

        def before(folder: Path, name: str = name, damage: Damage = DAMAGES[how], seed: int = seed) -> None:
            damage(folder / name, random.Random(seed))

        yield Case(f"{name}: {how}", words, before)


def all_cases(random_: random.Random, calls: int) -> list[Case]:
    """Return at least ``calls`` cases: all options, arguments, values; then damaged files, each kind at least once."""
    fixed = [*of_options(random_), *of_calls(random_), *of_overrides(random_)]
    return [*fixed, *of_files(random_, max(len(FILES) * len(DAMAGES), calls - len(fixed)))]


def shown(case: Case) -> str:
    """Return the call in one line."""
    return " ".join(json.dumps(word, ensure_ascii=False)[1:-1][:60] or "''" for word in case.words)
