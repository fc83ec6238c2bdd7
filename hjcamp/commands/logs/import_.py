"""Turn measurements from elsewhere into test logs: hjcamp import FILE... --map MAP.yaml"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from hjcamp.commands.shared.session import AnswerFile, check_answer_file, progress_of, write_answer
from hjcamp.errors import UsageError, counted, unknown
from hjcamp.known_plants import DEFAULT, find_plant
from hjcamp.storage import check_place, whole_file

if TYPE_CHECKING:
    from hjcamp.records.elsewhere.import_map import ImportMap
    from hjcamp.records.elsewhere.importing import Imported, Refused

NEW = "new"
MOST_WARNINGS = 20
HELP = """Turn measurements from elsewhere into test logs.

FILE is CSV, MATLAB, NumPy (.npz), Parquet or MCAP (JSON or protobuf messages); with pip install 'hjcamp[files]' also a workbook
(.xlsx, .ods), TDMS, HDF5, MATLAB 7.3, or a recording of ROS 2 (MCAP, .db3). "hjcamp plants NAME" prints a map
with all fields of a plant. An example of MAP.yaml:

\b
  plant: axis              # USUAL where it is absent
  period_s: 0.001          # or sampling_hz; not needed where time_s is mapped
  resample_s: 0.005        # brings rows that are uneven all along to this period
  gaps: interpolate        # cells without a value, up to three lost rows in turn; they are refused where it is absent
  missing: [-9999, "---"]  # what stands for no reading, as it is in the file: a gap
  spikes: interpolate      # readings that jump out and back; they are kept, and told, where it is absent
  topic: /motor/state      # MCAP and ROS 2 alone; sheet: of a workbook; group: of TDMS and HDF5
  skip_lines: 2            # CSV and workbooks: also units_below, comment; separator, header and decimal_comma are read off the file
  fields:
    time_s: {column: t, unit: ms}
    position_m: {column: x, unit: mm, scale: 1, offset: 0, sign: -1}
    angle_rad: {column: n, unit: turn, scale: 1.5e-5, unwrap: 65536}   # a counter or an angle that begins again
    voltage_v: {column: u, topic: /motor/command}                      # MCAP: of another topic
  metadata: {condition: "{file}", mass_kg: 95}   # {file}: the file's name
  files:                   # metadata of single files; then every file stands here
    train.csv: {condition: train}
    pulses.csv: {condition: pulses, mass_kg: 120}

