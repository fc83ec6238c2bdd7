"""Begin a repository of a plant: its file, a campaign, a job that checks it, and how a change is accepted."""

from __future__ import annotations

from importlib import resources
from pathlib import Path
from typing import Annotated

import typer

from hjcamp import __version__
from hjcamp.errors import UsageError
from hjcamp.storage import check_place, shown_path, whole_file


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("repository")(repository)


def repository(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="A new folder.")],
    plant: Annotated[str, typer.Option(help="Name of the plant; its file is begun as by hjcamp plants new.")] = "axis",
) -> None:
    """Begin a repository of a plant, of six files: plant, campaign, CI job, requirements, README, .gitignore."""
    from hjcamp.commands.shared.plant_template import write_template
    from hjcamp.known_plants import OWN_PLANTS, plant_names

    check_place(folder, folder=True)
    if folder.exists() and any(folder.iterdir()):
        raise UsageError(f"{shown_path(folder)}: is not empty; give a new folder")
    write_template(plant, folder / "plants", plant_names(OWN_PLANTS))
    source = resources.files("hjcamp.report") / "repository"
    values = {"PLANT": plant, "UNIT": "v", "HIGH": "4.0", "LOW": "-4.0"}
    files = {
        "campaigns/check.yaml": (source / "check.yaml").read_text(encoding="utf-8"),
        ".github/workflows/check.yml": (source / "workflow.yml").read_text(encoding="utf-8"),
        "README.md": (source / "README.md").read_text(encoding="utf-8"),
        ".gitignore": (source / "gitignore").read_text(encoding="utf-8"),
        "requirements.txt": f"hjcamp=={__version__}\n",
    }
    for name, text in files.items():
        if not name.endswith(".yml"):
            for word, value in values.items():
                text = text.replace(word, value)
        with whole_file(folder / name) as stream:
            stream.write(text.encode())
    print(f"{folder}: plants/{plant}.py {' '.join(files)}")
    print(f"next  cd {folder}; hjcamp run campaign=check run_dir=baseline")
