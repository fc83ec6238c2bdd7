"""Text of generated functions: the statements that a result needs, terms behind gates, functions copied from effects."""

from __future__ import annotations

import ast
import functools
import itertools
import operator
import re
from collections.abc import Callable, Collection, Sequence

from hjcamp.model.declare.part import whole_definition

GATES = "gates"
# In place of a sum of gates: whatever is open, and where nothing is.
EVERY = -1
INLINED = ("predict", "glide", "correct", "contact", "locking", "facing", "faced", "limiting", "readings")
ENTRIES = ("rates", "begin", "signals")


def live(statements: Sequence[str], last: str) -> list[str]:
    """Return those one-line statements whose results reach the text ``last``, in order."""
    wanted = names_in(last)
    kept = []
    for line in reversed(statements):
        target, names = assigned(line)
        if target in wanted:
            kept.append(line)
            wanted |= names
    return kept[::-1]


@functools.lru_cache(maxsize=4096)
def assigned(line: str) -> tuple[str, frozenset[str]]:
    """Return the name that a one-line statement sets, and all names in it."""
    tree = ast.parse(line).body[0]
    assignment = tree.body[0] if isinstance(tree, ast.If) else tree
    assert isinstance(assignment, ast.Assign)
    return ast.unparse(assignment.targets[0]), frozenset(names_in(line))


def gates_of(line: str) -> tuple[list[int], str]:
    """Return the sums of gates of which each must have an open one for a statement to act, and the statement."""
    tests = re.match(rf"if ({GATES} & \d+(?: and {GATES} & \d+)*): ", line)
    return ([int(one) for one in re.findall(r"\d+", tests[1])], line[tests.end() :]) if tests else ([], line)


def behind(mask: int, line: str) -> str:
    """Return a statement that acts only where one gate of a sum is open, too."""
    masks, statement = gates_of(line)
    return f"if {' and '.join(f'{GATES} & {one}' for one in (mask, *masks))}: {statement}"


def behind_one_test(lines: Sequence[str]) -> list[str]:
    """Return the statements with neighbours behind gates under one test: most slots have no effect most of the time."""
    found: list[str] = []
    for (tests, mask), group in itertools.groupby(lines, _tests):
        own = list(group)
        if tests == 0 or len(own) == 1:
            found += own
        elif tests == 1:
            opened = functools.reduce(operator.or_, (gates_of(line)[0][0] for line in own))
            found += [f"if {GATES} & {opened}:", *(f"    {line}" for line in own)]
        else:
            inside = [line.replace(f"{GATES} & {mask} and ", "", 1) for line in own]
            found += [f"if {GATES} & {mask}:", *(f"    {line}" for line in behind_one_test(inside))]
    return found


def _tests(line: str) -> tuple[int, int]:
    """Return how many tests of gates a statement is behind, two for any more than one, and then the first."""
    masks, _ = gates_of(line)
    return (2, masks[0]) if len(masks) > 1 else (len(masks), 0)


def where_used(lines: Sequence[str], last: Sequence[str]) -> list[str]:
    """Return the statements, those behind gates also behind the gates of all that uses what they set, ``last`` among that."""
    wanted: dict[str, int] = {}
    above: list[tuple[int, int]] = []
    for line in last:
        text = line.lstrip()
        depth = len(line) - len(text)
        above = [(at, mask) for at, mask in above if at < depth]
        test = re.fullmatch(rf"if {GATES} & (\d+):", text)
        if test:
            above.append((depth, int(test[1])))
            continue
        masks, _ = gates_of(text)
        _want(wanted, names_in(text), masks[-1] if masks else above[-1][1] if above else EVERY)
    found = []
    for line in reversed(lines):
        target, names = assigned(line)
        masks, _ = gates_of(line)
        use = wanted.get(target, EVERY)
        _want(wanted, names - {target}, masks[-1] if masks else use)
        found.append(behind(use, line) if masks and use != EVERY else line)
    return found[::-1]


def _want(wanted: dict[str, int], names: Collection[str], mask: int) -> None:
    for name in names:
        wanted[name] = wanted.get(name, 0) | mask


def names_in(text: str) -> set[str]:
    """Return the names in a text of Python, its keywords among them: parsing it takes far longer."""
    return set(re.findall(r"\b[A-Za-z_]\w*", text))


def copied_function(name: str, function: Callable[..., float]) -> str:
    """Return a function's source under another name, without its decorators and annotations."""
    definition = whole_definition(function)
    definition.name = name
    definition.decorator_list = []
    definition.returns = None
    for argument in definition.args.args:
        argument.annotation = None
    return "@inlined\n" + ast.unparse(definition) + "\n\n"


def function_source(signature: str, lines: Sequence[str]) -> str:
    """Return the source of a compiled function; those of every step are inlined, those that Python calls are cached."""
    name = signature.split("(")[0]
    mark = "inlined" if name in INLINED else "entry" if name in ENTRIES else "hot"
    return f"@{mark}\ndef {signature}:\n" + "".join(f"    {line}\n" for line in lines or ["pass"]) + "\n\n"