A column is one of a table (1, 2, 3, ... where it has no header), a MATLAB variable (q, data.q, q(:,2), rec.Y(2).Data), an array or
data set (q, run/q, q[:,1]), a channel, or a name in a message (q, pose.x, position[0], header.stamp);
with brackets, colons or quotes it is quoted. A unit is any that pint knows. Times are
read as they are written (12:00:00,5, 31.01.2026 12:00:00.5, 5-Mar-2026 ...), days of a spreadsheet with unit: day.
""".replace("USUAL", DEFAULT)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("import", help=HELP)(import_table)


def import_table(
    files: Annotated[list[Path], typer.Argument(metavar="FILE...", help="The files, or a folder of them, all by one map.")],
    mapping: Annotated[
        Path,
        typer.Option(
            "--map", help="Which column is which field, in which unit (YAML); 'new' writes one, as the header suggests."
        ),
    ],
    plant: Annotated[str | None, typer.Option(help="Of --map new: the plant.")] = None,
    into: Annotated[Path | None, typer.Option(help="The folder of the new logs; next to each file by default.")] = None,
    output: Annotated[Path | None, typer.Option(help="The new log of one file; FILE.mcap by default.")] = None,
    skip: Annotated[
        bool, typer.Option(help="Leave out files that cannot be read; without it nothing is written then.")
    ] = False,
    json: AnswerFile = None,
) -> None:
    """Turn measurements from elsewhere into test logs."""
    from hjcamp.analyses.data import joined
    from hjcamp.analyses.import_table import FEW, answer_of, table_lines
    from hjcamp.analyses.readiness import at_ends
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.records.elsewhere.import_map import read_import_map
    from hjcamp.records.elsewhere.importing import import_files
    from hjcamp.records.sets.look import lines_of, look_one_by_one
    from hjcamp.records.stored import stored_logs

    check_answer_file(json)
    files = files_of(files, into)
    if str(mapping) == NEW:
        write_new_map(files, plant or DEFAULT, output)
        return
    if plant is not None:
        raise UsageError(f"--plant {plant}: the plant stands in {mapping}; the option is of --map {NEW}")
    targets = targets_of(files, into, output)
    rules = read_import_map(mapping)
    _check_hardware([rules.metadata, *rules.files.values()], (*rules.plant.rig, *rules.plant.setups), mapping)
    left = [target for target in targets if target.with_name(target.name + ".part").exists()]
    refused: list[Refused] = []
    with progress_of(make_console()) if len(files) > FEW else nullcontext(lambda text, share: None) as report:
        logs = import_files(files, mapping, targets, refused if len(files) > 1 else None, report, at_ends)
        if refused and not (skip and logs):
            drop(logs, refused, table_lines(logs, refused, []) if len(files) > FEW else [])
        in_set = look_one_by_one(stored_logs([log.path for log in logs]))
    write_answer(json, answer_of(rules.plant.name, logs, refused, in_set))
    tell([f"{log.path}: {one.line}" for log in logs for one in log.doubtful])
    if len(files) <= FEW:
        for log in logs:
            print(f"{log.path}: {counted(log.samples, 'sample')}, {log.duration:.3f} s, fields {' '.join(log.fields)}")
    for target in left:
        print(f"  {target.name}.part, left by an import that was cut off, is gone")
    tell([*lines_of(in_set), *too_short(rules, logs)])
    warn_of_map(mapping, rules, logs)
    for line in table_lines(logs, refused, in_set) if len(files) > FEW or refused else []:
        print(line)
    print(f"next  hjcamp compare {joined([into] if into and len(logs) > 1 else [log.path for log in logs])}")


def drop(logs: Sequence[Imported], refused: Sequence[Refused], lines: Sequence[str]) -> NoReturn:
    """Take back what was written, print the table, and raise UsageError for the files that cannot be read."""
    for log in logs:
        log.path.unlink(missing_ok=True)
    for line in lines:
        print(line)
    more = f" (and {counted(len(refused) - 1, 'more file')})" if len(refused) > 1 else ""
    hint = "; nothing is written; --skip leaves out what cannot be read" if logs else ""
    raise UsageError(f"{refused[0].text}{more}{hint}")


def tell(lines: Sequence[str]) -> None:
    """Print warnings, the first of many."""
    for line in lines[:MOST_WARNINGS]:
        print(line, file=sys.stderr)
    if len(lines) > MOST_WARNINGS:
        print(
            f"and {counted(len(lines) - MOST_WARNINGS, 'more warning')}: the table names them, --json FILE has all",
            file=sys.stderr,
        )


def too_short(rules: ImportMap, logs: Sequence[Imported]) -> list[str]:
    """Return a warning for each log that an analysis leaves out as too short."""
    from hjcamp.diagnosis.data.tests import FEWEST_SAMPLES

    return [
        f"{log.path}: warning: {counted(log.samples, 'sample')}; an analysis leaves out logs of fewer than {FEWEST_SAMPLES}"
        for log in logs
        if "diagnose" not in rules.plant.rooms and log.samples < FEWEST_SAMPLES
    ]


def warn_of_map(mapping: Path, rules: ImportMap, logs: Sequence[Imported]) -> None:
    """Say what a map may have wrong, or leaves to the plant: the sampling period, metadata, fields of one column."""
    from hjcamp.model.checks.plant_checks import other_period
    from hjcamp.records.of_plant import PERIOD_KEY

    periods = {float(log.metadata[PERIOD_KEY]) for log in logs if PERIOD_KEY in log.metadata}
    for note in sorted({other_period(rules.plant, period) for period in periods} - {""}):
        print(note, file=sys.stderr)
    for name in rules.lacking([log.metadata for log in logs]):
        print(f"{mapping}: warning: the metadata do not give '{name}'; the plant's default is used", file=sys.stderr)
    for column, names in rules.taken_twice.items():
        print(f"{mapping}: warning: {' and '.join(names)} are made of one column, '{column}'", file=sys.stderr)


def files_of(files: Sequence[Path], into: Path | None) -> list[Path]:
    """Return the files, those of a folder in its place; raises UsageError where a folder holds none that can be read."""
    from hjcamp.records.elsewhere.readers import endings

    found: list[Path] = []
    for one in files:
        if not one.is_dir():
            found.append(one)
            continue
        own = sorted(path for path in one.iterdir() if path.is_file() and path.suffix.casefold() in endings())
        if not own:
            raise UsageError(f"{one}: this folder has no file that ends in {', '.join(endings())}")
        if into is None and len(own) > 1:
            raise UsageError(f"{one}: this is a folder; give --into DIR for the logs of its {len(own)} files")
        found += own
    return found


def write_new_map(files: Sequence[Path], plant: str, output: Path | None) -> None:
    """Write the map that the header of the first file suggests, and say what of it is open."""
    from hjcamp.analyses.data import joined
    from hjcamp.model.checks.plant_checks import check_users_plant
    from hjcamp.records.elsewhere.guess import guess_map
    from hjcamp.records.elsewhere.map_schema import map_schema
    from hjcamp.schema import editor_line

    target = output or files[0].with_name(f"{files[0].stem}_map.yaml")
    check_place(target, "--output" if output else "")
    if target.exists():
        raise UsageError(f"{target}: exists already; delete it, or give another name: --output MAP.yaml")
    chosen = find_plant(plant, "--plant")
    check_users_plant(chosen)
    guess = guess_map(files[0], chosen)
    with whole_file(target) as stream:
        stream.write((editor_line(target, f"map_{chosen.name}", map_schema(chosen)) + guess.text).encode())
    print(f"{target}: guessed from the columns of {files[0]}; look it through")
    if guess.open:
        print(f"  open (?): {', '.join(guess.open)}")
    if guess.unused:
        print(f"  not used: {', '.join(guess.unused[:20])}{', ...' if len(guess.unused) > 20 else ''}")
    into = " --into DIR" if len(files) > 1 else ""
    print(f"next  hjcamp import {joined(files if len(files) < 4 else [files[0].parent])} --map {joined([target])}{into}")


def targets_of(files: Sequence[Path], into: Path | None, output: Path | None) -> list[Path]:
    """Return the log that each file becomes; raises UsageError where the options do not say it."""
    if output is not None and into is not None:
        raise UsageError("give --into DIR or --output FILE, not both")
    if output is not None and len(files) > 1:
        raise UsageError(f"--output {output}: there are {len(files)} files; give --into DIR")
    if into is not None and into.exists() and not into.is_dir():
        raise UsageError(f"--into {into}: this is a file; give a folder")
    if output is not None:
        check_place(output, "--output")
        return [output]
    targets = [(into or file.parent) / f"{file.stem}.mcap" for file in files]
    for target in targets:
        check_place(target, "--into" if into else "")
    for file, target in zip(files, targets, strict=True):
        if target == file:
            raise UsageError(f"{file}: this is an MCAP file itself; give --into DIR or --output FILE for the new log")
    return targets


def _check_hardware(metadata: Sequence[Mapping[str, str]], groups: Sequence[str], mapping: Path) -> None:
    """Refuse hardware that no configuration describes: every analysis would ask for it."""
    from hjcamp.configuration.composer import Composer

    named = [(group, one[group]) for one in metadata for group in groups if one.get(group)]
    composer = Composer() if named else None
    for group, choice in named:
        if composer and choice not in (allowed := composer.options(group)):
            raise unknown(group, choice, allowed, f"the metadata of {mapping}")
