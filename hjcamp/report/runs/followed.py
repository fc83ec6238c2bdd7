"""What the tests of the usual plant follow: the field, what is wanted of it, and the error between them."""

from __future__ import annotations

from hjcamp.controllers.fit import controlled_field
from hjcamp.known_plants import usual_plant
from hjcamp.model.language.field_unit import unit_of_field

FOLLOWED = controlled_field(usual_plant())
UNIT = unit_of_field(FOLLOWED, FOLLOWED).suffix
WANTED, ERROR = f"reference_{UNIT}", f"error_{UNIT}"
