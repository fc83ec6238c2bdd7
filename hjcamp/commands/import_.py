"""Turn a table of measurements from elsewhere into a test log: hjcamp import FILE.csv --map MAP.yaml"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("import")(import_table)


def import_table(
    file: Annotated[Path, typer.Argument(help="The table, CSV.")],
    mapping: Annotated[Path, typer.Option("--map", help="Which column is which field, in which unit (YAML).")],
    output: Annotated[Path | None, typer.Option(help="The new log; FILE.mcap by default.")] = None,
) -> None:
    """Turn a table of measurements from elsewhere into a test log."""
    from hjcamp.records.import_map import read_import_map
    from hjcamp.records.importing import import_csv
    from hjcamp.records.plausible import findings
    from hjcamp.storage import check_place

    target = output or file.with_name(f"{file.stem}.mcap")
    check_place(target, "--output" if output else "")
    _check_hardware(read_import_map(mapping).metadata, mapping)
    left = target.with_name(target.name + ".part").exists()
    log = import_csv(file, mapping, target)
    for one in findings(log):
        print(f"{target}: {one.line}", file=sys.stderr)
    print(f"{target}: {log.samples} samples, {log.duration:.3f} s, fields {' '.join(log.columns)}")
    if left:
        print(f"  {target.name}.part, left by an import that was cut off, is gone")
    print(f"next  hjcamp compare {target}")


def _check_hardware(metadata: Mapping[str, str], mapping: Path) -> None:
    """Refuse hardware that no configuration describes: every analysis would ask for it."""
    from hjcamp.configuration.composer import Composer
    from hjcamp.discrepancy.hardware import NAMED
    from hjcamp.errors import unknown

    named = [group for group in NAMED if metadata.get(group)]
    composer = Composer() if named else None
    for group in named:
        if composer and metadata[group] not in (allowed := composer.options(group)):
            raise unknown(group, metadata[group], allowed, f"the metadata of {mapping}")
