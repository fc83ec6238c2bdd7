"""Turn a table of measurements from elsewhere into a test log: hjcamp import FILE.csv --map MAP.yaml"""

from __future__ import annotations

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
    from hjcamp.records.importing import import_csv

    target = output or file.with_suffix(".mcap")
    left = target.with_name(target.name + ".part").exists()
    log = import_csv(file, mapping, target)
    print(f"{target}: {log.samples} samples, {log.duration:.3f} s, fields {' '.join(log.columns)}")
    if left:
        print(f"  {target.name}.part, left by an import that was cut off, is gone")
    print(f"next  hjcamp compare {target}")
