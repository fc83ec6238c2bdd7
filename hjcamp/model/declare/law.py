"""Control laws and procedures: one class whose ``step`` runs once per sample, on the rig as inside the kernel.

``step(sample, parameter, memory)`` is plain Python; the generator turns the three namespaces into a flat function, so
the simulator runs the very text that the rig runs.
"""

from __future__ import annotations

import ast
import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import unknown
from hjcamp.model.declare.parameter import Parameter, declared
from hjcamp.model.declare.part import whole_definition


@dataclass(frozen=True)
class Memory:
    """What a law remembers from sample to sample: one number, or ``size`` numbers."""

    start: float = 0.0
    size: int = 1
    name: str = ""

    def __set_name__(self, owner: type, name: str) -> None:
        object.__setattr__(self, "name", name)


class Law:
    """The base class: ``parameters`` and ``memories`` by name, ``samples`` the arguments, ``results`` the answers.

    A step may use another's lines: ``pid, ahead = part(Pid.step, sample, parameter, memory)`` (see `hjcamp.model.declare.marks.part`).
    """

    name: ClassVar[str] = ""
    samples: ClassVar[tuple[str, ...]] = ()
    results: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[dict[str, Parameter]] = {}
    memories: ClassVar[dict[str, Memory]] = {}

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        cls.parameters = declared(cls, Parameter)
        cls.memories = declared(cls, Memory)

    @classmethod
    def vector(cls, values: dict[str, float]) -> NDArray[np.float64]:
        """Return the parameter vector in order of declaration, completed by the defaults."""
        for name in values:
            if name not in cls.parameters:
                raise unknown("parameter", name, cls.parameters, f"{cls.name}")
        return np.array([float(values.get(name, parameter.default)) for name, parameter in cls.parameters.items()])

    @classmethod
    def fresh_memory(cls) -> NDArray[np.float64]:
        """Return the memory vector at the start of a test."""
        found = [memory.start for memory in cls.memories.values() for _ in range(memory.size)]
        return np.array(found or [0.0])


class _Flatten(ast.NodeTransformer):
    def __init__(self, law: type[Law]) -> None:
        self.law = law
        self.offsets: dict[str, int] = {}
        offset = 0
        for name, memory in law.memories.items():
            self.offsets[name] = offset
            offset += memory.size

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        value = node.value
        if isinstance(value, ast.Attribute) and isinstance(value.value, ast.Name) and value.value.id == "memory":
            place = f"m[{self._memory(value.attr)} + ({ast.unparse(self.visit(node.slice))})]"
            return _expression(place, node)
        return self.generic_visit(node)

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        if not isinstance(node.value, ast.Name):
            return self.generic_visit(node)
        if node.value.id == "memory":
            return _expression(f"m[{self._memory(node.attr)}]", node)
        if node.value.id == "parameter":
            if node.attr not in self.law.parameters:
                raise unknown("parameter", node.attr, self.law.parameters, f"law {self.law.__name__}")
            return _expression(f"c[{list(self.law.parameters).index(node.attr)}]", node)
        if node.value.id == "sample":
            if node.attr not in self.law.samples:
                raise unknown("sample quantity", node.attr, self.law.samples, f"law {self.law.__name__}")
            return _expression(node.attr, node)
        return self.generic_visit(node)

    def _memory(self, name: str) -> int:
        if name not in self.offsets:
            raise unknown("memory", name, self.offsets, f"law {self.law.__name__}")
        return self.offsets[name]


def _expression(text: str, instead_of: Any) -> ast.expr:
    node = ast.parse(text, mode="eval").body
    if isinstance(instead_of.ctx, ast.Store):
        assert isinstance(node, ast.Subscript)
        node.ctx = ast.Store()
    for one in ast.walk(node):
        ast.copy_location(one, instead_of)
    return node


def law_source(law: type[Law], function: str) -> str:
    """Return the source of ``function(<samples>, c, m)`` with ``c`` the parameters and ``m`` the memory."""
    return "@inlined\n" + ast.unparse(_flat(law, function)) + "\n\n\n"


def law_function(law: type[Law], names: Mapping[str, Any]) -> Callable[..., Any]:
    """Return the function of `law_source` with the file and the lines of the law, and the ``names`` a kernel gives it."""
    step = law.step  # type: ignore[attr-defined]
    tree = ast.increment_lineno(_flat(law, "step"), inspect.getsourcelines(step)[1] - 1)
    found: dict[str, Any] = dict(names)
    exec(compile(tree, step.__code__.co_filename, "exec"), found)
    function: Callable[..., Any] = found["step"]
    return function


def _flat(law: type[Law], function: str) -> ast.Module:
    definition = whole_definition(law.step)  # type: ignore[attr-defined]
    names = [*law.samples, "c", "m"]
    definition.name = function
    definition.decorator_list = []
    definition.returns = None
    definition.args.args = [ast.arg(name) for name in names]
    body = [_Flatten(law).visit(line) for line in definition.body]
    definition.body = [line for line in body if not (isinstance(line, ast.Expr) and isinstance(line.value, ast.Constant))]
    return ast.fix_missing_locations(ast.Module([definition], []))
