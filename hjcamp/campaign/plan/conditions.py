"""From a campaign and the command line to the settings of each condition."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, Any

from hjcamp.campaign.plan.campaign_file import RUN_KEYS, Axis, Campaign, label_of
from hjcamp.configuration.composer import as_override
from hjcamp.configuration.overrides import key_of, parse_overrides
from hjcamp.errors import UsageError
from hjcamp.records.plan import folder_name

if TYPE_CHECKING:
    from hydra.core.override_parser.types import Override

    from hjcamp.configuration.composer import Composer


@dataclass(frozen=True)
class Draft:
    """A condition before composing: its name and the overrides that make it."""

    name: str
    overrides: tuple[str, ...]


def draft_conditions(campaign: Campaign, lines: Sequence[str], composer: Composer, most: int) -> tuple[Campaign, list[Draft]]:
    """Return the campaign as narrowed by the command line, and its conditions in the order of the axes.

    ``lines`` are the user's overrides. They come after the campaign's: one of a fixed key replaces it, one of a varied
    key narrows the axis to that value. Raises ``UsageError`` for more than ``most`` conditions.
    """
    user = [item for item in parse_overrides(lines) if key_of(item).split(".")[0] not in RUN_KEYS]
    fixed = _without_replaced(campaign.fixed, user, composer)
    axes = campaign.axes
    for item in user:
        axes = tuple(_narrow(axis, item, composer) for axis in axes)
    narrowed = replace(campaign, fixed=fixed, axes=axes)
    sizes = [len(axis.cases) for axis in axes]
    if math.prod(sizes) > most:
        product_text = " x ".join(map(str, sizes))
        raise UsageError(
            f"campaign '{campaign.name}' varies {product_text} = {math.prod(sizes)} conditions; at most {most} tests "
            f"are made, unless you say most_tests={math.prod(sizes)}"
        )
    drafts = []
    varied = {key for axis in axes for key in axis.keys}
    own = [item.input_line or "" for item in user if not (key_of(item) in varied and not item.is_delete())]
    for labels in product(*(axis.cases for axis in axes)):
        settings = dict(fixed)
        for axis, label in zip(axes, labels, strict=True):
            settings.update(axis.cases[label])
        overrides = [as_override(key, value) for key, value in settings.items()]
        drafts.append(Draft("__".join(labels), (*overrides, *own)))
    _refuse_equal_names(drafts)
    return narrowed, drafts


def _without_replaced(fixed: dict[str, Any], user: Sequence[Override], composer: Composer) -> dict[str, Any]:
    kept = dict(fixed)
    for item in user:
        key = key_of(item)
        kept.pop(key, None)
        if composer.is_group(key):
            # Parameters fixed for the choice that the user replaced mean nothing for the new choice.
            inside = key.replace("/", ".") + "."
            kept = {name: value for name, value in kept.items() if not name.startswith(inside) or key not in fixed}
            if "/" in key and not item.is_delete():
                again = composer.set_by(key, str(item.value()))
                kept = {name: value for name, value in kept.items() if not {name, name.rpartition(".")[0]} & again}
    return kept


def _narrow(axis: Axis, item: Override, composer: Composer) -> Axis:
    key = key_of(item)
    if key not in axis.keys:
        return axis
    if item.is_delete():
        raise UsageError(f"'{item.input_line}' removes what the axis '{axis.name}' varies; give it a value")
    value = item.value()
    same = {label: settings for label, settings in axis.cases.items() if key in settings and settings[key] == value}
    if same:
        return Axis(axis.name, same)
    if all(settings.keys() == {key} for settings in axis.cases.values()):
        return Axis(axis.name, {label_of(key, value): {key: value}})
    if composer.is_group(key):
        allowed = sorted({str(settings[key]) for settings in axis.cases.values() if key in settings})
        raise UsageError(f"'{item.input_line}': the axis '{axis.name}' sets {key} in its cases. Allowed: {', '.join(allowed)}")
    cases = {label: {**settings, key: value} for label, settings in axis.cases.items()}
    return Axis(axis.name, cases)


def _refuse_equal_names(drafts: Sequence[Draft]) -> None:
    names: set[str] = set()
    for draft in drafts:
        if folder_name(draft.name).lower() in names:
            raise UsageError(f"two conditions are named '{draft.name}'; use values or cases with different names")
        names.add(folder_name(draft.name).lower())
