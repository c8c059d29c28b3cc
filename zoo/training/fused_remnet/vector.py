"""A 16-lane float32 vector for numba, because its loops alone do not keep sums in registers.

LLVM splits the vector to the machine's width (AVX-512, AVX2, NEON, ...), so the code runs
anywhere. Memory is reached through bare pointers to float32: unlike arrays they carry no
reference count for two threads to fight over, and compile in half the time. Nothing is checked
against bounds; the layout's offsets are what keeps accesses inside.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

import numba
from llvmlite import ir  # type: ignore[import-untyped]
from numba.core import cgutils
from numba.core.datamodel import models
from numba.extending import intrinsic, register_model

LANES = 16
_VECTOR = ir.VectorType(ir.FloatType(), LANES)
_UNDEFINED = ir.Constant(_VECTOR, ir.Undefined)
_INDEX = ir.IntType(32)
_ZEROS = ir.Constant(_VECTOR, [0.0] * LANES)

_P = ParamSpec("_P")
_R = TypeVar("_R")
_njit: Any = numba.njit  # numba's own types change from version to version
types: Any = numba.types
_PrimitiveModel: Any = models.PrimitiveModel


def kernel(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Compile for use by other kernels only; entry points for Python cost as much again."""
    wrappers = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    compiled: Callable[_P, _R] = _njit(function, nogil=True, error_model="numpy", **wrappers)
    return compiled


def inlined(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Make `function` a piece of its caller: compiled on its own it costs LLVM another turn."""
    made: Callable[_P, _R] = _njit(function, inline="always", error_model="numpy")
    return made


def operation(emit: Callable[..., Any], result: Any, *takes: Any) -> Callable[..., Any]:
    """Return a function for kernels from `takes` to `result`, numba types.

    `emit(builder, *values)` writes its LLVM instructions and returns its value.
    """

    def typed(_typing: Any, *_arguments: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            value = emit(builder, *values)
            return context.get_dummy_value() if signature.return_type == types.none else value

        return result(*takes), generate

    definition: Any = typed
    definition.__name__ = emit.__name__.strip("_")
    definition.__signature__ = inspect.signature(emit)  # numba wants the arguments one by one
    made: Callable[..., Any] = intrinsic(definition)
    return made


def call(builder: Any, name: str, result: Any, *values: Any) -> Any:
    """Call the LLVM or C function `name`, from inside an `emit`."""
    kind = ir.FunctionType(result, [value.type for value in values])
    declare: Any = cgutils.get_or_insert_function
    return builder.call(declare(builder.module, kind, name), values)


class VectorType(types.Type):
    """The numba type of LANES packed float32 values."""

    def __init__(self) -> None:
        super().__init__(name=f"float32x{LANES}")


vector: Any = VectorType()
pointer = types.CPointer(types.float32)


@register_model(VectorType)
class _VectorModel(_PrimitiveModel):
    def __init__(self, manager: Any, frontend_type: Any) -> None:
        super().__init__(manager, frontend_type, _VECTOR)


def _address(_typing: Any, array: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return context.make_array(signature.args[0])(context, builder, values[0]).data

    return types.CPointer(array.dtype)(array), generate


def _shift(builder: Any, data: Any, count: Any) -> Any:
    return builder.gep(data, [count])


def _get(builder: Any, data: Any, index: Any) -> Any:
    return builder.load(builder.gep(data, [index]))


def _put(builder: Any, data: Any, index: Any, value: Any) -> None:
    builder.store(value, builder.gep(data, [index]))


def _lanes(builder: Any, data: Any, index: Any) -> Any:
    return builder.bitcast(builder.gep(data, [index]), _VECTOR.as_pointer())


def _load(builder: Any, data: Any, index: Any) -> Any:
    value = builder.load(_lanes(builder, data, index))
    value.align = 4  # a row may start anywhere; LLVM would assume 64
    return value


def _store(builder: Any, data: Any, index: Any, value: Any) -> None:
    builder.store(value, _lanes(builder, data, index)).align = 4


def _splat(builder: Any, scalar: Any) -> Any:
    single = builder.insert_element(_UNDEFINED, scalar, ir.Constant(_INDEX, 0))
    first = ir.Constant(ir.VectorType(_INDEX, LANES), [0] * LANES)
    return builder.shuffle_vector(single, _UNDEFINED, first)


def _add(builder: Any, a: Any, b: Any) -> Any:
    return builder.fadd(a, b)


def _multiply(builder: Any, a: Any, b: Any) -> Any:
    return builder.fmul(a, b)


def _multiply_add(builder: Any, a: Any, b: Any, c: Any) -> Any:
    return call(builder, f"llvm.fmuladd.v{LANES}f32", _VECTOR, a, b, c)


def _add_scaled(builder: Any, total: Any, data: Any, index: Any, value: Any) -> Any:
    return _multiply_add(builder, _splat(builder, _get(builder, data, index)), value, total)


def _at_least(builder: Any, value: Any, floor: Any) -> Any:
    return builder.select(builder.fcmp_ordered("<", value, floor), floor, value)


def _where_positive(builder: Any, gate: Any, value: Any) -> Any:
    return builder.select(builder.fcmp_unordered(">", gate, _ZEROS), value, _ZEROS)


def _lane_sum(builder: Any, total: Any) -> Any:
    width = LANES
    while width > 1:
        width //= 2
        total = builder.fadd(_part(builder, total, 0, width), _part(builder, total, width, width))
    return builder.extract_element(total, ir.Constant(_INDEX, 0))


def _part(builder: Any, value: Any, start: int, width: int) -> Any:
    lanes = ir.Constant(ir.VectorType(_INDEX, width), list(range(start, start + width)))
    return builder.shuffle_vector(value, ir.Constant(value.type, ir.Undefined), lanes)


def _stay_apart(builder: Any) -> None:
    builder.function.attributes.add("noinline")


_index = types.intp
# the first value of a C-contiguous array, which must outlive the pointer
address: Callable[..., Any] = intrinsic(_address)
shift = operation(_shift, pointer, pointer, _index)
get = operation(_get, types.float32, pointer, _index)
put = operation(_put, types.none, pointer, _index, types.float32)
# data[index : index + LANES]
load = operation(_load, vector, pointer, _index)
store = operation(_store, types.none, pointer, _index, vector)
# a scalar in every lane
splat = operation(_splat, vector, types.float32)
add = operation(_add, vector, vector, vector)
multiply = operation(_multiply, vector, vector, vector)
# a * b + c
multiply_add = operation(_multiply_add, vector, vector, vector, vector)
# total + data[index] * value
add_scaled = operation(_add_scaled, vector, vector, pointer, _index, vector)
# max(value, floor), but NaN stays NaN, as in torch.relu
at_least = operation(_at_least, vector, vector, vector)
# value where gate > 0 or NaN, else 0: the gradient of torch.relu
where_positive = operation(_where_positive, vector, vector, vector)
# the sum of the lanes, halves added until one is left
lane_sum = operation(_lane_sum, types.float32, vector)
# keep LLVM from copying the calling function into each of its callers
stay_apart = operation(_stay_apart, types.none)
