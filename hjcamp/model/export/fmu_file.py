"""A composed model as an FMU 2.0 for co-simulation: the Python file inside what pythonfmu makes of a class."""

from __future__ import annotations

import tempfile
from pathlib import Path

from hjcamp.errors import UsageError
from hjcamp.model.export.python_file import Exported, python_file
from hjcamp.storage import write_whole


def write_fmu(path: Path, exported: Exported) -> None:
    """Write the FMU whole; who runs it needs Python with numpy. Raises ``UsageError`` where pythonfmu is not installed."""
    try:
        from pythonfmu.builder import FmuBuilder
    except ImportError:
        raise UsageError("--as fmu needs pythonfmu, which is not installed: pip install 'hjcamp[fmu]'") from None
    with tempfile.TemporaryDirectory(prefix="hjcamp_fmu_") as folder:
        script = Path(folder) / f"{path.stem}.py"
        script.write_text(python_file(exported, "fmu"), encoding="utf-8")
        made = FmuBuilder.build_FMU(script, Path(folder) / f"{path.stem}.fmu")
        write_whole(path, Path(made).read_bytes())
