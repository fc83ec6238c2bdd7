"""What holds a contact at rest, found from the rates of all contacts.

Rates of velocities are affine in the forces of friction F: a(F) = a(0) + A F. A contact's push is the force with which it
does not move, while the others that are held do not move either and those in motion rub: A_hh F_h = -(a_h(0) + A_hs F_s).
A is found by adding one unit of force to each contact in turn (Featherstone 2008, Rigid Body Dynamics Algorithms, 6.2).
What does not depend on a push is computed once.
"""

from __future__ import annotations

import functools
import operator
import re
from collections.abc import Mapping, Sequence

from hjcamp.model.compile.source_text import EVERY, assigned, behind, gates_of, names_in
from hjcamp.model.declare.parameter import Contact


def with_reactions(lines: Sequence[str], contacts: Sequence[Contact], rates: Mapping[str, str]) -> list[str]:
    """Return the lines with every contact's push found before it is read, and its friction equal to it while it is held.

    ``rates`` are the expressions of the contacts' rates as they are while nothing is held.
    """
    places = range(len(contacts))
    pushes, frictions = [one.push for one in contacts], [one.friction for one in contacts]
    velocities = [f"d_{one.velocity}" for one in contacts]
    moved = _reached_from(frictions, lines, dict(zip(velocities, rates.values(), strict=True)))
    every = {assigned(line)[0] for line in lines}
    found = [_called(line, dict.fromkeys(every, "rubbing")) for line in lines]
    for k in places:
        found.append(f"held__{k} = u_{contacts[k].direction} == 0.0 and {contacts[k].locks}__rubbing != 0.0")
        found.append(f"rubs__{k} = 0.0 if held__{k} else {frictions[k]}__rubbing")
    for added in (-1, *places):
        own = dict.fromkeys(every, "rubbing") | dict.fromkeys(moved | set(frictions), f"with_{added + 1}")
        found += [f"{one}__with_{added + 1} = rubs__{k}{' + 1.0' * (k == added)}" for k, one in enumerate(frictions)]
        for line in lines:
            target = assigned(line)[0]
            if target in velocities:
                line = f"{target} = {rates[contacts[velocities.index(target)].velocity]}"
            found += [_called(line, own)] if target in moved and target not in frictions else []
    gains = [[f"({one}__with_{j + 1} - {one}__with_0)" for j in places] for one in velocities]
    needed = {}
    for k in places:
        found += _balance(k, [f"{one}__with_0" for one in velocities], gains)
        needed[pushes[k]] = f"{pushes[k]} = force__{k} + rubs__{k}"
    last = {friction: max(place for place, line in enumerate(lines) if assigned(line)[0] == friction) for friction in frictions}
    other, seen = _other_than_rubbing(lines, pushes, frictions), set[str]()
    for place, line in enumerate(lines):
        target = assigned(line)[0]
        if target in needed:
            found.append(needed[target])
        elif other[target] == EVERY:
            found.append(line)
        else:
            found += [] if target in seen else [f"{target} = {target}__rubbing"]
            found += [behind(other[target], line)] if other[target] else []
        seen.add(target)
        found += [f"if held__{k}: {one} = {pushes[k]}" for k, one in enumerate(frictions) if place == last[one]]
    return found


def _other_than_rubbing(lines: Sequence[str], pushes: Sequence[str], frictions: Sequence[str]) -> dict[str, int]:
    """Return by target the sum of the gates (`EVERY`: all) of which one must be open for it to differ from what it is while all rub."""
    found = dict.fromkeys(pushes, EVERY)
    for line in lines:
        target, used = assigned(line)
        masks, _ = gates_of(line)
        # behind its own lines the friction of what is held is the push
        others = [EVERY if name in frictions else found.get(name, 0) for name in used - {target}]
        mask = functools.reduce(operator.or_, others, 0)
        found[target] = found.get(target, 0) | (masks[-1] if mask == EVERY and masks else mask)
    return found


def _balance(own: int, free: Sequence[str], gains: Sequence[Sequence[str]]) -> list[str]:
    """Return the lines that find ``force_OWN``: what contact ``own`` needs more than it rubs with, by elimination."""
    count = len(free)
    lines, order = [], [k for k in range(count) if k != own] + [own]
    for i in order:
        held = f" if held__{i} else 0.0" if i != own else ""
        lines.append(f"b__{i} = -{free[i]}{held}")
        for j in order:
            both = [f"held__{k}" for k in dict.fromkeys((i, j)) if k != own]
            other = f" if {' and '.join(both)} else {1.0 if i == j else 0.0}" if both else ""
            lines.append(f"a__{i}_{j} = {gains[i][j]}{other}")
    for step, i in enumerate(order):
        for below in order[step + 1 :]:
            lines.append(f"share__ = a__{below}_{i} / a__{i}_{i}")
            lines += [f"a__{below}_{j} = a__{below}_{j} - share__ * a__{i}_{j}" for j in order[step + 1 :]]
            lines.append(f"b__{below} = b__{below} - share__ * b__{i}")
    return [*lines, f"force__{own} = b__{own} / a__{own}_{own}"]


def _reached_from(names: Sequence[str], lines: Sequence[str], rates: Mapping[str, str]) -> set[str]:
    """Return the targets of the lines that are computed from any of the names, through others."""
    reached = set(names)
    for line in lines:
        target, used = assigned(line)
        if (used | names_in(rates.get(target, ""))) & reached:
            reached.add(target)
    return reached


def _called(line: str, suffixes: Mapping[str, str]) -> str:
    """Return a line with its names called otherwise, each with its suffix."""
    return re.sub(r"\b[A-Za-z_]\w*", lambda one: f"{one[0]}__{suffixes[one[0]]}" if one[0] in suffixes else one[0], line)
