"""The one check of a resolved configuration: types, signs, ranges and unknown keys, before anything is planned."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hjcamp.configuration.plant_settings import check_plant_configuration
from hjcamp.configuration.run_keys import RunKeys, read_run_keys
from hjcamp.known_plants import usual_plant
from hjcamp.schema import naming


def check_configuration(config: Mapping[str, Any], where: str = "") -> None:
    """Raise ``UsageError`` for a configuration with which no test can be made; ``where`` names it in the message.

    Keys of the run are checked where they are there, and so is the model with which a controller calculates.
    """
    with naming(where):
        if config.get("plant"):
            check_plant_configuration(config, ("campaign", *RunKeys.model_fields))
            if "repetitions" in config:
                read_run_keys(config)
        else:
            usual_plant().own_room("configuration").check_test(config)


def check_model(model: Any, path: str) -> None:
    """Raise ``UsageError`` for a model of the usual plant with an unknown effect or parameter, or a value out of bounds."""
    usual_plant().own_room("configuration").check_model(model, path)
