"""Parquet files."""

from __future__ import annotations

import json
from pathlib import Path

from hjcamp.records.elsewhere.cells import numbers_of
from hjcamp.records.elsewhere.import_map import ImportMap
from hjcamp.records.elsewhere.reader import Column, Reader, Table, check_width, damage_as_refusal


class Parquet(Reader):
    endings = (".parquet", ".pq")
    says = "Parquet"

    def read(self, source: Path, names: list[str], rules: ImportMap) -> Table:
        """Return the named columns."""
        import polars

        with damage_as_refusal(source, self.says):
            check_width(source, len(polars.read_parquet_schema(source)))
            table = polars.read_parquet(source, use_pyarrow=False)
        return Table(numbers_of(source, table, names, False, rules))

    def columns(self, source: Path, rules: ImportMap) -> list[Column]:
        """Return the columns, with the units that an export of ours has written."""
        import polars

        with damage_as_refusal(source, self.says):
            names = list(polars.read_parquet_schema(source))
            units = json.loads(polars.read_parquet_metadata(source).get("units", "{}"))
        return [Column(name, str(units.get(name, ""))) for name in names]
