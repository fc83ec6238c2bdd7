"""Sums of four neighbouring rows at once, as the processor's vectors hold them, and functions whose arrays lie apart.

numba's LLVM makes no vectors of neighbouring statements. Each row is summed in the order of its columns and nothing is fused:
the results are those of the loops in Python, bit for bit. Kernels import this file; its text is part of their hash.
"""

from __future__ import annotations

import os
from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]
from numba import types
from numba.core import cgutils
from numba.core.compiler import Compiler
from numba.extending import intrinsic
from numba.np.arrayobj import make_array

DOUBLE, PLACE, LANE = ir.DoubleType(), ir.IntType(64), ir.IntType(32)
FOUR = ir.VectorType(DOUBLE, 4)


class Apart(Compiler):
    """Compiles a function no two of whose arrays share memory: what one holds need not be read again after another is written.

    Who calls it gives fresh arrays for all that it writes; that arrays which are only read share memory does no harm.
    """

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.state.flags.noalias = True


def ahead_in_python(a: Any, z: Any, first: int, count: int, steps: Any, row: int, places: Any, values: Any) -> None:
    """Set ``a`` from ``first`` on, 4 numbers at most, to ``z`` and the sum over k of ``steps[row, places[k] :] * values[k]``."""
    for i in range(count):
        total = steps[row, places[0] + i] * values[0]
        for place, value in zip(places[1:], values[1:], strict=True):
            total += steps[row, place + i] * value
        a[first + i] = z[first + i] + total


def strided_in_python(space: Any, left: int, first: int, right: int, begin: int, stride: int) -> Any:
    """Return the sums over k below ``stride`` of ``space[left, first + k] * space[right, begin + k * stride + i]``, i from 0 to 3."""
    found = [0.0] * 4
    for k in range(stride):
        for i in range(4):
            found[i] += space[left, first + k] * space[right, begin + k * stride + i]
    return tuple(found)


def _row(context: Any, builder: Any, array: Any, kind: Any, row: Any) -> Any:
    """Return the address of a row, a whole number from 0, of a matrix."""
    matrix = make_array(kind)(context, builder, array)
    address = builder.add(builder.ptrtoint(matrix.data, PLACE), builder.mul(row, builder.extract_value(matrix.strides, 0)))
    return builder.inttoptr(address, DOUBLE.as_pointer())


def _product(builder: Any, address: Any, value: Any) -> Any:
    """Return four numbers from an address on, each times a value."""
    four = builder.load(builder.bitcast(address, FOUR.as_pointer()), align=8)
    return builder.fmul(four, _all(builder, value))


def _all(builder: Any, value: Any) -> Any:
    one = builder.insert_element(ir.Constant(FOUR, ir.Undefined), value, ir.Constant(LANE, 0))
    lanes = ir.Constant(ir.VectorType(LANE, 4), [0] * 4)
    return builder.shuffle_vector(one, ir.Constant(FOUR, ir.Undefined), lanes)


def _numbers(context: Any, builder: Any, four: Any) -> Any:
    found = [builder.extract_element(four, ir.Constant(LANE, i)) for i in range(4)]
    return context.make_tuple(builder, types.UniTuple(types.float64, 4), found)


def _ahead(_typing: Any, a: Any, z: Any, first: Any, count: Any, steps: Any, row: Any, places: Any, values: Any) -> Any:
    wide = ir.VectorType(DOUBLE, count.literal_value)

    def place_in(context: Any, builder: Any, array: Any, kind: Any) -> Any:
        data = make_array(kind)(context, builder, array).data
        return builder.bitcast(builder.gep(data, [PLACE(first.literal_value)]), wide.as_pointer())

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        begin = _row(context, builder, args[4], steps, args[5])
        total = None
        for k in range(len(values)):
            address = builder.gep(begin, [builder.extract_value(args[6], k)])
            term = _product(builder, address, builder.extract_value(args[7], k))
            total = term if total is None else builder.fadd(total, term)
        lanes = ir.Constant(ir.VectorType(LANE, wide.count), list(range(wide.count)))
        start = builder.load(place_in(context, builder, args[1], z), align=8)
        end = builder.fadd(start, builder.shuffle_vector(total, total, lanes))
        builder.store(end, place_in(context, builder, args[0], a), align=8)
        return context.get_dummy_value()

    tuples = types.UniTuple(types.int64, len(values)), types.UniTuple(types.float64, len(values))
    return types.void(a, z, first, count, steps, types.int64, *tuples), generate


def _strided(_typing: Any, space: Any, left: Any, first: Any, right: Any, begin: Any, stride: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        values = builder.gep(_row(context, builder, args[0], space, args[1]), [args[2]])
        matrix = builder.gep(_row(context, builder, args[0], space, args[3]), [args[4]])
        total = cgutils.alloca_once_value(builder, ir.Constant(FOUR, [0.0] * 4))
        with cgutils.for_range(builder, args[5]) as loop:
            address = builder.gep(matrix, [builder.mul(loop.index, args[5])])
            term = _product(builder, address, builder.load(builder.gep(values, [loop.index])))
            builder.store(builder.fadd(builder.load(total), term), total)
        return _numbers(context, builder, builder.load(total))

    return types.UniTuple(types.float64, 4)(space, *[types.int64] * 5), generate


PLAIN = os.environ.get("NUMBA_DISABLE_JIT") == "1"
ahead = ahead_in_python if PLAIN else intrinsic(prefer_literal=True)(_ahead)
strided = strided_in_python if PLAIN else intrinsic(_strided)
